"""Tables of fixes as people write them: titles, units, times and separators of many kinds give the same fixes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.io.side_tables.position_fixes import fixes_within, read_position_fixes, waypoint_fixes
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


def test_latitude_and_longitude(tmp_path: Path) -> None:
    for title in ("lat,lng", "Latitude (deg),Longitude (deg)", "Breite,L\u00e4nge"):
        (fix,) = fixes_of(tmp_path, f"time,{title}\n3,48.0001,11.0\n")
        assert fix.position_m == pytest.approx([0.0, 11.1], abs=0.1)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time,x (px),y (px)\n1,0,0\n", r"the unit 'px' of the column 'x \(px\)' is not known: give m or cm"),
        ("when,x,y\n1,0,0\n", "no column time_s among when, x, y"),
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
