"""The experiment on the memory of the tracker, on a stream of minutes: nothing grows."""

import runpy
from pathlib import Path

import numpy as np
import pytest

from pdr_est.estimators import EstimatorName
from pdr_est.performance.online import tracker_for, walk_in_rounds
from pdr_est.types.sensors import Channel

EXPERIMENTS = Path(__file__).resolve().parents[2] / "experiments"
MEMORY = runpy.run_path(str(EXPERIMENTS / "online_memory.py"))
ROUND = walk_in_rounds(0.6, 25.0)


@pytest.mark.slow
@pytest.mark.parametrize("estimator", ["ekf", "fixed-lag"])
def test_the_state_of_a_stream_does_not_grow(estimator: EstimatorName) -> None:
    """Five minutes; a repetition takes about 35 s, after two minutes all that is kept for a time is there."""
    tracker, kept_bytes, seen = tracker_for(estimator), [], []
    for now_s, blocks, fix_is_due in MEMORY["stream"](ROUND, 5.0 / 60.0):
        seen += [len(update) for update in (tracker.push(name, block) for name, block in blocks)]
        if fix_is_due:
            tracker.push_fix(MEMORY["PositionFix"](now_s - 5.0, np.zeros(2), np.eye(2)))
        if now_s > 120.0 and now_s % 5.0 == 0.0:
            kept_bytes.append(len(tracker.state()))
    half = len(kept_bytes) // 2
    assert max(kept_bytes[half:]) < 1.05 * max(kept_bytes[:half])
    assert max(kept_bytes) < 2_000_000
    assert sum(seen) > 1500
    assert tracker.refused_fixes == tracker.missed_fixes == 0


def test_the_stream_goes_on_without_a_gap() -> None:
    times_s = [
        block.time_s
        for _, blocks, _ in MEMORY["stream"](ROUND, 0.05)
        for name, block in blocks
        if name == "a" and block.channel is Channel.SPECIFIC_FORCE
    ]
    apart_s = np.diff(np.concatenate(times_s))
    assert (apart_s > 0.0).all()
    assert apart_s.max() < 0.2


@pytest.mark.slow
def test_a_row_says_what_the_titles_say() -> None:
    row = next(MEMORY["hourly"](tracker_for("ekf"), ROUND, 600.0 / 3600.0))
    assert len(row) + 1 == len(MEMORY["TITLES"])
    assert row[0] == pytest.approx(1.0 / 6.0)
    assert row[4] > 1000
    assert len(MEMORY["as_line"]("ekf", row).split()) == len(MEMORY["TITLES"])
