"""Whether headings of smoothed tracks err as much as their sigma says, on simulated walks in an office."""

from functools import cache

import numpy as np
import pytest

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.frames import Array, wrap_angle
from pdr_est.simulate import (
    DeviceParams,
    PathParams,
    Scenario,
    SensorErrors,
    SensorParams,
    sample_person,
    simulate_walk,
)

WALKS = 10  # of each way to carry the phone
FIRST_STEPS = 6  # whose mean error is taken for that of the start, which is unknown in a frame of its own
GYROSCOPE = SensorErrors(
    noise_std=0.005, bias_std=float(np.deg2rad(0.15)), bias_walk=float(np.deg2rad(0.003)), scale_std=0.003
)


def office_walk(number: int, carry: str) -> Scenario:
    """4 to 8 legs of 8 to 25 m that meet at right angles."""
    rng = np.random.default_rng([number, 77])
    person = sample_person(rng)
    heading_rad, corner, vertices = 0.0, np.zeros(2), [(0.0, 0.0)]
    for _ in range(int(rng.integers(4, 9))):
        corner = corner + rng.uniform(8.0, 25.0) * np.array([np.cos(heading_rad), np.sin(heading_rad)])
        vertices.append((float(corner[0]), float(corner[1])))
        heading_rad += float(rng.choice([-1.0, 1.0])) * np.pi / 2.0
    device = DeviceParams(
        carry=person.held if carry == "held" else person.pocket, sensors=SensorParams(gyroscope=GYROSCOPE)
    )
    path = PathParams(vertices_m=tuple(vertices))
    return Scenario(path=path, gait=person.gait, body=person.body, devices=(device,), seed=number)


@cache
def errors(carry: str) -> tuple[tuple[Array, Array], ...]:
    """Of each walk the errors (n,) of the smoothed headings, rad, and their standard deviations (n,)."""
    found = []
    for number in range(WALKS):
        walk = simulate_walk(office_walk(number, carry))
        track = pipeline.smooth_recording(walk.recording, Config()).track
        middle_s = 0.5 * (track.moving_from_s[1:] + track.time_s[1:])
        error = wrap_angle(track.heading_rad[1:] - walk.heading_at(middle_s))
        at_start = np.angle(np.mean(np.exp(1j * error[:FIRST_STEPS])))
        found.append((wrap_angle(error - at_start), track.sigma_heading_rad[1:]))
    return tuple(found)


def rms(values: Array | list[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.mark.slow
@pytest.mark.parametrize("carry", ["held", "pocket"])
def test_headings_in_an_office_are_right(carry: str) -> None:
    """A pocket, whose walker sways before setting off, is as good as a hand."""
    in_all = rms([rms(error) for error, _ in errors(carry)])
    assert np.rad2deg(in_all) < 5.0


@pytest.mark.slow
def test_normalised_errors_are_about_one() -> None:
    normalised = rms([rms(error / sigma) for carry in ("held", "pocket") for error, sigma in errors(carry)])
    assert 0.7 < normalised < 1.2
