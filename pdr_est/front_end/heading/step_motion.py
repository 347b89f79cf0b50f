"""Posture and acceleration of the phone at each step, for many steps at once.

The mean yaw of a phone in any posture follows from the sums of its axes in the level frame (`phone_posture`), and the
direction in which the walker moves from the part of the horizontal acceleration that is ahead of the vertical one
(`course.leading_acceleration`). All of them are sums over the samples of a step.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.level_frame import axes_upright
from pdr_est.front_end.signal.step_samples import StepSamples, for_each_step
from pdr_est.records import changed, made
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import Step, StepMotion

LEAST_HARMONIC_SAMPLES = 4
"""Least number of samples for a first harmonic."""

# Rows of what is summed: up; east and north of the device axes and of the acceleration; real and imaginary parts; the
# square of the vertical acceleration.
_UP, _EAST, _NORTH, _HARMONICS, _SQUARE, _ROWS = slice(0, 3), slice(3, 7), slice(7, 11), slice(11, 17), 17, 18
_EAST_AXES, _NORTH_AXES, _ACCELERATION = slice(3, 6), slice(7, 10), 3
_LEAST_LENGTH = 1e-9
_LEAST_VERTICAL = 1e-9  # m/s^2
_NO_MOTION = StepMotion((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0), 0.0)


def motion_of(step: Step) -> StepMotion:
    """Return the motion of a step, computed where the step has none."""
    return step.motion or step_motions([step.samples])[0]


def motions_of(steps: Sequence[Step]) -> list[StepMotion]:
    """Return the motion of each step, computed at once for those that have none."""
    known = [step.motion for step in steps]
    computed = iter(step_motions([step.samples for step, one in zip(steps, known, strict=True) if one is None]))
    return [one or next(computed) for one in known]


def with_motions(steps: Sequence[Step]) -> list[Step]:
    """Return steps with the motion by their samples, whatever they had."""
    motions = step_motions([step.samples for step in steps])
    return [changed(step, motion=motion) for step, motion in zip(steps, motions, strict=True)]


def step_motions(samples: Sequence[LevelBlock]) -> list[StepMotion]:
    """Compute the motion of each of many steps from its samples.

    The order of the sums over a step is the same in whatever company it is: nothing depends on the others.
    """
    return for_each_step(samples, _motions, _NO_MOTION)


def _motions(samples: StepSamples) -> list[StepMotion]:
    """Compute the same for steps that all have samples."""
    of_step = samples.sums(_terms(samples))
    up = of_step[_UP]
    up /= np.maximum(np.sqrt((up * up).sum(axis=0)), _LEAST_LENGTH)
    ups, easts, norths = (zip(*of_step[rows].tolist(), strict=True) for rows in (_UP, _EAST_AXES, _NORTH_AXES))
    leading = zip(*_leading(of_step[_HARMONICS].reshape(3, 2, -1), samples.count).tolist(), strict=True)
    bounces = np.sqrt(of_step[_SQUARE] / samples.count).tolist()
    return [
        made(StepMotion, up=up, east=east, north=north, leading_mps2=acceleration, bounce_mps2=bounce)
        for up, east, north, acceleration, bounce in zip(ups, easts, norths, leading, bounces, strict=True)
    ]


def _terms(samples: StepSamples) -> Array:
    """Compute at each sample (_ROWS, n) what is summed over a step.

    These are the direction up, the east and the north components of the device axes and of the acceleration, the
    terms of the first harmonics of the vertical, the east and the north acceleration, and the square of the vertical
    one.
    """
    yaw_rad = samples.column("yaw_rad")
    up = samples.column("up").T.copy()
    acceleration = samples.column("acceleration_mps2").T.copy()
    x, y = axes_upright(up, acceleration)
    cos, sin = np.cos(yaw_rad), np.sin(yaw_rad)
    waves = [_wave(count) for count in samples.count.tolist()]
    wave = waves[0] if len(waves) == 1 else np.concatenate(waves, axis=1)
    terms = np.empty((_ROWS, len(yaw_rad)))
    terms[_UP] = up
    np.subtract(cos * x, sin * y, out=terms[_EAST])
    np.add(sin * x, cos * y, out=terms[_NORTH])
    vertical = samples.column("vertical_mps2")
    np.multiply(vertical, vertical, out=terms[_SQUARE])
    accelerations = vertical, terms[_EAST][_ACCELERATION], terms[_NORTH][_ACCELERATION]
    for harmonic, along in zip(terms[_HARMONICS].reshape(3, 2, -1), accelerations, strict=True):
        np.multiply(wave, along, out=harmonic)
    return terms


@lru_cache(maxsize=256)
def _wave(count: int) -> Array:
    """Return cosine and negative sine (2, count) of the phase of a step."""
    wave = np.exp(-2j * np.pi * (np.arange(count) + 0.5) / count)
    return np.stack([wave.real, wave.imag])


def _leading(harmonics: Array, counts: NDArray[np.intp]) -> Array:
    """Compute the leading acceleration (2, n) from first harmonics (3, 2, n).

    They are those of the vertical, the east and the north acceleration, each as real and imaginary part. Products of
    complex arrays are written out: their rounding may depend on where in the array a number is.
    """
    vertical, level = harmonics[0] / counts, harmonics[1:]
    size = np.sqrt((vertical * vertical).sum(axis=0))
    real, imaginary = vertical / (np.maximum(size, _LEAST_VERTICAL) * counts)
    leading = level[:, 1] * real - level[:, 0] * imaginary
    return np.where(counts >= LEAST_HARMONIC_SAMPLES, leading, 0.0)
