"""The part of the horizontal acceleration that tells the direction in which the walker moves, for each step.

The trunk exchanges height for speed like an inverted pendulum: the acceleration along the way is ahead of the
vertical one by a quarter of a step (see `principal_axis`). This holds along the direction of motion and not along
that of the body: of a walker who moves backwards it points backwards. Its first harmonic in each step, as a vector,
points to where the walker moves.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pdr_est.front_end.heading.step_motion import LEAST_HARMONIC_SAMPLES, motions_of
from pdr_est.types.steps import CarryingMode, Step


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
    return np.array([complex(*motion.leading_mps2) for motion in motions_of(steps)], dtype=np.complex128)


def shows_course(step: Step) -> bool:
    """Return True for a detected and fully recorded step of a phone that is not in a swinging hand."""
    whole = step.recorded_share >= 1.0 and len(step.samples) >= LEAST_HARMONIC_SAMPLES
    return whole and not step.event.compensated and step.event.mode is not CarryingMode.SWING
