"""`pdr-est track`: its lines, replayed and live."""

import io
import json
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from cli_recordings import Walk, save
from cli_runs import refused, run
from click.testing import CliRunner

from pdr_est import pipeline
from pdr_est.cli import main, tracking_streams
from pdr_est.config import Config
from pdr_est.io import read
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.types.recording import Signal

ZERO_NS = 1_698_501_144_000_000_000


def documents(text: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in text.splitlines()]


def test_a_replayed_recording_gives_the_track_of_the_filter(good: Path) -> None:
    result = run("track", good, "--start", 0, 0, "--heading", 0)
    assert (result.exit_code, result.stderr) == (0, "")
    rows = documents(result.stdout)
    assert {row["kind"] for row in rows} == {"filtered"}
    config = Config().with_estimator("ekf")
    whole = pipeline.smooth_recording(read(good), config).track
    assert [row["time_s"] for row in rows] == pytest.approx(whole.time_s, abs=1e-6)
    assert [[row["x_m"], row["y_m"]] for row in rows] == pytest.approx(whole.position_m, abs=0.02)


def test_a_fix_that_does_not_fit_is_told_when_it_shows(good: Path, tmp_path: Path) -> None:
    table = tmp_path / "fixes.csv"
    table.write_text("time_s,x_m,y_m,sigma_m\n5.0,80.0,-60.0,1.0\n", encoding="utf-8")
    result = run("track", good, "--start", 0, 0, "--heading", 0, "--fixes", table)
    assert result.exit_code == 0
    told = [line for line in result.stderr.splitlines() if "the position fix (file) at 5.0 s disagrees" in line]
    assert len(told) == 1
    assert told[0].startswith("warning: ")
    (row,) = [row for row in documents(result.stdout) if "fixes" in [one["kind"] for one in row.get("findings", ())]]
    assert row["time_s"] > 5.0
    assert f"warning: {row['findings'][0]['message']}" in told
    later = [row for row in documents(result.stdout) if row["time_s"] > 5.0]
    assert row["time_s"] == min(one["time_s"] for one in later)


def test_fixed_lag_gives_both_kinds_and_a_file(good: Path, tmp_path: Path) -> None:
    out = tmp_path / "lines.jsonl"
    result = run("track", good, "--estimator", "fixed-lag", "-o", out)
    assert (result.exit_code, result.stdout) == (0, "")
    kinds = [row["kind"] for row in documents(out.read_text(encoding="utf-8"))]
    assert kinds.count("filtered") == kinds.count("delayed") > 10
    assert "exists" in refused("track", good, "-o", out)
    assert run("track", good, "-o", out, "--overwrite").exit_code == 0


def test_two_recordings_are_two_phones(good: Path, tmp_path: Path) -> None:
    other = tmp_path / f"other{good.suffix}"
    other.write_bytes(good.read_bytes())
    result = run("track", good, other)
    assert result.stderr.startswith("warning: not every recording has a date: their times are assumed to count from")
    rows = documents(result.stdout)
    assert {row["device"] for row in rows} == {good.stem, "other", "fused"}
    assert {row["device"] for row in documents(run("track", good, good).stdout)} == {"device"}  # it counts once
    assert run("track", good, good).stderr == ""


def begun(good: Path, folder: Path, later_s: float) -> Path:
    """The recording of `good`, made later."""
    recording = read(good)
    (device,) = recording.devices
    moved = replace(device, name="other").with_times(lambda time_s: time_s + later_s)
    path = folder / "other.csv"
    write_plain_csv(replace(recording, name="other", devices=(moved,)), path)
    return path


def test_a_wrong_unit_is_refused_as_by_smooth(good: Path, tmp_path: Path) -> None:
    """Read as metres per second squared, an acceleration in g would have no steps, and nobody would be told."""
    recording = read(good)
    (device,) = recording.devices
    assert device.specific_force is not None
    in_g = Signal(device.specific_force.time_s, device.specific_force.values / 9.81)
    wrong = tmp_path / "wrong.csv"
    write_plain_csv(replace(recording, devices=(replace(device, specific_force=in_g),)), wrong)
    output = tmp_path / "track.jsonl"
    assert "acceleration is in g" in refused("track", wrong, "-o", output)
    assert not output.exists()


@pytest.mark.parametrize("sparse", [False, True], ids=["backwards", "seconds apart"])
def test_no_usable_sample_is_refused_as_by_smooth(sparse: bool, lines: list[str], tmp_path: Path) -> None:
    wrong, output = tmp_path / "wrong.csv", tmp_path / "track.jsonl"
    header, *rows = lines
    save(wrong, [header, *(rows[::100] if sparse else reversed(rows))])
    words = refused_after_warnings("track", wrong, "-o", output)
    assert refused("smooth", wrong, "-o", tmp_path / "out").startswith(words[: words.index("accelerometer")][:-20])
    assert ("lie 2 s apart" if sparse else "run backwards: sort its rows by time") in words
    assert not output.exists()


def refused_after_warnings(*arguments: object) -> str:
    """The error of a call that warns first, and prints nothing."""
    result = run(*arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    return result.stderr.splitlines()[-1].removeprefix("Error: ")


def test_phones_that_did_not_record_together_are_refused(good: Path, tmp_path: Path) -> None:
    words = refused("track", good, begun(good, tmp_path, 3600.0), "-o", tmp_path / "lines.jsonl")
    assert "less than 5 s of it together" in words
    assert "track them one by one, or use `pdr-est smooth`" in words
    assert not (tmp_path / "lines.jsonl").exists()


def test_a_phone_that_begins_late_is_told(good: Path, tmp_path: Path) -> None:
    result = run("track", good, begun(good, tmp_path, 6.0))
    assert result.exit_code == 0
    assert "other: began to record 6.0 s after" in result.stderr
    assert "other: started late, assumed to start where the other phones were at that time" in result.stderr


def test_ctrl_c_ends_a_live_walk_with_all_that_was_held_back(walk: Walk) -> None:
    sent = messages(walk)

    def interrupted() -> Iterator[str]:
        yield from sent
        raise KeyboardInterrupt

    stopped, ended = io.StringIO(), io.StringIO()
    config = Config().with_estimator("ekf")
    tracking_streams.follow_live(interrupted(), config, None, False, stopped)
    tracking_streams.follow_live(sent, config, None, False, ended)
    assert stopped.getvalue() == ended.getvalue() != ""


def test_in_real_time_it_waits_for_every_moment(good: Path, walk: Walk, monkeypatch: pytest.MonkeyPatch) -> None:
    """By a clock that only sleeping moves: no estimate comes before its time, and the walk takes its time."""
    now_s, written = [100.0], []
    clock = SimpleNamespace(monotonic=lambda: now_s[0], sleep=lambda for_s: now_s.__setitem__(0, now_s[0] + for_s))
    monkeypatch.setattr(tracking_streams, "time", clock)

    class TimedStream(io.StringIO):
        def write(self, text: str) -> int:
            written.append((now_s[0] - 100.0, json.loads(text)["time_s"]))
            return super().write(text)

    stream = TimedStream()
    tracking_streams.replay(read(good), (), Config(), True, stream)
    assert documents(stream.getvalue()) == documents(run("track", good).stdout)
    assert now_s[0] - 100.0 == pytest.approx(walk.time_s[-1], abs=0.2)
    came_s, times_s = np.array(written).T
    assert (came_s + 0.15 > times_s).all()
    assert came_s[0] < 0.6 * walk.time_s[-1]


@pytest.mark.slow
def test_real_time_is_that_of_the_clock(lines: list[str], tmp_path: Path) -> None:
    short = tmp_path / "short.csv"
    short.write_text("\n".join(lines[:76]) + "\n", encoding="utf-8")  # 1.5 s at 50 Hz
    begin_s = time.monotonic()
    assert run("track", short, "--realtime").exit_code == 0
    assert time.monotonic() - begin_s > 1.3


def messages(walk: Walk) -> list[str]:
    """A walk as an Android phone would send it, a second at a time."""
    time_s, lines = walk.time_s, []
    for number in range(int(time_s[-1]) + 1):
        payload = []
        for i in np.flatnonzero((time_s >= number) & (time_s < number + 1)):
            stamp = ZERO_NS + round(float(time_s[i]) * 1e9)
            for name, (x, y, z) in (
                ("gravity", (0.0, 0.0, 9.8)),
                ("accelerometer", walk.force[i] - [0.0, 0.0, 9.8]),
                ("gyroscope", walk.rate[i]),
            ):
                payload.append({"name": name, "time": stamp, "values": {"x": x, "y": y, "z": z}})
        lines.append(json.dumps({"messageId": number, "sessionId": "s", "deviceId": "phone", "payload": payload}))
    return lines


def live(text: str, *options: str) -> Any:
    return CliRunner().invoke(main, ["track", "-", *options], input=io.BytesIO(text.encode()), prog_name="pdr-est")


def test_live_messages_and_a_damaged_line(walk: Walk) -> None:
    lines = messages(walk)
    lines.insert(3, '{"messageId": 3, "payload')
    result = live("\n".join(lines), "--platform", "android")
    assert result.exit_code == 0
    assert result.stderr.startswith(
        "warning: line 4: not JSON: damaged or cut off at character 26 of 26: line ignored"
    )
    assert result.stderr.count("\n") == 1
    rows = documents(result.stdout)
    assert len(rows) > 10
    assert {row["device"] for row in rows} == {"phone"}
    assert np.hypot(rows[-1]["x_m"], rows[-1]["y_m"]) > 5.0


@pytest.mark.parametrize(("text", "words"), [("", "is empty"), ("bad\nworse\n", "none of 2 lines")])
def test_nothing_but_damage_is_refused(text: str, words: str) -> None:
    result = live(text)
    assert (result.exit_code, result.stdout) == (2, "")
    assert words in result.stderr


def test_what_is_lost_is_told(walk: Walk) -> None:
    """Fixes from long ago, and a phone without gyroscope."""
    lines = messages(walk)
    place = {"latitude": 48.0, "longitude": 11.0, "horizontalAccuracy": 5.0}
    fix = {"name": "location", "time": ZERO_NS - 25_000_000_000, "values": place}
    last = json.loads(lines[-1])
    last["payload"].append(fix)
    lines[-1] = json.dumps(last)
    only_force = [one for one in json.loads(lines[0])["payload"] if one["name"] != "gyroscope"]
    lines.append(json.dumps({"messageId": 0, "sessionId": "s", "deviceId": "other", "payload": only_force}))
    result = live("\n".join(lines), "--platform", "android", "--fixes", "recording")
    assert result.exit_code == 0
    assert "came more than 30 s late" in result.stderr
    assert "in total: 1 fixes came too late and were rejected" in result.stderr
    assert "warning: other: no samples of accelerometer and gyroscope" in result.stderr


def test_positions_of_phones_count_in_the_map_of_the_plan(walk: Walk, tmp_path: Path) -> None:
    """The place is 55 m north of the plan's south-western corner, the origin of the map."""
    pytest.importorskip("shapely")
    lines = messages(walk)
    first = json.loads(lines[0])
    place = {"latitude": 48.0005, "longitude": 11.0, "horizontalAccuracy": 1.0}
    first["payload"].append({"name": "location", "time": first["payload"][-1]["time"], "values": place})
    lines[0] = json.dumps(first)
    ring = [[11.0, 48.0], [11.002, 48.0], [11.002, 48.002], [11.0, 48.002], [11.0, 48.0]]
    plan = {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [ring]}}
    (tmp_path / "plan.geojson").write_text(json.dumps(plan))
    options = ("--platform", "android", "--fixes", "recording", "--plan", str(tmp_path / "plan.geojson"))
    rows = documents(live("\n".join(lines), *options).stdout)
    assert rows[2]["y_m"] == pytest.approx(55.6, abs=5.0)


def test_options_that_do_not_go_together(good: Path) -> None:
    assert "needs the whole walk: use --estimator ekf or fixed-lag" in refused(
        "track", good, "--estimator", "factor-graph"
    )
    assert "estimator factor-graph or ekf" in refused("track", good, "--closed", "--estimator", "fixed-lag")
    assert "- cannot be combined with other recordings" in refused("track", "-", good)
    assert "- cannot be combined with other recordings" in refused("track", "-", "--realtime")
    mapping = good.parent / "live.yaml"
    mapping.write_text("time: {rate_hz: 50}\naccelerometer: {x: a, y: b, z: c}\n", encoding="utf-8")
    assert "--map" in refused("track", "-", "--map", mapping)
    assert "--platform is for" in refused("track", good, "--platform", "ios")
