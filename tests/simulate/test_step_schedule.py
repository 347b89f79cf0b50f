"""Steps: exact number, lengths, times and feet."""

import numpy as np
import pytest

from pdr_est.errors import ConfigError
from pdr_est.simulate import Pause, WalkerGaitParams
from pdr_est.simulate.walker.step_schedule import plan_steps

REGULAR_GAIT = WalkerGaitParams(
    cadence_hz=2.0, step_length_m=0.75, cadence_variation=0.0, length_variation=0.0, boundary_step_share=1.0
)


def rng() -> np.random.Generator:
    return np.random.default_rng(3)


def test_a_regular_walk_has_exactly_the_steps_that_fit() -> None:
    steps = plan_steps(REGULAR_GAIT, 30.0, rng())
    assert len(steps) == 40
    np.testing.assert_allclose(steps.length_m, 0.75)
    np.testing.assert_allclose(steps.time_s, 3.0 + 0.5 * np.arange(1, 41))
    assert steps.end_s == pytest.approx(3.0 + 20.0 + 2.0)
    assert steps.foot[:4].tolist() == ["R", "L", "R", "L"]


def test_lengths_add_up_to_the_path_and_each_bout_to_its_part() -> None:
    gait = WalkerGaitParams(pauses=(Pause(at_m=20.0, duration_s=3.0), Pause(at_m=35.0, duration_s=5.0)))
    steps = plan_steps(gait, 61.7, rng())
    parts = [steps.length_m[bout].sum() for bout in steps.bouts]
    np.testing.assert_allclose(parts, [20.0, 15.0, 26.7], rtol=1e-12)
    breaks = [steps.start_s[bout][0] for bout in steps.bouts[1:]]
    ends = [steps.time_s[bout][-1] for bout in steps.bouts[:-1]]
    np.testing.assert_allclose(np.subtract(breaks, ends), [3.0, 5.0])


def test_step_lengths_follow_eq_9_of_mmpdr_and_shorten_at_the_ends() -> None:
    gait = WalkerGaitParams(height_m=1.6, gender="female", cadence_hz=1.9, length_variation=0.0)
    steps = plan_steps(gait, 400.0, rng())
    expected = 0.2975 * 1.6 / np.sqrt(steps.time_s - steps.start_s)
    share = steps.length_m / expected
    np.testing.assert_allclose(share[1:-1], share[1])  # one common factor makes the bout end on the path's end
    assert share[1] == pytest.approx(1.0, abs=0.005)
    np.testing.assert_allclose(share[[0, -1]], 0.6 * share[1])


def test_variation_has_the_asked_size() -> None:
    steps = plan_steps(WalkerGaitParams(cadence_variation=0.03, length_variation=0.0), 2000.0, rng())
    period = steps.time_s - steps.start_s
    assert period.mean() * 1.8 == pytest.approx(1.0, abs=0.005)
    assert period.std() * 1.8 == pytest.approx(0.03, rel=0.1)


@pytest.mark.parametrize("at_m", [(10.0, 10.0), (12.0, 5.0), (40.0,)])
def test_pauses_out_of_order_or_off_the_path_are_refused(at_m: tuple[float, ...]) -> None:
    gait = WalkerGaitParams(pauses=tuple(Pause(at_m=at, duration_s=1.0) for at in at_m))
    with pytest.raises(ConfigError, match="pauses"):
        plan_steps(gait, 40.0, rng())
