"""Dominant directions that are known in the map turn the walk into it."""

import numpy as np
import pytest
from estimator_walks import heading_prior, run, step
from test_relative_priors import relative

from pdr_est.estimators.common.map_directions import resolve_relative_priors
from pdr_est.frames import wrap_angle
from pdr_est.types.measurements import HeadingPrior, Measurement, StartPose

QUARTER = np.pi / 2.0
CASES = [(0.0, 0.3, 0.3), (0.0, 1.4, 1.4 - QUARTER), (1.4, 0.1, 0.1 + QUARTER)]


def corner_walk(zero_rad: float = 0.0) -> list[Measurement]:
    """Ten steps, a corner to the left, ten steps, with relative priors from zero_rad."""
    steps = [step(k, turn_rad=QUARTER if k == 11 else 0.0) for k in range(1, 21)]
    return [*steps, *(relative(k, (QUARTER if k > 10 else 0.0) - zero_rad) for k in range(2, 21, 3))]


@pytest.mark.parametrize(("walked", "direction", "expected"), CASES)
@pytest.mark.parametrize("zero_rad", [0.0, 2.0])
def test_the_walk_takes_the_nearest_of_the_directions(
    walked: float, direction: float, expected: float, zero_rad: float
) -> None:
    start = StartPose((0.0, 0.0), walked, 0.0, 0.2)
    walk = corner_walk(zero_rad)
    track = run("factor-graph", walk, start)
    known = resolve_relative_priors(walk, track, direction, QUARTER)
    priors = [m for m in known if isinstance(m, HeadingPrior)]
    assert not any(prior.relative for prior in priors)
    at_first = [expected if prior.time_s < 5.1 else expected + QUARTER for prior in priors]
    assert [prior.heading_rad for prior in priors] == pytest.approx(at_first, abs=0.02)
    assert len(known) == len(walk)
    assert all(a is b for a, b in zip(known, walk, strict=True) if not isinstance(b, HeadingPrior))


def test_a_walk_in_a_frame_of_its_own_is_turned_into_the_map() -> None:
    own = run("factor-graph", corner_walk(), StartPose())
    track = run("factor-graph", resolve_relative_priors(corner_walk(), own, 0.3, QUARTER), StartPose())
    assert wrap_angle(track.heading_rad[[5, 15]] - 0.3) == pytest.approx([0.0, QUARTER], abs=0.02)
    assert track.position_m[0] == pytest.approx([0.0, 0.0], abs=1e-3)
    assert np.arctan2(*track.position_m[10, ::-1]) == pytest.approx(0.3, abs=0.02)


def test_without_relative_priors_nothing_changes() -> None:
    walk: list[Measurement] = [step(1), heading_prior(1, 0.2)]
    known = resolve_relative_priors(walk, run("ekf", walk, StartPose()), 0.3, QUARTER)
    assert all(a is b for a, b in zip(known, walk, strict=True))
