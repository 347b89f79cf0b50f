"""`pdr-est track`: its lines, replayed and live."""

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_recordings import Walk
from cli_runs import refused, run
from click.testing import CliRunner

from pdr_est import pipeline
from pdr_est.cli import main
from pdr_est.config import Config
from pdr_est.io import read

ZERO_NS = 1_698_501_144_000_000_000


def documents(text: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in text.splitlines()]


def test_a_replayed_recording_gives_the_track_of_the_filter(good: Path) -> None:
    result = run("track", good, "--start", 0, 0, "--heading", 0)
    assert (result.exit_code, result.stderr) == (0, "")
    rows = documents(result.stdout)
    assert {row["kind"] for row in rows} == {"filtered"}
    config = Config().with_estimator("ekf")
    whole = pipeline.smooth(read(good), config).track
    assert [row["time_s"] for row in rows] == pytest.approx(whole.time_s, abs=1e-6)
    assert [[row["x_m"], row["y_m"]] for row in rows] == pytest.approx(whole.position_m, abs=0.02)


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
    rows = documents(run("track", good, other).stdout)
    assert {row["device"] for row in rows} == {good.stem, "other"}
    assert {row["device"] for row in documents(run("track", good, good).stdout)} == {"device"}  # it counts once


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
    assert result.stderr.startswith("warning: line 4: no JSON")
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


def test_options_that_do_not_go_together(good: Path) -> None:
    assert "stands alone" in refused("track", "-", good)
    assert "stands alone" in refused("track", "-", "--realtime")
    assert "--platform is for" in refused("track", good, "--platform", "ios")
