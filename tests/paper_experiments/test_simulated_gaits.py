"""Simulated runners and stair climbers beside real ones: the medians stay where real people are."""

import runpy
from pathlib import Path

import numpy as np
import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "experiments" / "simulated_gaits.py"
# 10th and 90th percentile of the real phones (MotionSense, pocket), widened by a tenth of the span on either side:
# vertical acceleration, 99th percentile, m/s^2; rotation rate, rms, rad/s; tilt, 95th percentile, deg; cadence, Hz
REAL = {
    "jogging, pocket": ((22.4, 45.4), (2.4, 4.8), (17.4, 34.0), (2.5, 3.0)),
    "stairs up, pocket": ((7.8, 17.2), (1.6, 3.0), (21.7, 40.7), (1.4, 2.2)),
    "stairs down, pocket": ((8.7, 20.0), (1.5, 3.0), (15.5, 25.8), (1.4, 2.6)),
}


@pytest.fixture(scope="module")
def script():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(SCRIPT.parent))
        yield runpy.run_path(str(SCRIPT))


@pytest.mark.slow
@pytest.mark.parametrize("gait", REAL)
def test_the_medians_of_simulated_pockets_lie_among_the_real_ones(script, gait) -> None:
    walks = script["simulated_gaits"](gait)
    measured = (
        [np.percentile(walk.vertical_mps2, 99) for walk in walks],
        [np.sqrt((walk.rotation_radps**2).mean()) for walk in walks],
        [np.percentile(walk.tilt_deg, 95) for walk in walks],
        [walk.cadence_hz for walk in walks],
    )
    for values, (least, most) in zip(measured, REAL[gait], strict=True):
        assert least < np.median(values) < most


def test_the_stride_hardly_shows_in_a_runner_at_the_belt(script) -> None:
    walks = script["simulated_gaits"]("slow jog, belt", range(3))
    assert max(script["stride_over_step"](walk) for walk in walks) < 0.01  # real ones below 0.005
    for walk in walks:
        assert 10.0 < np.percentile(walk.vertical_mps2, 99) < 22.0


def test_the_recorded_table_has_all_gaits_and_measures(script) -> None:
    text = (SCRIPT.parent / "results/simulated_gaits.txt").read_text(encoding="utf-8")
    for gait in script["GAITS"]:
        assert f"{gait}: " in text
    assert all(text.count(words) == len(script["GAITS"]) for words in script["MEASURES"])
