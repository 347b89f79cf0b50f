"""`pdr-est smooth` with the recordings of several phones: their clocks, and what does not belong together."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_runs import refused, run

from pdr_est.io.floor_plans.reading import read_floor_plan
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.simulate import DeviceParams, HeldPhone, PocketPhone, Scenario, WalkerGaitParams, simulate_walk
from pdr_est.simulate.walker.walking_path import PathParams
from pdr_est.types.recording import DeviceRecording, Recording
from pdr_est.types.track import Track

pytestmark = pytest.mark.usefixtures("without_report")

AHEAD_S = 1.5
HEADER = "device,t1_s,t2_s,t3_s"


@cache
def walked(seed: int, cadence_hz: float) -> Recording:
    """A phone in the hand and one in the pocket, on one route."""
    scenario = Scenario(
        path=PathParams(vertices_m=((0.0, 0.0), (35.0, 0.0), (35.0, 15.0))),
        gait=WalkerGaitParams(cadence_hz=cadence_hz),
        devices=(DeviceParams(name="hand", carry=HeldPhone()), DeviceParams(name="pocket", carry=PocketPhone())),
        seed=seed,
    )
    return simulate_walk(scenario).recording


def write(recording: Recording, device: DeviceRecording, path: Path) -> Path:
    write_plain_csv(replace(recording, devices=(device,)), path)
    return path


@pytest.fixture(scope="module")
def phones(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Tables of both phones, the clock of the one in the pocket ahead."""
    folder, recording = tmp_path_factory.mktemp("phones"), walked(1, 1.8)
    hand, pocket = recording.devices
    ahead = pocket.with_times(lambda time_s: time_s + AHEAD_S)
    return write(recording, hand, folder / "hand.csv"), write(recording, ahead, folder / "pocket.csv")


@pytest.fixture(scope="module")
def messages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    asked_s = np.arange(1.0, 30.0, 5.0)
    rows = [f"pocket,{t:.3f},{t + 0.01 + AHEAD_S:.3f},{t + 0.02:.3f}" for t in asked_s]
    path = tmp_path_factory.mktemp("messages") / "messages.csv"
    path.write_text("\n".join([HEADER, *rows, ""]), encoding="utf-8")
    return path


def clocks(out: Path) -> Any:
    return json.loads((out / "summary.json").read_text(encoding="utf-8"))["clocks"]


def smooth_both(phones: tuple[Path, Path], out: Path, *options: object) -> None:
    result = run("smooth", *phones, "-o", out, *options)
    assert result.exit_code == 0, result.output


def two_refused(phones: tuple[Path, Path], folder: Path, *options: object) -> str:
    """The line of a refused `smooth` of two phones, which must leave nothing in `folder`."""
    folder.mkdir(exist_ok=True)
    line = refused("smooth", *phones, "-o", folder / "out", *options)
    assert list(folder.iterdir()) == []
    return line


def test_the_clock_by_messages_is_in_the_summary(phones: tuple[Path, Path], messages: Path, tmp_path: Path) -> None:
    smooth_both(phones, tmp_path / "out", "--messages", messages)
    (clock,) = clocks(tmp_path / "out")
    assert (clock["device"], clock["method"], clock["used"], clock["doubts"]) == ("pocket", "messages", True, [])
    assert clock["offset_s"] == pytest.approx(AHEAD_S, abs=1e-3)
    assert 0.001 < clock["sigma_s"] < 0.02


@pytest.mark.parametrize(
    "options",
    [
        ("--clock-offset", "pocket", "1.5"),
        ("--clock", "given", "--clock-offset", "hand", "-0.5", "--clock-offset", "pocket", "1.0"),
    ],
)
def test_a_given_clock_is_used(options: tuple[str, ...], phones: tuple[Path, Path], tmp_path: Path) -> None:
    smooth_both(phones, tmp_path / "out", *options)
    (clock,) = clocks(tmp_path / "out")
    assert (clock["method"], clock["offset_s"], clock["used"]) == ("given", AHEAD_S, True)


def test_a_clock_may_be_given_in_the_settings(phones: tuple[Path, Path], tmp_path: Path) -> None:
    settings = tmp_path / "settings.yaml"
    settings.write_text(
        "devices:\n  clock: given\n  clocks:\n  - {device: pocket, offset_s: 1.5, skew_ppm: 20.0, sigma_s: 0.05}\n"
    )
    smooth_both(phones, tmp_path / "out", "--config", settings)
    (clock,) = clocks(tmp_path / "out")
    assert (clock["offset_s"], clock["skew"], clock["sigma_s"]) == (1.5, pytest.approx(2e-5), 0.05)
    smooth_both(phones, tmp_path / "none", "--config", settings, "--clock", "none")
    assert clocks(tmp_path / "none") == []


@pytest.mark.parametrize(
    ("options", "pattern"),
    [
        (("--clock", "given"), "no clock is given: set devices.clocks (--clock-offset) for one of the devices hand"),
        (("--clock", "messages"), "the recording has no clock messages: give them with --messages FILE.csv"),
        (("--clock-offset", "left", "1"), "the recording has no device 'left'; its devices are hand, pocket"),
        (("--clock", "none", "--clock-offset", "pocket", "1"), "--clock none: does not use --clock-offset"),
        (("--clock-offset", "pocket", "nan"), "--clock-offset: devices.clocks.0.offset_s = nan"),
        (("--clock-offset", "pocket", "1e11"), "--clock-offset: devices.clocks.0.offset_s = 100000000000.0"),
    ],
)
def test_clocks_that_cannot_be(
    options: tuple[str, ...], pattern: str, phones: tuple[Path, Path], tmp_path: Path
) -> None:
    assert pattern in two_refused(phones, tmp_path / "outs", *options)


def test_messages_that_cannot_be(phones: tuple[Path, Path], messages: Path, tmp_path: Path) -> None:
    line = two_refused(phones, tmp_path / "outs", "--messages", messages, "--clock-offset", "pocket", "1")
    assert line == "--messages and --clock-offset both set the clocks: give one of them"
    bad = tmp_path / "bad.csv"
    bad.write_text(f"{HEADER}\nleft,1.0,2.0,1.1\n")
    line = two_refused(phones, tmp_path / "outs", "--messages", bad)
    assert f"{bad}, line 2: device 'left': the devices that answer the first one, 'hand', are 'pocket'" in line
    line = two_refused(phones, tmp_path / "outs", "--messages", tmp_path / "missing.csv")
    assert line.startswith(f"{tmp_path / 'missing.csv'}: no such file")
    line = two_refused((phones[0], phones[0]), tmp_path / "outs", "--messages", messages)
    assert "there is no other device than" in line


def test_walks_of_two_people_are_refused_unless_forced(phones: tuple[Path, Path], tmp_path: Path) -> None:
    stranger = walked(2, 1.87)
    other = write(stranger, stranger.devices[1], tmp_path / "stranger.csv")
    line = two_refused((phones[0], other), tmp_path / "outs")
    assert line.startswith(f"{phones[0]}, {other}: hand and stranger: no shift of the clocks makes their steps ")
    assert "smooth them one by one, or use --clock none" in line
    assert run("smooth", phones[0], other, "-o", tmp_path / "forced", "--clock", "none").exit_code == 0


def test_both_phones_and_the_person_stay_on_the_floor_plan(phones: tuple[Path, Path], tmp_path: Path) -> None:
    pytest.importorskip("shapely")
    corridor = [[-3, -1], [37, -1], [37, 18], [34, 18], [34, 1], [-3, 1], [-3, -1]]
    floor_piece = {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [corridor]}}
    plan = {"type": "FeatureCollection", "coordinate_unit": "metre", "features": [floor_piece]}
    (tmp_path / "plan.geojson").write_text(json.dumps(plan), encoding="utf-8")
    smooth_both(phones, tmp_path / "out", "--start", 0, 0, "--heading", 0, "--plan", tmp_path / "plan.geojson")
    track = Track.from_csv(tmp_path / "out" / "track.csv")
    assert track.devices == ("hand", "pocket", "fused")
    assert track.region is not None
    assert len(track.region) == len(track)
    floor = read_floor_plan(tmp_path / "plan.geojson")
    assert {name: floor.contains(track.of_device(name).position_m).mean() > 0.95 for name in track.devices} == {
        "hand": True,
        "pocket": True,
        "fused": True,
    }
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert (summary["estimator"], summary["frame"]) == ("particle", "map")
    assert [device["places"]["share_of_poses_with_several"] <= 1.0 for device in summary["devices"]] == [True] * 3
