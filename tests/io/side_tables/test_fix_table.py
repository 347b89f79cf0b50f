"""Tables of fixes as people write them: titles, units, times and separators of many kinds give the same fixes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.io import read
from pdr_est.io.side_tables.position_fixes import fixes_within, read_position_fixes, waypoint_fixes
from pdr_est.preprocessing.moments import parse_moment
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin, Recording

EPOCH_S = 1_718_030_736.0
RECORDING = replace(
    Recording.from_arrays(np.arange(0.0, 60.0, 0.02), np.tile([0.0, 0.0, 9.81], (3000, 1))),
    epoch_s=EPOCH_S,
    origin=GeoOrigin(48.0, 11.0),
)


def fixes_of(folder: Path, text: str) -> tuple[PositionFix, ...]:
    table = folder / "fixes.csv"
    table.write_text(text, encoding="utf-8")
    return read_position_fixes(table, RECORDING)


@pytest.mark.parametrize(
    "text",
    [
        "time_s,x_m,y_m,sigma_m\n2.5,1,-3,0.5\n",
        "Time (s),X (m),Y (m),Accuracy (m)\n2.5,1,-3,0.5\n",
        "t;x;y;std\n2,5;1;-3;0,5\n",
        "timestamp [ms],east [cm],north [cm],sigma [cm]\n2500,100,-300,50\n",
        "Zeit (msec);Ost;Nord;Genauigkeit\n2500;1;-3;0,5\n",
        "time (\u03bcs),x,y,sigma\n2500000,1,-3,0.5\n",
        "time_ms\teasting\tnorthing\tsigma_m\n2500\t1\t-3\t0.5\n",
        "Zeit in s;Ost;Nord;Genauigkeit\n2,5;1;-3;0,5\n",
        "y,x,accuracy,seconds_elapsed,comment\n-3,1,0.5,2.5,door\n",
        f"Unix time,x,y,sigma\n{EPOCH_S + 2.5},1,-3,0.5\n",
        f"timestamp,x,y,sigma\n{round(1e3 * (EPOCH_S + 2.5))},1,-3,0.5\n",
        f"timestamp,x,y,sigma\n{round(1e9 * (EPOCH_S + 2.5))},1,-3,0.5\n",
        "datetime,x,y,sigma\n2024-06-10T14:45:38.5Z,1,-3,0.5\n",
        "date,x,y,sigma\n2024-06-10 16:45:38.5+02:00,1,-3,0.5\n",
        "\u6642\u9593,\u6771,\u5317,sigma\n2.5,1,-3,0.5\n",
        "Pos X,POS_Y,TIME,H.Acc.\n1,-3,2.5,0.5\n",
        "time,x (km),y (ft),sigma (mm)\n2.5,0.001,-9.842519685,500\n",
    ],
)
def test_spellings(text: str, tmp_path: Path) -> None:
    (fix,) = fixes_of(tmp_path, text)
    assert fix.time_s == pytest.approx(2.5, abs=1e-6)
    assert fix.position_m == pytest.approx([1.0, -3.0])
    assert fix.covariance_m2 == pytest.approx(0.25 * np.eye(2))


@pytest.mark.parametrize("form", ["2024-06-10 16:45:38.5", "10.06.2024 16:45:38.5", "6/10/2024 4:45:38.5 PM"])
def test_dates_without_a_zone_are_compared_with_those_of_the_recording(form: str, tmp_path: Path) -> None:
    table = tmp_path / "fixes.csv"
    table.write_text(f"date;x;y\n{form};1;-3\n", encoding="utf-8")
    local = replace(RECORDING, epoch_s=None, local_epoch_s=EPOCH_S + 7200.0)
    assert read_position_fixes(table, local)[0].time_s == pytest.approx(2.5, abs=1e-6)
    utc = replace(RECORDING, epoch_s=EPOCH_S + 7200.0)
    assert read_position_fixes(table, utc)[0].time_s == pytest.approx(2.5, abs=1e-6)
    with pytest.raises(RecordingError, match=r"the times are dates, but that of .* is unknown: give seconds"):
        read_position_fixes(table, replace(RECORDING, epoch_s=None))
    table.write_text("date,x,y\n2024-06-10T14:45:38.5Z,1,-3\n", encoding="utf-8")
    with pytest.raises(RecordingError, match="give dates without a time zone, as the recording has, or seconds"):
        read_position_fixes(table, local)


def test_a_recording_and_its_fixes_with_one_clock_without_a_zone(tmp_path: Path) -> None:
    rows = [f"2024-06-10 16:45:{i / 50:06.3f},0.1,0.2,9.8" for i in range(500)]
    (tmp_path / "walk.csv").write_text("date,acc_x,acc_y,acc_z\n" + "\n".join(rows) + "\n", encoding="utf-8")
    (tmp_path / "fixes.csv").write_text("date,x,y\n10/06/2024 16:45:02.5,1,-3\n", encoding="utf-8")
    recording = read(tmp_path / "walk.csv")
    assert recording.epoch_s is None
    (fix,) = read_position_fixes(tmp_path / "fixes.csv", recording)
    assert fix.time_s == pytest.approx(2.5, abs=1e-6)
    begin = parse_moment("2024-06-10 16:45:02.5")
    assert begin.on_clock_of(recording) == pytest.approx(2.5, abs=1e-6)
    assert parse_moment("16:45:03").on_clock_of(recording) == pytest.approx(3.0, abs=1e-6)
    with pytest.raises(RecordingError, match="does not tell its time zone"):
        parse_moment("2024-06-10T16:45:02Z").on_clock_of(recording)


def test_latitude_and_longitude(tmp_path: Path) -> None:
    for title in ("lat,lng", "Latitude (deg),Longitude (deg)", "Breite,L\u00e4nge"):
        (fix,) = fixes_of(tmp_path, f"time,{title}\n3,48.0001,11.0\n")
        assert fix.position_m == pytest.approx([0.0, 11.1], abs=0.1)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time,x (px),y (px)\n1,0,0\n", r"the unit 'px' of the column 'x \(px\)' is not known: give m or cm"),
        (
            "time (w),x,y\n1,0,0\n",
            r"the unit 'w' of the column 'time \(w\)' is not known: give s or ms or .* or min or h",
        ),
        ("when,x,y\n1,0,0\n", "no column time_s among when, x, y"),
        ("time,x,y\n2024-06-10T14:45:38Z,0,0\n3,0,0\n", "line 3, column 'time': '3' is a number among dates"),
        ("time,x,y\n31.02.2024 14:45:38,0,0\n", "line 2, column 'time': '31.02.2024 14:45:38' is neither"),
        ("time,x\n1,0\n", "needs the columns x_m and y_m, or latitude_deg and longitude_deg; it has time, x"),
        ("time,x,y\nsoon,0,0\n", r"line 2, column 'time': 'soon' is neither a number nor a date"),
        ("time,x,y\n1,left,0\n", r"line 2, column 'x': 'left' is not a number"),
        ("time_s,x,y\n1718030738500,0,0\n", "is not a time in seconds: convert milliseconds"),
    ],
)
def test_what_is_refused(text: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=words):
        fixes_of(tmp_path, text)


def test_marked_points_become_fixes() -> None:
    truth = TruePositions(np.array([5.0, 1.0]), np.array([[4.0, 0.0], [1.0, 2.0]]), 0.7, "waypoints")
    typed = PositionFix(3.0, np.zeros(2), np.eye(2), clock_known=True)
    marked = waypoint_fixes(replace(RECORDING, truth=Truth(positions=truth), waypoints=(typed,)))
    assert [fix.time_s for fix in marked] == [1.0, 3.0, 5.0]
    assert marked[0].covariance_m2 == pytest.approx(0.49 * np.eye(2))
    assert all(fix.clock_known for fix in marked)
    assert [fix.time_s for fix in fixes_within(marked, RECORDING)] == [1.0, 3.0, 5.0]
    for source in ("poses", "gps"):  # the reference of a data set, which nobody marked on the way
        with pytest.raises(RecordingError, match=r"no waypoints: nobody marked positions .* --fixes FILE\.csv"):
            waypoint_fixes(replace(RECORDING, truth=Truth(positions=replace(truth, source=source))))
