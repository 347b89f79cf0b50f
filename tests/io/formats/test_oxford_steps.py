"""Oxford step counting: an accelerometer in nanoseconds, and true steps from foot contacts that flicker."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from pdr_est.errors import RecordingError
from pdr_est.io import read
from pdr_est.io.formats.datasets.oxford_steps import sniff
from pdr_est.io.text.container import Source

START_NS = 584_065_454_762_638
N = 200


def accelerometer(n: int = N, row: str = "0.25,-0.5,9.75") -> str:
    """Two seconds at 100 Hz."""
    return "".join(f"{START_NS + 10_000_000 * i},3,{row}\n" for i in range(n))


def contacts(states: Sequence[tuple[float, int, int]]) -> str:
    """Rows of seconds since the accelerometer's first sample, left, right."""
    return "".join(f"{START_NS + round(time_s * 1e9)},{left},{right}\n" for time_s, left, right in states)


def walk(folder: Path, states: Sequence[tuple[float, int, int]] = ((0.0, 0, 0), (1.0, 1, 0))) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "accelerometer.csv").write_text(accelerometer())
    (folder / "stepcounter.csv").write_text(contacts(states))
    return folder


def test_units_signs_and_the_name(tmp_path: Path) -> None:
    folder = walk(tmp_path / "Phone_Person_Hard_InHand_1")
    for path in (folder, folder / "accelerometer.csv"):
        recording = read(path)
        (device,) = recording.devices
        assert (recording.format, recording.name) == ("Oxford steps", "Phone_Person_Hard_InHand_1")
        assert device.specific_force is not None
        assert device.rotation_rate is None
        assert_allclose(device.specific_force.time_s, np.arange(N) / 100.0, atol=1e-9)
        assert_array_equal(device.specific_force.values, np.tile([0.25, -0.5, 9.75], (N, 1)))
        assert device.warnings == ()


def test_a_step_is_a_contact_that_begins_in_order_of_time(tmp_path: Path) -> None:
    states = [(0.1, 1, 0), (0.3, 1, 1), (0.5, 0, 1), (0.8, 1, 1), (0.9, 1, 0), (1.2, 1, 1), (1.6, 0, 0)]
    truth = read(walk(tmp_path / "walk", states)).truth
    assert truth.steps is not None
    assert_allclose(truth.steps.time_s, [0.3, 0.8, 1.2], atol=1e-6)  # the left foot was down at the beginning
    assert truth.steps.foot.tolist() == ["R", "L", "R"]
    assert truth.step_count == 3


def test_flicker_of_a_foot_is_one_contact_and_is_counted(tmp_path: Path) -> None:
    left = [(0.0, 0), (0.1, 1), (0.2, 0), (0.3, 1), (0.45, 0), (0.55, 1), (0.59, 0), (0.7, 1)]
    truth = read(walk(tmp_path / "walk", [(time_s, state, 0) for time_s, state in left])).truth
    assert truth.steps is not None
    assert_allclose(truth.steps.time_s, [0.1, 0.7], atol=1e-6)
    (note,) = read(tmp_path / "walk").notes
    assert note.startswith("true steps: 2 beginnings of a foot contact; left out as flicker, less than 0.5 s")
    assert note.endswith(": 2")


def test_flicker_of_one_foot_does_not_hide_the_other(tmp_path: Path) -> None:
    states = [(0.0, 0, 0), (0.4, 1, 0), (0.6, 0, 1), (0.7, 1, 0)]
    truth = read(walk(tmp_path / "walk", states)).truth
    assert truth.steps is not None
    assert truth.steps.foot.tolist() == ["L", "R"]


def test_the_accelerometer_alone_has_no_truth(tmp_path: Path) -> None:
    path = tmp_path / "accelerometer.csv"
    path.write_text(accelerometer())
    for given in (path, tmp_path):
        recording = read(given)
        assert (recording.truth.steps, recording.truth.step_count) == (None, None)
        assert recording.notes == ("no stepcounter.csv beside the accelerometer table: no true steps",)


def test_what_the_experimenter_wrote_is_kept(tmp_path: Path) -> None:
    (walk(tmp_path / "walk") / "notes.txt").write_text("271 steps.\nphone in the background\n")
    assert read(tmp_path / "walk").notes[-1] == "notes.txt: 271 steps. phone in the background"


def test_rows_that_are_not_finite_are_counted(tmp_path: Path) -> None:
    rows = accelerometer().splitlines()
    rows[50] = rows[50].replace("9.75", "NaN")
    (tmp_path / "accelerometer.csv").write_text("\n".join(rows))
    (device,) = read(tmp_path).devices
    assert device.warnings == (f"specific force: 1 of {N} rows are left out: NaN or infinite values",)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (contacts([(0.0, 0, 0), (0.1, 2, 0)]), r"line 2: left foot contact 2 is neither 0 nor 1"),
        (contacts([(100.0, 0, 0), (101.0, 1, 0)]), "do not overlap those of the accelerometer"),
        (contacts([(-9.0, 0, 0), (-8.0, 1, 0)]), "do not overlap those of the accelerometer"),
        ("1,2\n", "2 columns instead of 3"),
    ],
    ids=["state", "later", "earlier", "columns"],
)
def test_a_damaged_step_counter_is_named(tmp_path: Path, content: str, message: str) -> None:
    (walk(tmp_path / "walk") / "stepcounter.csv").write_text(content)
    with pytest.raises(RecordingError, match=rf"stepcounter\.csv.*{message}"):
        read(tmp_path / "walk")


def test_several_walks_are_refused(tmp_path: Path) -> None:
    for name in ("one", "two"):
        walk(tmp_path / name)
    with pytest.raises(RecordingError, match=r"contains 2 Oxford steps recordings .*choose one"):
        read(tmp_path)


@pytest.mark.parametrize(
    "content",
    [
        accelerometer(row="0.1,0.2,0.3"),
        accelerometer(row="0.1,0.2"),
        accelerometer().replace(",3,", ",3.5,"),
        accelerometer().replace("584065", "58.4"),
        "".join(f"{START_NS + 10**9 * i},3,0,0,9.8\n" for i in range(N)),
        contacts([(0.1 * i, i % 2, 0) for i in range(N)]),
    ],
    ids=["weightless", "two axes", "accuracy", "seconds", "one a second", "contacts"],
)
def test_other_numbers_are_not_this_format(tmp_path: Path, content: str) -> None:
    path = tmp_path / "accelerometer.csv"
    path.write_text(content)
    assert not sniff(Source.open(path))


def test_no_other_real_recording_is_taken_for_it(shared_data: Path) -> None:
    files = [path for path in sorted(shared_data.rglob("*.*")) if path.is_file() and "oxford-steps" not in path.parts]
    assert [path for path in files[:: max(len(files) // 40, 1)] if sniff(Source.open(path))] == []


def test_real_walks_have_the_steps_of_both_feet(shared_data: Path) -> None:
    folders = sorted((shared_data / "oxford-steps").iterdir())
    for folder in folders[:: max(len(folders) // 4, 1)]:
        recording = read(folder)
        assert (recording.format, recording.name) == ("Oxford steps", folder.name)
        steps = recording.truth.steps
        assert steps is not None
        assert recording.truth.step_count == len(steps.time_s) > 150
        left, right = (int(np.count_nonzero(steps.foot == foot)) for foot in "LR")
        assert abs(left - right) <= 0.03 * (left + right)
        assert 0.4 < float(np.median(np.diff(steps.time_s))) < 0.8
