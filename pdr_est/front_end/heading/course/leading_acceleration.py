"""The part of the horizontal acceleration that tells the direction in which the walker moves, for each step.

The trunk exchanges height for speed like an inverted pendulum: the acceleration along the way is ahead of the
vertical one by a quarter of a step (see `principal_axis`). This holds along the direction of motion and not along
that of the body: of a walker who moves backwards it points backwards. Its first harmonic in each step, as a vector,
points to where the walker moves.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pdr_est.front_end.heading.level_frame import to_level, turn_upright
from pdr_est.types.steps import CarryingMode, Step

_LEAST_SAMPLES = 4  # for a first harmonic
_LEAST_VERTICAL = 1e-9  # m/s^2


def leading_acceleration(steps: Sequence[Step]) -> NDArray[np.complex128]:
    """Compute the horizontal acceleration of each step that is ahead of the vertical one by a quarter of a step.

    Parameters
    ----------
    steps : sequence of Step
        Steps.

    Returns
    -------
    ndarray of complex, shape (n,)
        Amplitude, m/s^2, in the level frame of the yaw; 0 for a step with too few samples. The sway of a stride is
        contained with opposite signs in two neighbouring steps.
    """
    found = np.zeros(len(steps), dtype=np.complex128)
    usable = [k for k, step in enumerate(steps) if len(step.samples) >= _LEAST_SAMPLES]
    if not usable:
        return found
    samples = [steps[k].samples for k in usable]
    count = np.array([len(one) for one in samples])
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    phase = (np.arange(count.sum()) - np.repeat(first, count) + 0.5) / np.repeat(count, count)
    wave = np.exp(-2j * np.pi * phase)
    level = to_level(
        np.concatenate([one.acceleration_mps2 for one in samples]),
        np.concatenate([one.up for one in samples]),
        np.concatenate([one.yaw_rad for one in samples]),
    )
    vertical = np.add.reduceat(wave * np.concatenate([one.vertical_mps2 for one in samples]), first) / count
    in_phase = vertical.conj() / np.maximum(np.abs(vertical), _LEAST_VERTICAL)
    along, across = (np.add.reduceat(wave * axis, first) / count * in_phase for axis in level.T)
    found[usable] = along.imag + 1j * across.imag
    return found


def leading_acceleration_of(step: Step) -> complex:
    """Compute the same for one step at a fraction of the cost."""
    samples = step.samples
    count = len(samples)
    if count < _LEAST_SAMPLES:
        return 0.0
    wave = _wave(count)
    first, second = turn_upright(samples.acceleration_mps2.T, samples.up)
    level = (first + 1j * second) * np.exp(1j * samples.yaw_rad)
    vertical = complex(wave.dot(samples.vertical_mps2)) / count
    in_phase = vertical.conjugate() / max(abs(vertical), _LEAST_VERTICAL) / count
    return complex((wave.dot(level.real) * in_phase).imag, (wave.dot(level.imag) * in_phase).imag)


@lru_cache(maxsize=256)
def _wave(count: int) -> NDArray[np.complex128]:
    wave: NDArray[np.complex128] = np.exp(-2j * np.pi * (np.arange(count) + 0.5) / count)
    return wave


def shows_course(step: Step) -> bool:
    """Return True for a detected and fully recorded step of a phone that is not in a swinging hand."""
    whole = step.recorded_share >= 1.0 and len(step.samples) >= _LEAST_SAMPLES
    return whole and not step.event.compensated and step.event.mode is not CarryingMode.SWING
