"""When Newton's method ends: one rule for headings alone, poses on arrays and the factor graph."""

from pdr_est.errors import EstimationError

EXACTLY = 1e-6
"""Predicted decrease of the error, half a chi square, below which a step is the last one."""

MAX_STEPS = 200
"""Number of steps after which the method has failed."""

MAX_HALVINGS = 20
"""Number of halvings of a step after which no decrease beyond rounding is to be had along it."""

_LEAST_CHANGE = 0.05  # of a pose, in standard deviations
_ARMIJO = 1e-4  # share of the decrease that the slope predicts


def decreases_enough(there: float, here: float, share: float, predicted_decrease: float) -> bool:
    """Tell whether a shortened step decreases the error enough (Armijo's condition).

    Parameters
    ----------
    there, here
        Error after and before it.
    share
        Share of the whole step.
    predicted_decrease
        Decrease of the error that the whole step would give if the problem were linear.
    """
    return there <= here - 2.0 * _ARMIJO * share * predicted_decrease


def may_end(poses: int, predicted_decrease: float, tolerance: float) -> bool:
    """Tell whether the method may end after the largest number of steps.

    It may where the next step would change the poses by less than a twentieth of their standard deviation (root mean
    square), and in rounds that are not the last one, whose result is only where the next round begins.
    """
    return tolerance > EXACTLY or predicted_decrease < 0.5 * _LEAST_CHANGE**2 * poses


def unsettled(poses: int, predicted_decrease: float) -> EstimationError:
    """Return the error for poses that the largest number of steps has not brought to rest."""
    return EstimationError(
        f"{poses} poses do not settle: step {MAX_STEPS} towards them would still decrease the error by "
        f"{predicted_decrease:.2g}: leave out measurements that contradict each other, or use ekf"
    )
