"""Walking direction of simulated walkers by the rotation of the limb that carries the phone."""

from functools import cache

import numpy as np
import pytest
from signals import run

from pdr_est.config import Config
from pdr_est.frames import wrap_angle
from pdr_est.front_end.attitude import AttitudeParams
from pdr_est.front_end.heading.phone_posture import posture_of
from pdr_est.front_end.heading.placement_change.limb_swing import density_by_rotation
from pdr_est.front_end.heading.placement_change.placement_tracker import common_up
from pdr_est.front_end.heading.placement_change.stride_cues import stride_cues
from pdr_est.front_end.heading.placement_change.turn_density import ANGLES_RAD
from pdr_est.front_end.heading.step_motion import motion_of
from pdr_est.pipeline.front_end_chain import levelling, stepping
from pdr_est.simulate import PathParams, Scenario, SensorParams, SimulatedWalk, sample_person, simulate_walk
from pdr_est.simulate.people.carried_device import carried_device
from pdr_est.types.steps import CarryingMode, Step

HOLDING, SWING, POCKET = CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET


@cache
def walked(seed: int, mode: CarryingMode) -> tuple[SimulatedWalk, list[Step]]:
    """A straight walk of 20 m and its steps; the level frame is that of the truth."""
    rng = np.random.default_rng([seed, 41])
    person = sample_person(rng)
    device = carried_device(person, [mode], [], rng, SensorParams(rate_hz=50.0, record_attitude=True))
    path = PathParams(vertices_m=((0.0, 0.0), (-12.0, 16.0)))
    walk = simulate_walk(Scenario(path=path, gait=person.gait, body=person.body, devices=(device,), seed=seed))
    config = Config(attitude=AttitudeParams(source="device"))
    _, to_level = levelling(walk.recording.devices[0], "phone", config)
    return walk, run(stepping(config), run(to_level, walk.recording.devices[0].blocks()))


def share_near(walk: SimulatedWalk, steps: list[Step], within_rad: float) -> float:
    """Share of the density that is near the true direction, relative to the phone, over some steps."""
    up = common_up(steps)
    density = density_by_rotation(stride_cues(steps, up))
    heading = walk.heading_at(np.array([step.event.time_s for step in steps]))
    posture = posture_of(up)
    yaw = np.array([posture.yaw_rad(motion_of(step)) for step in steps])
    ahead = float(np.angle(np.mean(np.exp(1j * (heading - yaw)))))
    return float(density[np.abs(wrap_angle(ANGLES_RAD - ahead)) < within_rad].sum() / density.sum())


@pytest.mark.parametrize("mode", [SWING, POCKET])
def test_a_limb_tells_forward_from_backward_whichever_step_comes_first(mode: CarryingMode) -> None:
    shares = []
    for seed in range(8):
        walk, steps = walked(seed, mode)
        middle = [step for step in steps[4:-4] if step.event.mode is mode]
        assert len(middle) > 10
        shares += [share_near(walk, middle[first : first + 8], np.deg2rad(45.0)) for first in (0, 1)]
    assert np.sort(shares)[1] > 0.7  # of one of the eight a window of steps leaves it open
    assert np.median(shares) > 0.9


def test_a_held_phone_tells_nothing_by_its_rotation() -> None:
    _, steps = walked(0, HOLDING)
    assert np.array_equal(density_by_rotation(stride_cues(steps[4:12], common_up(steps[4:12]))), np.ones(360))
