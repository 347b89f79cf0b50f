"""Posture and acceleration of the phone at each step, for many steps at once.

The mean yaw of a phone in any posture follows from the sums of its axes in the level frame (`phone_posture`), and the
direction in which the walker moves from the part of the horizontal acceleration that is ahead of the vertical one
(`course.leading_acceleration`). All of them are sums over the samples of a step.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.level_frame import axes_upright
from pdr_est.records import changed, made
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import Step, StepMotion

LEAST_HARMONIC_SAMPLES = 4
"""Least number of samples for a first harmonic."""

Result = TypeVar("Result")

_AT_ONCE = 128  # steps: their samples fit into the cache of a processor
_AXES = (slice(0, 3), slice(3, 6), slice(7, 10))  # rows of up, and of the device axes to the east and to the north
_FIRST = np.zeros(1, dtype=np.int64)
_LEAST_LENGTH = 1e-9
_LEAST_VERTICAL = 1e-9  # m/s^2
_NO_MOTION = StepMotion((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0))


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


def for_each_step(
    samples: Sequence[LevelBlock], compute: Callable[[Sequence[LevelBlock]], Sequence[Result]], without: Result
) -> list[Result]:
    """Compute something of each of many steps from its samples, for some steps at once.

    Parameters
    ----------
    samples : sequence of LevelBlock
        Samples of each step.
    compute : callable
        Function of the samples of some steps, at least one sample each, that returns the result of each step.
    without
        Result of a step without samples.
    """
    found = [without] * len(samples)
    usable = [number for number, block in enumerate(samples) if len(block.yaw_rad)]
    for begin in range(0, len(usable), _AT_ONCE):
        part = usable[begin : begin + _AT_ONCE]
        for number, result in zip(part, compute([samples[number] for number in part]), strict=True):
            found[number] = result
    return found


def first_samples(samples: Sequence[LevelBlock]) -> NDArray[np.int64]:
    """Return where the first sample of each step (n,) is in the samples of all."""
    if len(samples) == 1:
        return _FIRST
    return np.cumsum([0, *(len(block.yaw_rad) for block in samples[:-1])])


def _joined(arrays: Sequence[Array]) -> Array:
    """Join the rows of arrays; a single one is returned as it is."""
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)


def _motions(samples: Sequence[LevelBlock]) -> list[StepMotion]:
    """Compute the same for steps that all have samples."""
    counts = [len(block.yaw_rad) for block in samples]
    of_step = np.add.reduceat(_terms(samples, counts), first_samples(samples), axis=1)
    length = np.sqrt((of_step[:3] * of_step[:3]).sum(axis=0))
    of_step[:3] /= np.maximum(length, _LEAST_LENGTH)
    ups, easts, norths = (zip(*of_step[rows].tolist(), strict=True) for rows in _AXES)
    leading = zip(*_leading(of_step[11:], np.array(counts)).tolist(), strict=True)
    return [
        made(StepMotion, up=up, east=east, north=north, leading_mps2=acceleration)
        for up, east, north, acceleration in zip(ups, easts, norths, leading, strict=True)
    ]


def _terms(samples: Sequence[LevelBlock], counts: Sequence[int]) -> Array:
    """Compute at each sample (17, n) what is summed over a step.

    These are the direction up, the east and the north components of the device axes and of the acceleration, and the
    terms of the first harmonics of the vertical, the east and the north acceleration.
    """
    yaw_rad = _joined([block.yaw_rad for block in samples])
    up = _joined([block.up for block in samples]).T.copy()
    acceleration = _joined([block.acceleration_mps2 for block in samples]).T.copy()
    x, y = axes_upright(up, acceleration)
    cos, sin = np.cos(yaw_rad), np.sin(yaw_rad)
    waves = [_wave(count) for count in counts]
    wave = waves[0] if len(waves) == 1 else np.concatenate(waves, axis=1)
    terms = np.empty((17, len(yaw_rad)))
    terms[:3] = up
    east = np.subtract(cos * x, sin * y, out=terms[3:7])
    north = np.add(sin * x, cos * y, out=terms[7:11])
    np.multiply(wave, _joined([block.vertical_mps2 for block in samples]), out=terms[11:13])
    np.multiply(wave, east[3], out=terms[13:15])
    np.multiply(wave, north[3], out=terms[15:])
    return terms


@lru_cache(maxsize=256)
def _wave(count: int) -> Array:
    """Return cosine and negative sine (2, count) of the phase of a step."""
    wave = np.exp(-2j * np.pi * (np.arange(count) + 0.5) / count)
    return np.stack([wave.real, wave.imag])


def _leading(sums: Array, counts: Array) -> Array:
    """Compute the leading acceleration (2, n) from the first harmonics (6, n), each as real and imaginary part.

    Products of complex arrays are written out: their rounding may depend on where in the array a number is.
    """
    vertical = sums[:2] / counts
    size = np.sqrt((vertical * vertical).sum(axis=0))
    real, imaginary = vertical / (np.maximum(size, _LEAST_VERTICAL) * counts)
    leading = sums[3::2] * real - sums[2::2] * imaginary
    return np.where(counts >= LEAST_HARMONIC_SAMPLES, leading, 0.0)
