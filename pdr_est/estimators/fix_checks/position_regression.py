"""Joint Gaussian model of the fixes of a walk: the path of the steps, placed, turned and scaled, and all errors.

A fix is z = p0 + s R(heading) q + errors, with the point q of the dead-reckoned path. Place, heading and scale of the
path enter by their priors, heading and scale to first order about a heading near the solution. The model gives
evidence and leave-one-out residuals in closed form.
"""

from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.fix_checks.dead_reckoned_path import LEFT
from pdr_est.frames import Array, rotate_vectors, rotation_matrix

UNKNOWN_POSITION_M = 300.0
"""Standard deviation of the place of a path about its first fix, m: vague, but not so that digits are lost."""


@dataclass(frozen=True)
class PlacementPrior:
    """Prior of heading and length scale of a path in the map.

    Attributes
    ----------
    heading_rad, sigma_heading_rad
        Rotation of the path and its standard deviation, rad.
    sigma_scale
        Standard deviation of the length scale around 1.
    """

    heading_rad: float
    sigma_heading_rad: float
    sigma_scale: float


@dataclass(frozen=True)
class Regression:
    """Solution of the model for n fixes.

    Attributes
    ----------
    log_evidence
        Logarithm of the probability density of the fixes.
    heading_rad, log_scale
        Posterior mean of heading and logarithm of the length scale.
    placement_covariance
        Their covariance (2, 2).
    left_out_m
        (n, 2) each fix less its prediction from all others, m, in the map frame.
    left_out_m2
        (n, 2, 2) covariance of that difference without the independent error of the fix itself, m².
    information
        (2 n, 2 n) inverse of the covariance of all fixes, in the frame of the path.
    pulled
        (2 n,) product of `information` with the residuals.
    about_rad
        Rotation from the frame of the path to the map.
    prior
        Prior of the placement.
    squared
        Sum of the squared normalised residuals, chi-squared for a model that fits.
    origin_m
        Points of the map and of the path from which positions count.
    """

    log_evidence: float
    heading_rad: float
    log_scale: float
    placement_covariance: Array
    left_out_m: Array
    left_out_m2: Array
    information: Array
    pulled: Array
    about_rad: float
    prior: PlacementPrior
    squared: float
    origin_m: tuple[Array, Array]

    def predict(
        self, fixes_m: Array, path_m: Array, with_known_m2: Array, own_m2: Array, known_path_m: Array
    ) -> tuple[Array, Array]:
        """Predict further fixes, k in number.

        Parameters
        ----------
        fixes_m, path_m
            (k, 2) positions of the fixes in the map frame, and points of the path at their times in its own frame.
        with_known_m2
            (2 k, 2 n) covariance of their common errors with those of the known fixes, in the frame of the path.
        own_m2
            (k, 2, 2) covariance of their own common errors.
        known_path_m
            (n, 2) points of the path at the known fixes.

        Returns
        -------
        Array
            (k, 2) difference of each fix from its prediction, m, in the map frame.
        Array
            (k, 2, 2) covariance of that difference without the independent error of the fix, m².
        """
        of_fix, of_path = self.origin_m
        toward = rotation_matrix(self.prior.heading_rad - self.about_rad)
        weight = np.diag([self.prior.sigma_scale**2, self.prior.sigma_heading_rad**2])
        design, known = _design(path_m - of_path, toward), _design(known_path_m - of_path, toward)
        residual = rotate_vectors(fixes_m - of_fix, -self.about_rad) - design[:, 0].reshape(-1, 2)
        count, size = len(fixes_m), len(known_path_m)
        covariance = with_known_m2 + design @ weight @ known.T
        four = covariance.reshape(count, 2, size, 2)
        four[:, 0, :, 0] += UNKNOWN_POSITION_M**2
        four[:, 1, :, 1] += UNKNOWN_POSITION_M**2
        of_design = design.reshape(count, 2, 2)
        own = own_m2 + of_design @ weight @ of_design.transpose(0, 2, 1) + UNKNOWN_POSITION_M**2 * np.eye(2)
        gain = (covariance @ self.information).reshape(count, 2, 2 * size)
        left = own - gain @ covariance.reshape(count, 2, 2 * size).transpose(0, 2, 1)
        from_path = rotation_matrix(self.about_rad)
        difference = residual - (covariance @ self.pulled).reshape(count, 2)
        return rotate_vectors(difference, self.about_rad), from_path @ left @ from_path.T


@dataclass(frozen=True)
class _Joint:
    """Joint distribution of n fixes: residuals (2 n,), their covariance as a Cholesky factor, and what made them."""

    residual: Array
    lower: Array
    design: Array
    weight: Array
    toward: Array
    white_m2: Array

    @property
    def log_norm(self) -> float:
        """Logarithm of the normalisation of the density."""
        return float(np.log(np.diag(self.lower)).sum() + 0.5 * len(self.residual) * np.log(2.0 * np.pi))


def regress(
    fixes_m: Array, path_m: Array, common_m2: Array, white_m2: Array, prior: PlacementPrior, about_rad: float
) -> Regression:
    """Solve the model.

    Parameters
    ----------
    fixes_m
        (n, 2) positions of the fixes in the map frame.
    path_m
        (n, 2) points of the dead-reckoned path at their times, in its own frame.
    common_m2
        (2 n, 2 n) covariance of the errors of the path and of the wandering errors of the fixes, in that frame.
    white_m2
        (n, 2, 2) covariance of the independent errors of the fixes, in the map frame.
    prior
        Prior of heading and scale.
    about_rad
        Heading about which the model is linear.
    """
    from scipy.linalg.lapack import dpotri  # slow to load, and not needed for a walk without fixes

    joint = _joint(fixes_m, path_m, common_m2, white_m2, prior, about_rad)
    count, row = len(fixes_m), np.arange(len(fixes_m))
    half = dpotri(joint.lower, lower=1)[0]  # the lower half of the inverse; the other one is zero
    information = half + half.T
    information[np.diag_indices_from(information)] *= 0.5
    pulled = information @ joint.residual
    squared = float(joint.residual @ pulled)
    alone = np.linalg.inv(information.reshape(count, 2, count, 2)[row, :, row, :])
    left_out = np.einsum("iab,ib->ia", alone, pulled.reshape(count, 2))
    weight, toward, to_path = joint.weight, joint.toward, rotation_matrix(-about_rad)
    gain = weight @ joint.design.T
    vector = toward @ (np.array([1.0, 0.0]) + gain @ pulled)
    spread = toward @ (weight - gain @ information @ gain.T) @ toward.T
    to_polar = np.array([[-vector[1], vector[0]], [vector[0], vector[1]]]) / max(float(vector @ vector), 1e-6)
    return Regression(
        log_evidence=-0.5 * squared - joint.log_norm,
        heading_rad=float(about_rad + np.arctan2(vector[1], vector[0])),
        log_scale=float(np.log(max(np.hypot(*vector), 1e-3))),
        placement_covariance=to_polar @ spread @ to_polar.T,
        left_out_m=rotate_vectors(left_out, about_rad),
        left_out_m2=to_path.T @ (alone - joint.white_m2) @ to_path,
        information=information,
        pulled=pulled,
        about_rad=about_rad,
        prior=prior,
        squared=squared,
        origin_m=(fixes_m[0], path_m[0]),
    )


def log_evidence(
    fixes_m: Array, path_m: Array, common_m2: Array, white_m2: Array, prior: PlacementPrior, about_rad: float
) -> float:
    """Compute the evidence of `regress` alone, at a fraction of the cost; the parameters are the same."""
    from scipy.linalg.lapack import dtrtrs

    joint = _joint(fixes_m, path_m, common_m2, white_m2, prior, about_rad)
    whitened = dtrtrs(joint.lower, joint.residual, lower=1)[0]
    return -0.5 * float(whitened @ whitened) - joint.log_norm


def _joint(
    fixes_m: Array, path_m: Array, common_m2: Array, white_m2: Array, prior: PlacementPrior, about_rad: float
) -> _Joint:
    """Return the joint distribution of the fixes; the parameters are those of `regress`."""
    count = len(fixes_m)
    q, to_path = path_m - path_m[0], rotation_matrix(-about_rad)
    toward = rotation_matrix(prior.heading_rad - about_rad)
    design = _design(q, toward)
    weight = np.diag([prior.sigma_scale**2, prior.sigma_heading_rad**2])
    residual = rotate_vectors(fixes_m - fixes_m[0], -about_rad).ravel() - design[:, 0]
    white = to_path @ white_m2 @ to_path.T
    total = common_m2 + design @ weight @ design.T
    four = total.reshape(count, 2, count, 2)
    four[:, 0, :, 0] += UNKNOWN_POSITION_M**2
    four[:, 1, :, 1] += UNKNOWN_POSITION_M**2
    row = np.arange(count)
    four[row, :, row, :] += white
    lower = np.asarray(np.linalg.cholesky(total), dtype=np.float64)
    return _Joint(residual, lower, design, np.asarray(weight, dtype=np.float64), toward, white)


def _design(path_m: Array, toward: Array) -> Array:
    """Return the derivatives (2 n, 2) of points (n, 2) of a path by its scale and its heading."""
    return np.asarray(np.stack([path_m, path_m @ LEFT.T], axis=2).reshape(-1, 2) @ toward)
