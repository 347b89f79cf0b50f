"""`pdr-est inspect`: its words, its JSON, several recordings, and that it never needs what a track needs."""

import json
from pathlib import Path

import numpy as np
from cli_recordings import ACC, Walk, columns_of, lines_of, save, with_attitude
from cli_runs import refused, run


def test_words(good: Path) -> None:
    result = run("inspect", good)
    assert (result.exit_code, result.stderr) == (0, "")
    first, *rest = result.stdout.splitlines()
    assert first.startswith("walk: plain CSV, 1")
    text = "\n".join(rest)
    for words in (
        "device device",
        "specific_force: ",
        "samples, 50.0 Hz, jitter 0.0 ms (p50)",
        "possible: steps, headings and a track",
        "decided: rotation rate: the unit is in the header (gyr_x_radps)",
        "check: correlation of gyroscope and attitude +",
    ):
        assert words in text
    assert "warning" not in text


def test_json_of_one_and_of_several(good: Path, export_zip: Path) -> None:
    one = json.loads(run("inspect", good, "--json").stdout)
    assert (one["name"], one["format"]) == ("walk", "plain CSV")
    (device,) = one["devices"]
    assert {channel["name"] for channel in device["channels"]} == {"specific_force", "rotation_rate", "attitude"}
    several = json.loads(run("inspect", good, export_zip, "--json").stdout)
    assert [document["format"] for document in several] == ["plain CSV", "Sensor Logger"]
    assert several[0] == one
    assert several[1]["origin_deg"] == [48.0, 11.0] or abs(several[1]["origin_deg"][0] - 48.0) < 1e-4


def test_the_same_recording_twice_is_described_once(good: Path) -> None:
    same = good.parent / ".." / good.parent.name / good.name
    assert run("inspect", good, same).stdout == run("inspect", good).stdout


def test_one_bad_recording_among_good_ones_is_named(good: Path, tmp_path: Path) -> None:
    result = run("inspect", good, tmp_path / "nowhere.csv")
    assert result.exit_code == 2
    assert result.stdout.startswith("walk: plain CSV")
    failed, error = result.stderr.splitlines()
    assert failed == f"failed: {tmp_path / 'nowhere.csv'}: no such file or folder; check the path"
    assert error.startswith("Error: 1 of 2 walks failed (")
    assert refused("inspect").startswith("Missing argument 'RECORDING...'; see pdr-est inspect --help")


def test_what_is_wrong_with_the_sensors(walk: Walk, tmp_path: Path) -> None:
    force = walk.force.copy()
    force[:, 0] = np.clip(force[:, 0], -0.15, 0.15)
    columns = with_attitude(walk) | dict(zip(ACC, force.T, strict=True))
    lines = lines_of(columns)
    del lines[200:300]
    text = run("inspect", save(tmp_path / "walk.csv", lines)).stdout
    assert "warning: specific_force: axis x hits the end of its range" in text
    assert "warning: specific_force: gap from 3.9" in text


def test_json_has_no_numbers_that_json_does_not_know(walk: Walk, tmp_path: Path) -> None:
    constant = columns_of(walk, time_s=np.full(len(walk.time_s), 7.0), rate=np.zeros_like(walk.rate))
    text = run("inspect", save(tmp_path / "walk.csv", lines_of(constant)), "--json").stdout

    def refuse(name: str) -> None:
        raise AssertionError(f"{name} is no JSON")

    document = json.loads(text, parse_constant=refuse)
    assert "rotation_rate: all values are zero, the sensor is missing or faulty" in document["devices"][0]["findings"]


def test_help() -> None:
    text = run("inspect", "--help").stdout
    assert "RECORDING..." in text
    assert "--json" in text
