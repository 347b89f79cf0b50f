"""Factors of a fixed-lag window, added one after the other to its least squares in square-root form.

The window is linearised in changes of east, north and heading. A change of all positions by the same amount then
leaves every row of steps and tethers as it is, whatever they were linearised at. In the frames of the poses it would
not, and the stiff rows of tethers would tell something of the position of the walk, which nothing measured.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.common.motion_model import MIN_SIGMA
from pdr_est.estimators.common.wandering_error import wander_to
from pdr_est.estimators.fixed_lag.square_root import PresentRows, SquareRootWindow, present_rows
from pdr_est.estimators.fixed_lag.window_entries import FilteredNode
from pdr_est.estimators.fixed_lag.window_prior import (
    PARTS,
    ConditionalPrior,
    device_state,
    of_entering,
    whitening_of,
)
from pdr_est.estimators.fixed_lag.window_rows import (
    WindowPlaces,
    WindowTether,
    motion_rows,
    reached_pose,
    window_fix_rows,
    window_heading_rows,
)
from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix

_TETHER_ITERATIONS, _SMALL = 5, 1e-3  # the latter in m and rad
_ANY_HEADING_RAD = 1e3  # standard deviation of the reference direction of a device that is not there yet


@dataclass
class PoseVariable:
    """Pose that is estimated: its device, and its first row once it has been followed by another pose of it."""

    device: int
    row: int | None = None


@dataclass(frozen=True)
class WindowCheckpoint:
    """Rows of the present variables after a node, and what they refer to.

    Attributes
    ----------
    rows
        Rows of the present variables.
    at
        Values (s,) of the present variables at which they are linearised.
    last
        Last pose of each device.
    errors
        Time and standard deviation, m, of the last wandering error of each source.
    """

    rows: PresentRows
    at: Array
    last: tuple[PoseVariable, ...]
    errors: dict[str, tuple[float, float]]


@dataclass(frozen=True)
class EnteringPrior:
    """Prior of a device that enters: columns (k,) of its variables, their means (k,), and their whitening (k, k)."""

    columns: list[int]
    mean: Array
    whitening: Array


class WindowFactors:
    """Linearised factors of a window, which begins with a prior from the EKF.

    Parameters
    ----------
    first
        Result of the EKF at the begin of the window.
    scale
        Length scale of each device.
    places
        Columns of the present variables.

    Attributes
    ----------
    at : (s,) array
        Values of the present variables at which they are linearised.
    last : list of PoseVariable
        Last pose of each device.
    linear : SquareRootWindow
        Their least squares.
    """

    def __init__(self, first: FilteredNode, scale: Sequence[float], places: WindowPlaces) -> None:
        self._scale, self._places = scale, places
        self._present = set(first.present)
        self._referred: set[int] = set()  # devices whose reference is there
        self._errors = {one.name: (one.time_s, one.sigma_m) for one in first.sources}
        self.at = np.zeros(places.size)
        self.last = [PoseVariable(device) for device in range(places.devices)]
        self.linear = SquareRootWindow(self._prior(first))

    def checkpoint(self) -> WindowCheckpoint:
        """Return what is known now."""
        return WindowCheckpoint(self.linear.present, self.at.copy(), tuple(self.last), dict(self._errors))

    def return_to(self, known: WindowCheckpoint, poses: Array) -> None:
        """Forget everything since a checkpoint, and linearise it at other poses (d, 3) and the present references."""
        columns = list(self._places.references.values())
        at, count = known.at.copy(), poses.size
        at[columns] = self.at[columns] + self.linear.present_changes()[columns]
        at[:count] = poses.ravel()
        right = known.rows.right - known.rows.root @ (at - known.at)
        self.linear = SquareRootWindow(PresentRows(known.rows.root, right, 0, (0,) * len(right)))
        self.at, self.last, self._errors = at, list(known.last), dict(known.errors)
        for variable in self.last:
            variable.row = None

    def tethers_of(self, item: FilteredNode) -> list[WindowTether]:
        """Return the tethers of a node between devices that are there."""
        return [WindowTether(one) for one in item.tethers if {one.device_a, one.device_b} <= self._present]

    def follows(self, item: FilteredNode) -> bool:
        """Tell whether the pose of a node follows from the one before it of its device."""
        return item.entered is None and item.device in self._present

    def entering_prior(self, item: FilteredNode) -> EnteringPrior:
        """Return the prior of a pose that does not follow from the one before it: the state of its device."""
        state = item.entered or device_state(item.mean, item.covariance, item.device)
        known = of_entering(state, self._scale[item.device])
        self._present.add(item.device)
        columns, kept = self._of_devices([item.device])
        return EnteringPrior(columns, known.mean[kept], whitening_of(known, kept))

    def enter(self, variable: PoseVariable, prior: EnteringPrior, pose: Array) -> None:
        """Add a pose with its prior, linearised at a pose (3,)."""
        rows = np.zeros((len(prior.mean), self._places.size))
        rows[:, prior.columns] = prior.whitening
        moved = np.concatenate([pose, self.at[prior.columns[3:]]]) - prior.mean
        self._replace(variable, pose, np.zeros((len(rows), 3)), rows, -prior.whitening @ moved)

    def move(self, item: FilteredNode, variable: PoseVariable, whitening: Array) -> Array:
        """Add the pose that a motion leads to at present estimates; return it, (3,)."""
        place, scale = self._places.pose(item.device), self._scale[item.device]
        change = self.linear.present_changes()[place]
        pose = reached_pose(self.at[place] + change, item.node, scale)
        before, own = motion_rows(item.node, scale, whitening, pose[2])
        self.follow(item, variable, pose, (before, own, before @ change), settled=False)
        return pose

    def follow(
        self,
        item: FilteredNode,
        variable: PoseVariable,
        pose: Array,
        motion: tuple[Array, Array, Array],
        settled: bool,
    ) -> None:
        """Add a pose that follows from the one before it, with its measurements.

        Parameters
        ----------
        item
            The node.
        variable
            Variable of its pose.
        pose
            Pose (3,) at which it is linearised.
        motion
            Coefficients (3, 3) of the pose before it and of its own in the rows of the motion, and right sides (3,).
        settled
            Whether poses are linearised at their estimates, so that their changes so far do not count.
        """
        place, (before, own, right) = self._places.pose(item.device), motion
        rows = np.zeros((3, self._places.size))
        rows[:, place] = own
        if item.node.fixes or item.node.priors:
            sigmas_m = [self._error_at(fix) for fix in item.node.fixes]
            change = self._present_changes(settled)
            change[place] = 0.0
            estimate = self.at + change
            estimate[place] = pose
            referred = item.device in self._referred
            found = [
                window_heading_rows(prior, item.device, self._places, estimate, referred)
                for prior in item.node.priors
            ]
            pairs = zip(item.node.fixes, sigmas_m, strict=True)
            found += [window_fix_rows(fix, sigma_m, item.device, self._places, estimate) for fix, sigma_m in pairs]
            rows = np.concatenate([rows, *(one.rows for one in found)])
            right = np.concatenate([right, *(one.rows @ change - one.left for one in found)])
            before = np.concatenate([before, np.zeros((len(right) - 3, 3))])
        self._replace(variable, pose, before, rows, right)

    def tether(self, tethers: Sequence[WindowTether], settled: bool) -> None:
        """Add those tethers that are violated; without `settled`, each about the estimate that it leads to."""
        for one in tethers:
            known, change = self.linear.present, self._present_changes(settled)
            for _ in range(1 if settled else _TETHER_ITERATIONS):
                across = one.linearise(self.at + change)
                self.linear.present = known
                if one.violation_m <= 0.0 and one.expected_m <= 0.0:
                    break
                found = one.rows(across, self._places)
                self.linear.merge(found.rows, found.rows @ change - found.left)
                if settled:
                    break
                there = self.linear.present_changes()
                one.expect((self.at + there)[one.columns])
                if np.abs(there - change).max() < _SMALL:
                    break
                change = there

    def _prior(self, item: FilteredNode) -> PresentRows:
        """Set the first values, and return the rows of the EKF's state there."""
        devices = sorted(item.present)
        known = ConditionalPrior.of_filter(item.mean, item.covariance, np.array(self._scale), devices)
        columns, kept = self._of_devices(devices)
        for source, rows in zip(item.sources, known.of_sources, strict=True):
            place = self._places.sources[source.name]
            columns += range(place.start, place.stop)
            kept += rows.tolist()
        self.at[columns] = known.mean[kept]
        root = np.eye(self._places.size)  # a source without fixes so far has the variance 1
        for column in self._places.references.values():
            root[column, column] = 1.0 / _ANY_HEADING_RAD
        root[np.ix_(columns, columns)] = whitening_of(known, kept)
        return present_rows(root, np.zeros(len(root)))

    def _of_devices(self, devices: Sequence[int]) -> tuple[list[int], list[int]]:
        """Return the columns of poses and new references of devices, and their numbers in a `ConditionalPrior`."""
        columns: list[int] = []
        kept: list[int] = []
        for number, device in enumerate(devices):
            columns += range(3 * device, 3 * device + 3)
            kept += range(PARTS * number, PARTS * number + 3)
            if device in self._places.references and device not in self._referred:
                self._referred.add(device)
                columns.append(self._places.references[device])
                kept.append(PARTS * number + 3)
        return columns, kept

    def _replace(self, variable: PoseVariable, pose: Array, before: Array, rows: Array, right: Array) -> None:
        """Put a pose in the place of the last one of its device."""
        place = self._places.pose(variable.device)
        self.last[variable.device].row = self.linear.follow(place, before, rows, right)
        self.last[variable.device] = variable
        self.at[place] = pose

    def _error_at(self, fix: PositionFix) -> float:
        """Let the wandering error of a fix's source be that at the fix; return its standard deviation, m."""
        if fix.sigma_wander_m <= 0.0:
            return 0.0
        before = self._errors.get(fix.source)
        if before is not None and before[0] == fix.time_s:
            return before[1]
        sigma_m = fix.sigma_wander_m
        if before is not None:
            # A device that lags behind may give an older fix.
            correlation, sigma_m = wander_to(fix, before[1], abs(fix.time_s - before[0]))
            place, unit = self._places.sources[fix.source], np.eye(2)
            left = max((1.0 - correlation**2) ** 0.5, MIN_SIGMA)
            rows = np.zeros((2, self._places.size))
            rows[:, place] = unit / left
            self.linear.follow(place, -correlation / left * unit, rows, np.zeros(2))
            self.at[place] *= correlation
        self._errors[fix.source] = (fix.time_s, sigma_m)
        return sigma_m

    def _present_changes(self, settled: bool) -> Array:
        """Return the changes (s,) of the present variables; of wandering errors only, if the others are settled."""
        change = self.linear.present_changes()
        if settled:
            change[: 3 * self._places.devices + len(self._places.references)] = 0.0
        return change
