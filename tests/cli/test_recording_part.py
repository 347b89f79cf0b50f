"""`--from`, `--to` and `--device` in every command that reads a recording."""

import json
from pathlib import Path

import numpy as np
import pytest
from cli_recordings import Walk, columns_of, lines_of, save
from cli_runs import refused, run, smoothed

pytestmark = pytest.mark.usefixtures("without_report")


def steps_in(*arguments: object) -> int:
    result = run("steps", *arguments, "--json")
    assert result.exit_code == 0, result.output
    return int(json.loads(result.stdout)[0]["steps"])


def test_a_part_has_fewer_steps_and_the_parts_have_them_all(good: Path) -> None:
    whole = steps_in(good)
    first, last = steps_in(good, "--to", "7.0"), steps_in(good, "--from", "7.0")
    assert 4 <= first < whole
    assert 4 <= last < whole
    assert abs(first + last - whole) <= 2


def test_seconds_count_from_the_first_sample(walk: Walk, good: Path, tmp_path: Path) -> None:
    late = save(tmp_path / "late.csv", lines_of(columns_of(walk, time_s=walk.time_s + 5000.0)))
    early = save(tmp_path / "early.csv", lines_of(columns_of(walk)))
    assert steps_in(late, "--from", "6", "--to", "12") == steps_in(early, "--from", "6", "--to", "12") > 4


@pytest.mark.parametrize("to", ["7", "14:45:43", "2024-06-10T14:45:43Z", "2024-06-10T16:45:43+02:00"])
def test_clock_times(to: str, export_zip: Path) -> None:
    """The export begins on 10 June 2024 at 14:45:36 UTC."""
    assert steps_in(export_zip, "--to", to) == steps_in(export_zip, "--to", "7.0")


LOCAL = np.datetime64("2031-02-03T04:05:06.000", "ms")


@pytest.mark.parametrize(
    ("form", "tos"),
    [
        ("dates", ["4:05:13", "04:05:13", "2031-02-03T04:05:13", "2031-02-03 04:05:13.0"]),
        ("of day", ["04:05:13", "4:05:13.00"]),
    ],
)
def test_clock_times_as_the_recorder_wrote_them(form: str, tos: list[str], walk: Walk, tmp_path: Path) -> None:
    """A recorder that states no time zone is asked in its own time."""
    stamps = [str(LOCAL + np.timedelta64(round(1000.0 * time_s), "ms")).replace("T", " ") for time_s in walk.time_s]
    clock = ["time", *(stamp[11:] if form == "of day" else stamp for stamp in stamps)]
    lines = [line.partition(",")[2] for line in lines_of(columns_of(walk))]
    path = save(tmp_path / "walk.csv", [f"{time},{rest}" for time, rest in zip(clock, lines, strict=True)])
    for to in tos:
        assert steps_in(path, "--to", to) == steps_in(path, "--to", "7.0")
    assert "does not tell its" in refused("steps", path, "--to", "2031-02-03T04:05:13Z")
    if form == "of day":
        assert "does not tell its date" in refused("steps", path, "--to", "2031-02-03T04:05:13")


def test_inspect_tells_where_the_walking_is(good: Path) -> None:
    text = run("inspect", good).stdout
    assert "walking: " in text
    assert "the walk alone: --from " in text
    options = text.rsplit("the walk alone: ", 1)[1].split()
    assert steps_in(good, *options) == steps_in(good)
    document = json.loads(run("inspect", good, "--json", "--from", "2", "--to", "9").stdout)
    assert document["duration_s"] == pytest.approx(7.0, abs=0.05)
    assert document["walking"]["steps"] < steps_in(good)


def test_every_command_takes_them(good: Path, tmp_path: Path) -> None:
    options = ("--from", "2", "--to", "10")
    summary = tmp_path / "out" / "summary.json"
    smoothed(good, tmp_path / "out", *options)
    assert json.loads(summary.read_text(encoding="utf-8"))["duration_s"] == pytest.approx(8.0, abs=0.1)
    rows = [json.loads(line) for line in run("track", good, *options).stdout.splitlines()]
    assert 2.0 <= rows[0]["time_s"] <= rows[-1]["time_s"] <= 10.0
    assert run("calibrate", good, "--distance", 6, "-o", tmp_path / "me.yaml", *options).exit_code == 0


def test_fixes_outside_the_part_are_left_out(good: Path, tmp_path: Path) -> None:
    fixes = save(tmp_path / "fixes.csv", ["time_s,x_m,y_m", "1,0,0", "6,3,0", "13,9,0"])
    smoothed(good, tmp_path / "out", "--fixes", fixes, "--from", "4", "--to", "9")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["fixes"]["given"] == 1


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--from", "9", "--to", "3"), "let the end come after the beginning"),
        (("--from", "500"), "let the end come after the beginning"),
        (("--from", "-3"), "'-3' is no moment: give seconds from the start"),
        (("--to", "soon"), "'soon' is no moment"),
        (("--to", "nan"), "'nan' is no moment"),
        (("--to", "25:70"), "'25:70' is no moment"),
        (("--from", "\u0663"), "is no moment"),
        (("--from", "14:03"), "is a clock time, but the recording does not tell its date: give seconds"),
        (("--device", "watch"), "no device 'watch': give one of device"),
        (("--device", "device", "--device", "device"), "the device 'device' is given twice"),
    ],
    ids=str,
)
@pytest.mark.parametrize("command", ["inspect", "steps", "track"])
def test_what_is_refused(command: str, options: tuple[str, ...], words: str, good: Path) -> None:
    assert words in refused(command, good, *options)


def test_live_messages_have_no_parts() -> None:
    assert "- cannot be combined with other recordings, --realtime, --from" in refused("track", "-", "--from", "3")


def test_one_device_of_several(good: Path, walk: Walk, tmp_path: Path) -> None:
    other = save(tmp_path / "other.csv", lines_of(columns_of(walk, force=walk.force * 1.001)))
    assert run("smooth", good, other, "-o", tmp_path / "both").exit_code == 0
    smoothed(good, tmp_path / "one", other, "--device", "other")
    assert devices_of(tmp_path / "both") == {"walk", "other", "fused"}
    assert devices_of(tmp_path / "one") == {"other"}
    rows = [json.loads(line) for line in run("track", good, other, "--device", "walk").stdout.splitlines()]
    assert {row["device"] for row in rows} == {"walk"}
    assert "give one of walk, other" in refused("track", good, other, "--device", "watch")


def devices_of(folder: Path) -> set[str]:
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    return {device["name"] for device in summary["devices"]}
