"""Motion of many steps at once, against formulas sample by sample."""

from dataclasses import replace

import numpy as np
import pytest
from heading_steps import SAMPLES, block, walked
from scipy.spatial.transform import Rotation

from pdr_est.frames import Array, rotate_vectors
from pdr_est.front_end.heading.level_frame import to_level
from pdr_est.front_end.heading.north.north_offset import magnetic_north_offsets, recorded_north_offsets
from pdr_est.front_end.heading.step_motion import motions_of, step_motions, with_motions
from pdr_est.types.sensors import LevelBlock

DECLINED_RAD = 0.4


def tumbling(number: int, samples: int = SAMPLES) -> LevelBlock:
    """Samples of a phone in any attitude, whose field points to a north off by DECLINED_RAD."""
    rng = np.random.default_rng(number)
    up = rng.normal(size=(samples, 3))
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    yaw_rad = rng.uniform(-3.0, 3.0, samples)
    north = rotate_vectors(np.tile([0.0, 20.0], (samples, 1)), -DECLINED_RAD - yaw_rad)
    in_level = np.column_stack([north, np.full(samples, -40.0)])
    axis = np.cross([0.0, 0.0, 1.0], up)
    axis *= (np.arccos(up[:, 2]) / np.linalg.norm(axis, axis=1))[:, None]
    field = Rotation.from_rotvec(axis).apply(in_level) if samples else in_level
    plain = block(number)
    return replace(
        plain,
        time_s=np.arange(samples) / 50.0,
        up=up,
        yaw_rad=yaw_rad,
        acceleration_mps2=rng.normal(size=(samples, 3)),
        vertical_mps2=rng.normal(size=samples),
        magnetic_field_ut=field,
        recorded_yaw_rad=yaw_rad + DECLINED_RAD,
    )


def test_the_axes_and_the_direction_up_are_those_of_the_samples() -> None:
    samples = tumbling(3)
    (motion,) = step_motions([samples])
    total = samples.up.sum(axis=0)
    np.testing.assert_allclose(motion.up, total / np.linalg.norm(total), atol=1e-12)
    axes = [to_level(np.tile(axis, (SAMPLES, 1)), samples.up, samples.yaw_rad).sum(axis=0) for axis in np.eye(3)]
    np.testing.assert_allclose(np.transpose([motion.east, motion.north]), axes, atol=1e-12)


def leading(samples: LevelBlock) -> Array:
    """East and north part of the first harmonic that is a quarter of a step ahead of the vertical one."""
    wave = np.exp(-2j * np.pi * (np.arange(len(samples)) + 0.5) / len(samples))
    vertical = wave @ samples.vertical_mps2
    level = to_level(samples.acceleration_mps2, samples.up, samples.yaw_rad)
    return np.asarray((wave @ level * vertical.conj() / abs(vertical) / len(samples)).imag)


def test_the_leading_acceleration_is_the_first_harmonic_ahead_of_the_vertical_one() -> None:
    samples = [tumbling(number, count) for number, count in enumerate((25, 31, 4))]
    found = [motion.leading_mps2 for motion in step_motions(samples)]
    np.testing.assert_allclose(found, [leading(one) for one in samples], atol=1e-12)
    assert step_motions([tumbling(0, 3)])[0].leading_mps2 == (0.0, 0.0)


def test_nothing_depends_on_the_other_steps() -> None:
    samples = [
        tumbling(number, int(count)) for number, count in enumerate(np.random.default_rng(5).integers(0, 60, 300))
    ]
    assert step_motions(samples) == [step_motions([one])[0] for one in samples]
    for offsets in (magnetic_north_offsets, recorded_north_offsets):
        np.testing.assert_array_equal(offsets(samples), [offsets([one])[0] for one in samples])


def test_steps_keep_the_motion_that_they_have_until_it_is_filled_in_anew() -> None:
    steps = with_motions(walked([tumbling(number) for number in range(3)]))
    other = replace(steps[1], samples=tumbling(7))
    mixed = [steps[0], other, replace(steps[2], motion=None)]
    assert motions_of(mixed) == motions_of(steps)
    assert with_motions(mixed)[1].motion == step_motions([other.samples])[0]


@pytest.mark.parametrize("offsets", [magnetic_north_offsets, recorded_north_offsets])
def test_north_is_found_in_any_attitude_and_nan_where_it_is_not_recorded(offsets) -> None:  # type: ignore[no-untyped-def]
    without = replace(tumbling(1), magnetic_field_ut=None, recorded_yaw_rad=None)
    empty = tumbling(2, 0)
    found = offsets([tumbling(5), without, empty, tumbling(6)])
    np.testing.assert_allclose(found, [DECLINED_RAD, np.nan, np.nan, DECLINED_RAD], atol=1e-9)


def test_a_field_that_is_mostly_too_strong_is_not_that_of_the_earth() -> None:
    samples = tumbling(8)
    for strong, known in ((SAMPLES // 2 + 1, False), (SAMPLES // 2, True)):
        field = samples.magnetic_field_ut.copy()  # type: ignore[union-attr]
        field[:strong] *= 3.0
        (found,) = magnetic_north_offsets([replace(samples, magnetic_field_ut=field)])
        assert np.isnan(found) != known
