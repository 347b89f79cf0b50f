"""Rows of the motion and of the measurements of a node in the present variables of a fixed-lag window."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import cos, hypot, sin, sqrt

import numpy as np

from pdr_est.estimators.common.huber import CAUCHY, HUBER
from pdr_est.estimators.common.motion_model import MIN_SIGMA
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.common.tethers import NodeTether, PairTether
from pdr_est.frames import Array, wrap_angle
from pdr_est.types.measurements import HeadingPrior, PositionFix

_MIN_DISTANCE_M = 1e-9


@dataclass(frozen=True)
class WindowPlaces:
    """Columns of the present variables of a window.

    Attributes
    ----------
    devices
        Number of devices; the pose of device d has the columns 3 d, 3 d + 1, 3 d + 2.
    references
        Column of the reference direction of those devices that have relative headings.
    sources
        Columns of the wandering error of each source of fixes.
    size
        Number of columns.
    """

    devices: int
    references: dict[int, int]
    sources: dict[str, slice]
    size: int

    @classmethod
    def of(cls, devices: int, relative: Sequence[int], sources: Sequence[str]) -> "WindowPlaces":
        """Assign columns to poses, to the references of some devices, and to sources."""
        references = {device: 3 * devices + i for i, device in enumerate(relative)}
        first = 3 * devices + len(references)
        errors = {name: slice(first + 2 * i, first + 2 * i + 2) for i, name in enumerate(sources)}
        return cls(devices, references, errors, first + 2 * len(errors))

    def pose(self, device: int) -> slice:
        """Return the columns of the pose of a device."""
        return slice(3 * device, 3 * device + 3)


def motion_whitening(node: Node) -> Array:
    """Return the matrix (3, 3) that turns errors of the motion to a node into standard deviations."""
    variance, axes = np.linalg.eigh(node.covariance)
    return np.asarray((axes / np.sqrt(np.maximum(variance, MIN_SIGMA**2))).T)


def motion_rows(node: Node, length_scale: float, whitening: Array, heading_rad: float) -> tuple[Array, Array]:
    """Return the coefficients (3, 3) of the pose before a node and of the node's, where the motion to it fits.

    `heading_rad` is the heading at the node.
    """
    c, s = cos(heading_rad), sin(heading_rad)
    own = whitening @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    before = -own
    before[:, 2] -= length_scale * node.length_m * whitening[:, 1]
    return before, own


def reached_pose(before: Array, node: Node, length_scale: float) -> Array:
    """Return the pose (3,) that the motion to a node leads to."""
    heading_rad, length_m = before[2] + node.heading_change_rad, length_scale * node.length_m
    return np.array([before[0] + length_m * cos(heading_rad), before[1] + length_m * sin(heading_rad), heading_rad])


@dataclass(frozen=True)
class MeasuredRows:
    """Rows of measurements.

    Attributes
    ----------
    rows : (m, s) array
        Coefficients of the present variables, in standard deviations.
    left : (m,) array
        What the estimate has too much, in standard deviations.
    """

    rows: Array
    left: Array


def window_heading_rows(
    prior: HeadingPrior, device: int, places: WindowPlaces, estimate: Array, reference_known: bool
) -> MeasuredRows:
    """Linearise a heading prior at estimates (s,) of the present variables, with the weight of its kernel."""
    sigma_rad, rows = max(prior.sigma_rad, MIN_SIGMA), np.zeros((1, places.size))
    column = 3 * device + 2
    off_rad = estimate[column] - prior.heading_rad
    rows[0, column] = 1.0 / sigma_rad
    if prior.relative and reference_known:
        reference = places.references[device]
        rows[0, reference], off_rad = -1.0 / sigma_rad, off_rad - estimate[reference]
    left = float(wrap_angle(off_rad)) / sigma_rad
    weight = 1.0 / sqrt(1.0 + (left / CAUCHY) ** 2) if prior.robust else 1.0
    return MeasuredRows(weight * rows, np.array([weight * left]))


def window_fix_rows(
    fix: PositionFix, sigma_m: float, device: int, places: WindowPlaces, estimate: Array
) -> MeasuredRows:
    """Linearise a position fix whose wandering error has a standard deviation, likewise; 0 for a fix without one."""
    whitening = np.linalg.inv(np.linalg.cholesky(np.asarray(fix.covariance_m2, dtype=np.float64)))
    east, rows = 3 * device, np.zeros((2, places.size))
    rows[:, east : east + 2] = whitening
    off_m = estimate[east : east + 2] - fix.position_m
    if sigma_m > 0.0:
        error = places.sources[fix.source]
        rows[:, error], off_m = sigma_m * whitening, off_m + sigma_m * estimate[error]
    left = whitening @ off_m
    distance = hypot(*left)
    weight = sqrt(HUBER / distance) if fix.robust and distance > HUBER else 1.0
    return MeasuredRows(weight * rows, weight * left)


@dataclass
class WindowTether:
    """Tether of a node of the window.

    Attributes
    ----------
    tether
        The tether.
    along : (6,) array
        Lengthening of the tether by changes of the poses of its two devices, one after the other.
    violation_m
        Distance minus length of the tether where it is linearised, m; negative for one that holds.
    expected_m
        Violation at the optimum of the window so far, m, which gives its tension.
    """

    tether: NodeTether | PairTether
    violation_m: float = 0.0
    expected_m: float = 0.0
    along: Array = field(default_factory=lambda: np.zeros(6))
    _about: Array = field(default_factory=lambda: np.zeros(6))

    @property
    def columns(self) -> list[int]:
        """Columns of the poses of the two devices."""
        return [3 * device + i for device in (self.tether.device_a, self.tether.device_b) for i in range(3)]

    def linearise(self, estimate: Array) -> Array:
        """Linearise at an estimate (s,); return the displacement across the tether by changes of the two poses (6,).

        As for the batch graph (`tether_constraints`), only displacements relative to the headings count.
        """
        east_m, north_m = (estimate[self.columns[0:2]] - estimate[self.columns[3:5]]).tolist()
        distance_m = max(hypot(east_m, north_m), _MIN_DISTANCE_M)
        x, y = east_m / distance_m, north_m / distance_m
        self.along = np.array([x, y, 0.0, -x, -y, 0.0])
        self.violation_m, self._about = distance_m - self.tether.max_distance_m, estimate[self.columns]
        return np.array([-y, x, -0.5 * distance_m, y, -x, -0.5 * distance_m])

    def expect(self, estimate: Array) -> None:
        """Expect the violation that a change of the two poses to an estimate (6,) leads to."""
        self.expected_m = self.violation_m + float(self.along @ (estimate - self._about))

    def rows(self, across: Array, places: WindowPlaces) -> MeasuredRows:
        """Return the rows of the tether as a measured distance, and of its stiffness across its direction."""
        sigma_m, stiff = max(self.tether.sigma_m, MIN_SIGMA), self.expected_m > 0.0
        rows = np.zeros((1 + stiff, places.size))
        rows[0, self.columns] = self.along / sigma_m
        if stiff:
            distance_m = self.violation_m + self.tether.max_distance_m
            rows[1, self.columns] = sqrt(self.expected_m / distance_m) / sigma_m * across
        left = np.zeros(1 + stiff)
        left[0] = self.violation_m / sigma_m
        return MeasuredRows(rows, left)
