"""Tracks as tables, drawings and text."""

import sys
from pathlib import Path
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

import pdr_est
from pdr_est.errors import OutputError, RecordingError
from pdr_est.types.track import bracketing_poses, concatenate
from pdr_est.types.track_output.table import TRACK_COLUMNS


def make_track(device: str = "phone", n: int = 30, seed: int = 0) -> pdr_est.Track:
    rng = np.random.default_rng(seed)
    time_s = np.cumsum(rng.uniform(0.4, 0.7, n))
    square = rng.normal(size=(n, 2, 2))
    return pdr_est.Track(
        time_s=time_s,
        moving_from_s=np.concatenate([time_s[:1], time_s[:-1]]),
        device=np.array([device] * n),
        position_m=np.cumsum(rng.normal(0.5, 0.3, (n, 2)), axis=0),
        heading_rad=rng.uniform(-10.0, 10.0, n),
        covariance_m2=square @ square.transpose(0, 2, 1) + 0.01 * np.eye(2),
        sigma_heading_rad=rng.uniform(0.0, 1.0, n),
        mode=rng.integers(0, 6, n).astype(np.int8),
        step_length_m=rng.uniform(0.5, 0.9, n),
        kind="smoothed",
        estimator="factor-graph",
    )


TWO = concatenate([make_track(), make_track('a "strange", name\nof two lines', 25, 1)])


def test_a_track_is_read_back_exactly_as_it_was_written(tmp_path: Path) -> None:
    TWO.to_csv(tmp_path / "track.csv")
    again = pdr_est.Track.from_csv(tmp_path / "track.csv", kind="smoothed", estimator="factor-graph")
    again.to_csv(tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "track.csv").read_bytes()
    assert again.devices == TWO.devices
    assert (again.kind, again.estimator) == ("smoothed", "factor-graph")
    np.testing.assert_allclose(again.position_m, TWO.position_m, atol=6e-5)
    np.testing.assert_allclose(again.covariance_m2, TWO.covariance_m2, rtol=1e-8)
    np.testing.assert_array_equal(again.mode, TWO.mode)
    np.testing.assert_allclose(again.moving_from_s, TWO.moving_from_s, atol=1e-6)


def test_headings_at_the_seam_survive(tmp_path: Path) -> None:
    track = make_track(n=2)
    track.heading_rad[:] = (np.pi - 1e-9, -np.pi)
    track.to_csv(tmp_path / "track.csv")
    pdr_est.Track.from_csv(tmp_path / "track.csv").to_csv(tmp_path / "again.csv")
    assert "3.141593" in (tmp_path / "track.csv").read_text()
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "track.csv").read_bytes()


def test_a_smoothed_walk_is_read_back(tmp_path: Path) -> None:
    from pdr_est.simulate import preset, simulate_walk

    track = pdr_est.smooth(simulate_walk(preset("l_shape")).recording)
    track.to_csv(tmp_path / "track.csv")
    pdr_est.Track.from_csv(tmp_path / "track.csv").to_csv(tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "track.csv").read_bytes()


HEADER = ",".join(TRACK_COLUMNS)
ROW = "0.0,phone,0,0,0,1,0,1,0.1,HOLDING,0.7"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "not a track table"),
        ("time,x\n1,2\n", "its first line is 'time,x', but the columns must be time_s,device"),
        (f"{HEADER}\n", "has no rows"),
        (f"{HEADER}\n{ROW}\n1.0,phone,0\n", "row 3: 3 cells instead of 11"),
        (f"{HEADER}\n{ROW.replace('0.7', 'far')}\n", "row 2: step_length_m is 'far': it must be a number"),
        (f"{HEADER}\n{ROW.replace('HOLDING', 'FLYING')}\n", "mode is 'FLYING': it must be one of UNKNOWN, HOLDING"),
    ],
)
def test_what_is_no_track_table_is_refused(text: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "track.csv").write_text(text)
    with pytest.raises(RecordingError, match=words):
        pdr_est.Track.from_csv(tmp_path / "track.csv")


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"none\.csv: cannot be read"):
        pdr_est.Track.from_csv(tmp_path / "none.csv")


def test_data_frames_have_the_columns_of_the_table() -> None:
    frame = TWO.to_polars()
    assert tuple(frame.columns) == TRACK_COLUMNS
    np.testing.assert_array_equal(frame["x_m"].to_numpy(), TWO.position_m[:, 0])
    np.testing.assert_array_equal(frame["cov_xy_m2"].to_numpy(), TWO.covariance_m2[:, 0, 1])
    assert set(frame["mode"]) <= set(pdr_est.CarryingMode.__members__)
    assert frame["device"].unique(maintain_order=True).to_list() == list(TWO.devices)


def test_pandas_has_the_same() -> None:
    pytest.importorskip("pandas")
    frame = TWO.to_pandas()
    assert tuple(frame.columns) == TRACK_COLUMNS
    np.testing.assert_array_equal(frame["y_m"].to_numpy(), TWO.position_m[:, 1])


def test_without_pandas_the_remedy_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(OutputError, match="`pip install pandas`"):
        TWO.to_pandas()


def test_a_track_says_shortly_what_it_is() -> None:
    track = make_track(n=3)
    assert repr(track) == (
        f"Track(factor-graph, smoothed: 3 poses of phone, {track.time_s[-1] - track.time_s[0]:.1f} s)"
    )
    nothing = track.rows_where(np.zeros(3, dtype=np.bool_))
    assert repr(nothing) == "Track(factor-graph, smoothed: 0 poses of , 0.0 s)"


def test_positions_between_poses() -> None:
    track = make_track(n=4)
    position, covariance = track.at(track.time_s)
    np.testing.assert_allclose(position, track.position_m)
    np.testing.assert_allclose(covariance, track.covariance_m2)
    (middle,), _ = track.at(0.5 * (track.time_s[1] + track.time_s[2]))
    np.testing.assert_allclose(middle, 0.5 * (track.position_m[1] + track.position_m[2]))
    with pytest.raises(ValueError, match="choose one with of_device"):
        TWO.at(1.0)


def test_the_walker_stands_until_the_next_step_begins() -> None:
    before, after, share = bracketing_poses(
        np.array([0.0, 1.0, 5.0]), np.array([0.0, 0.5, 4.0]), np.array([-1.0, 0.25, 0.75, 3.9, 4.5, 9.0])
    )
    np.testing.assert_array_equal(before, [0, 0, 0, 1, 1, 1])
    np.testing.assert_array_equal(after, [1, 1, 1, 2, 2, 2])
    np.testing.assert_allclose(share, [0.0, 0.0, 0.5, 0.0, 0.5, 1.0])


def test_the_plot_shows_lines_ellipses_fixes_and_truth() -> None:
    axes = Figure().add_subplot()
    fix = pdr_est.PositionFix(3.0, np.array([1.0, 2.0]), np.eye(2))
    assert TWO.plot(axes, fixes=[fix], truth_m=np.zeros((5, 2))) is axes
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels == ["truth", *TWO.devices, "fixes"]
    assert [line.get_xydata()[0].tolist() for line in axes.lines if line.get_label() == "fixes"] == [[1.0, 2.0]]
    ellipses = [patch for patch in axes.patches if isinstance(patch, Ellipse)]
    assert 20 <= len(ellipses) <= 48
    last = TWO.of_device("phone")
    shown = next(one for one in ellipses if np.allclose(one.center, last.position_m[-1]))
    # Of a normal distribution in the plane 95 % lie within 2.4477 standard deviations.
    np.testing.assert_allclose(
        [shown.height, shown.width], 2 * 2.4477468 * np.sqrt(np.linalg.eigvalsh(last.covariance_m2[-1]))
    )
    assert axes.get_aspect() == 1.0


def test_the_plot_makes_its_own_axes() -> None:
    from matplotlib import pyplot

    with mpl.rc_context({"backend": "agg"}):
        axes = make_track().plot()
        assert axes.get_xlabel() == "east (m)"
        pyplot.close(axes.figure)


def test_notebooks_get_a_table_and_a_drawing_without_scripts() -> None:
    page = TWO._repr_html_()
    assert "<script" not in page
    assert "strange&quot;, name" in page
    root = ElementTree.fromstring(page)
    assert len(root.findall(".//tbody/tr")) == 2
    svg = "{http://www.w3.org/2000/svg}"
    assert len(root.findall(f".//{svg}polyline")) == 2
    assert 20 <= len(root.findall(f".//{svg}ellipse")) <= 48
    assert len(page) < 20_000


def test_odd_tracks_are_drawn() -> None:
    track = make_track(n=3)
    track.position_m[:], track.covariance_m2[:] = np.nan, np.inf
    assert "<svg" not in track._repr_html_()
    still = make_track(n=3)
    still.position_m[:], still.covariance_m2[:] = 2.0, 0.0
    assert "nan" not in still._repr_html_()
