"""Outliers among the fixes of a section: the probability of each, from its prediction by all the others.

The independent error of a fix is a mixture: as stated, or larger by one of `_OUTLIER_SIGMAS`. The mixture of a fix is
weighed by its leave-one-out residual, and its error then counts with the variance with which the fix moves the track
as far as the mixture does, until nothing changes: expectation propagation with inflated covariances.
"""

from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.fix_checks.position_regression import PlacementPrior, Regression, regress
from pdr_est.estimators.fix_checks.section import FixTable
from pdr_est.frames import SIGMA_UNIFORM_RAD, Array, wrap_angle

_OUTLIER_SIGMAS = np.array([3.0, 10.0, 40.0, 200.0])  # of the stated error; with their shares among the outliers
_OUTLIER_SHARES = np.array([0.45, 0.3, 0.2, 0.05])
_ROUNDS = 12
_SAME_RAD = 0.01  # change of the heading that is not worth another linearisation
_HEADINGS = 48  # first guesses round the circle, and scales
_FIRST_SCALES = (0.85, 1.0, 1.15)
_ROUGH_M = 4.0  # error of a rough guess beside those of the fixes


@dataclass(frozen=True)
class WeighedFixes:
    """Fixes of a section with their probabilities to be outliers.

    Attributes
    ----------
    score
        Logarithm of the evidence, with the cost of the outliers.
    outlier
        (n,) probability of each fix to be an outlier.
    more_m2
        (n,) variance that its error has more than stated in each coordinate, m².
    regression
        Solution with these variances.
    """

    score: float
    outlier: Array
    more_m2: Array
    regression: Regression


def weigh(
    fixes: FixTable,
    path_m: Array,
    common_m2: Array,
    heading: tuple[float, float] | None,
    sigma_scale: float,
) -> WeighedFixes:
    """Weigh the fixes of a section.

    Parameters
    ----------
    fixes
        Fixes, n in number.
    path_m
        (n, 2) points of the path at their times.
    common_m2
        (2 n, 2 n) covariance of the errors of these points and of the wandering errors of the fixes.
    heading
        Heading of the path and its standard deviation, rad; None if unknown.
    sigma_scale
        Standard deviation of the length scale.
    """
    guess_rad, distance_m, _ = rough_heading(fixes, path_m, None if heading is None else heading[0])
    sigma_m = fixes.sigma_m
    expected = (guess_rad, SIGMA_UNIFORM_RAD) if heading is None else heading
    prior = PlacementPrior(*expected, sigma_scale)
    far = np.where(distance_m > 3.0 * sigma_m + _ROUGH_M, distance_m**2, 0.0)
    tries = (
        [far] if not far.any() else [far, np.full(len(fixes), float(np.median(distance_m)) ** 2) + 25.0 * sigma_m**2]
    )
    found = [_converged(fixes, path_m, common_m2, prior, guess_rad, more_m2) for more_m2 in tries]
    return max(found, key=lambda one: one.score)


def _converged(
    fixes: FixTable, path_m: Array, common_m2: Array, prior: PlacementPrior, about_rad: float, more_m2: Array
) -> WeighedFixes:
    """Repeat regression and weighing from first variances."""
    sigma_m = fixes.sigma_m
    for number in range(_ROUNDS):
        solved = regress(fixes.position_m, path_m, common_m2, widened(fixes.white_m2, more_m2), prior, about_rad)
        about_rad = solved.heading_rad
        outlier, wanted_m2 = outliers(fixes, solved.left_out_m, solved.left_out_m2)
        settled = bool(np.all(np.abs(np.sqrt(wanted_m2) - np.sqrt(more_m2)) < 0.1 * sigma_m))
        if settled or number == _ROUNDS - 1:
            break
        share = 2.0 / (2.0 + number)  # where two fixes contradict each other, either wants to be the outlier
        more_m2 = more_m2 + share * (wanted_m2 - more_m2)
    if not settled or abs(wrap_angle(about_rad - solved.about_rad)) > _SAME_RAD:
        solved = regress(fixes.position_m, path_m, common_m2, widened(fixes.white_m2, more_m2), prior, about_rad)
    score = solved.log_evidence - float(outlier_cost(outlier, fixes.outlier_prior).sum())
    return WeighedFixes(score, outlier, more_m2, solved)


def outliers(fixes: FixTable, left_out_m: Array, left_out_m2: Array) -> tuple[Array, Array]:
    """Return the probability (n,) of each fix to be an outlier, and the variance (n,) that its error has more, m².

    Parameters
    ----------
    fixes
        Fixes, n in number.
    left_out_m, left_out_m2
        (n, 2) difference of each from its prediction by the others, and (n, 2, 2) covariance without its own
        independent error.
    """
    variance = np.outer(fixes.sigma_m**2, np.array([0.0, *_OUTLIER_SIGMAS]) ** 2)
    prior = np.column_stack([1.0 - fixes.outlier_prior, fixes.outlier_prior[:, None] * _OUTLIER_SHARES])
    spread = (left_out_m2 + fixes.white_m2)[:, None] + variance[:, :, None, None] * np.eye(2)
    squared = np.einsum("ia,ikab,ib->ik", left_out_m, np.linalg.inv(spread), left_out_m)
    logarithm = np.log(prior) - 0.5 * squared - 0.5 * np.log(np.linalg.det(spread))
    posterior = np.exp(logarithm - logarithm.max(axis=1, keepdims=True))
    posterior /= posterior.sum(axis=1, keepdims=True)
    wrong = np.maximum(posterior - prior, 0.0)[:, 1:].sum(axis=1)
    return 1.0 - posterior[:, 0], _variance_of_same_pull(wrong, fixes, left_out_m, left_out_m2)


def _variance_of_same_pull(wrong: Array, fixes: FixTable, left_out_m: Array, left_out_m2: Array) -> Array:
    """Return the variance (n,) that an error has more for its fix to move the prediction as far as both cases do.

    A fix that is as stated moves the prediction by the gain P / (P + R), and one that is wrong, with an error as
    large as the residual r, by P / (P + R + r²). The mean of the posterior moves by the mean of the gains, by their
    probabilities. The mean of the variances would move it by less: it would nearly ignore a fix that is far off but
    probably right.

    Parameters
    ----------
    wrong
        (n,) probability of each fix to be wrong.
    fixes, left_out_m, left_out_m2
        As for `outliers`.
    """
    apart_m2 = np.square(left_out_m).sum(axis=1)
    stated_m2, predicted_m2 = (0.5 * np.trace(one, axis1=1, axis2=2) for one in (fixes.white_m2, left_out_m2))
    right = (1.0 - wrong) / (predicted_m2 + stated_m2)
    other = wrong / (predicted_m2 + stated_m2 + apart_m2)
    return np.asarray(other * apart_m2 / (right + other))


def outlier_cost(outlier: Array, prior: Array) -> Array:
    """Return the divergence (n,) of the probabilities to be an outlier from those before any comparison."""
    sure = np.clip(outlier, 1e-12, 1.0 - 1e-12)
    return np.asarray(sure * np.log(sure / prior) + (1.0 - sure) * np.log((1.0 - sure) / (1.0 - prior)))


def widened(white_m2: Array, more_m2: Array) -> Array:
    """Add variances (n,) to covariances (n, 2, 2)."""
    return np.asarray(white_m2 + more_m2[:, None, None] * np.eye(2))


def rough_heading(fixes: FixTable, path_m: Array, known_rad: float | None) -> tuple[float, Array, float]:
    """Find the heading at which most of n fixes lie near the path.

    Parameters
    ----------
    fixes, path_m
        Fixes, and points (n, 2) of the path at their times, m.
    known_rad
        Heading of the path, rad; None if unknown.

    Returns
    -------
    float
        The heading, rad.
    Array
        (n,) distance of each fix from the path there, m.
    float
        How far they are from the path all together, without a unit: the logarithms of outliers grow slowly.
    """
    headings_rad = np.arange(_HEADINGS) * 2.0 * np.pi / _HEADINGS if known_rad is None else np.array([known_rad])
    turns = np.outer(_FIRST_SCALES, np.exp(1j * headings_rad)).ravel()
    offsets = (fixes.position_m @ [1.0, 1j])[None, :] - turns[:, None] * (path_m @ [1.0, 1j])
    middle = np.median(offsets.real, axis=1) + 1j * np.median(offsets.imag, axis=1)
    distance_m = np.abs(offsets - middle[:, None])
    cost = np.log1p(np.square(distance_m / (2.0 * fixes.sigma_m + _ROUGH_M))).sum(axis=1)
    best = int(np.argmin(cost))
    return float(np.angle(turns[best])), distance_m[best], float(cost[best])
