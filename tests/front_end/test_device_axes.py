"""No result depends on how the axes lie in a device, or on the zero of its yaw."""

from dataclasses import replace

import numpy as np
import pytest
from signals import corner_walk

from pdr_est.config import Config
from pdr_est.frames import Array, rotate_vectors
from pdr_est.pipeline import SmoothedWalk, smooth_recording
from pdr_est.preprocessing.turned_device import rotation_named, turn_devices
from pdr_est.simulate import mmpdr_indoor, mmpdr_mode_walks, simulate_walk
from pdr_est.simulate.people.population import PopulationParams, sample_population
from pdr_est.types.measurements import HeadingPrior
from pdr_est.types.recording import Recording, Signal
from pdr_est.types.sensors import AttitudeReference
from pdr_est.types.steps import CarryingMode

WALKS = {
    "held": mmpdr_indoor(CarryingMode.HOLDING, seed=1),
    "swung": mmpdr_indoor(CarryingMode.SWING, seed=2),
    "pocket": mmpdr_indoor(CarryingMode.POCKET, seed=1),
    "put away and taken out": mmpdr_mode_walks(3, 0)[1],
}


def smoothed(recording: Recording, **settings: object) -> SmoothedWalk:
    return smooth_recording(recording, Config().replace(settings))


def steps_of(walk: SmoothedWalk) -> Array:
    """Time, mode and length of each step."""
    return np.array([(step.event.time_s, step.event.mode, step.length_m) for step in walk.devices[0].steps])


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.slow] if name in ("held", "swung") else []) for name in WALKS],
)
def test_turned_axes_change_neither_steps_nor_track(name: str) -> None:
    recording = simulate_walk(WALKS[name]).recording
    plain = smoothed(recording)
    for turn in ("x180", "random:5"):
        turned = smoothed(turn_devices(recording, rotation_named(turn)))
        assert np.array_equal(steps_of(turned)[:, :2], steps_of(plain)[:, :2])
        assert steps_of(turned)[:, 2] == pytest.approx(steps_of(plain)[:, 2], abs=1e-6)
        assert turned.track.position_m == pytest.approx(plain.track.position_m, abs=1e-5)


def test_turned_axes_leave_north_where_it_was() -> None:
    parameters = PopulationParams(number=1, duration_s=60.0, magnetometer=True)
    (member,) = sample_population(parameters, 5)
    recording = turn_devices(simulate_walk(member.scenario).recording, rotation_named("z0"))  # of unknown axes
    before, after = (
        [m for m in smoothed(one).devices[0].whole_walk_odometry if isinstance(m, HeadingPrior) and not m.relative]
        for one in (recording, turn_devices(recording, rotation_named("x90")))
    )
    assert before
    for name in ("time_s", "heading_rad", "sigma_rad"):
        assert [getattr(m, name) for m in after] == pytest.approx([getattr(m, name) for m in before], abs=1e-6)


@pytest.mark.parametrize(
    "estimator", ["ekf", *(pytest.param(name, marks=pytest.mark.slow) for name in ("dead-reckoning", "factor-graph"))]
)
def test_a_start_heading_turns_the_track_and_changes_nothing_else(estimator: str) -> None:
    recording = simulate_walk(WALKS["put away and taken out"]).recording
    for heading_rad in (2.0, -3.0):
        ahead, turned = (
            smoothed(recording, **{"estimator.name": estimator, "start.heading_rad": angle}).track
            for angle in (0.0, heading_rad)
        )
        rotated = rotate_vectors(ahead.position_m, heading_rad)
        assert turned.position_m == pytest.approx(rotated, abs=1e-6)


def test_the_zero_of_the_recorded_yaw_changes_nothing() -> None:
    recording = corner_walk().recording
    device = recording.devices[0]
    assert device.attitude is not None
    tracks = []
    for yaw_rad in (0.0, 1.1, 3.1):
        w, x, y, z = device.attitude.values.T
        c, s = np.cos(0.5 * yaw_rad), np.sin(0.5 * yaw_rad)
        values = np.stack([c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w], axis=1)
        turned = replace(
            device,
            attitude=Signal(device.attitude.time_s, values),
            attitude_reference=AttitudeReference.ARBITRARY,
        )
        walk = replace(recording, devices=(turned,))
        tracks.append(smoothed(walk, **{"attitude.source": "device"}).track.position_m)
    for track in tracks[1:]:
        assert track == pytest.approx(tracks[0], abs=1e-6)
