"""Sections of a walk, each with so few fixes that they can be compared with each other and with the steps at once."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.wandering_error import wander_chain
from pdr_est.estimators.fix_checks.dead_reckoned_path import DeadReckonedPath, ReckonedPoints
from pdr_est.frames import Array
from pdr_est.types.measurements import START_SOURCE, PositionFix, StartPose

MOST_FIXES = 48
"""Most fixes of a section: the work grows with their third power (our choice)."""

APART_S = 3.5
"""Fixes of a source within this time, s, are compared through one of them: what is nearer to each other tells hardly
anything new about steps and wandering errors (our choice)."""

_LEAST_SIGMA_M = 1e-3
_OUTLIER_PRIOR = (0.005, 0.05)  # of a fix that is not marked as robust, and of one that is; ours


@dataclass(frozen=True)
class FixTable:
    """Fixes of a walk as arrays, n in number, in order of time.

    Attributes
    ----------
    time_s, position_m
        (n,) s and (n, 2) m.
    white_m2
        (n, 2, 2) covariance of the independent error, m².
    sigma_wander_m, wander_time_s
        (n,) wandering error, m, and its correlation time, s.
    source
        (n,) numbers of the sources.
    names
        Names of the sources.
    known_clocks
        Numbers of the sources whose clocks are certainly right.
    outlier_prior
        (n,) probability that a fix is an outlier, before it is compared with anything.
    index
        (n,) place of each fix in the given list; -1 for the start.
    """

    time_s: Array
    position_m: Array
    white_m2: Array
    sigma_wander_m: Array
    wander_time_s: Array
    source: NDArray[np.int64]
    names: tuple[str, ...]
    known_clocks: frozenset[int]
    outlier_prior: Array
    index: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.time_s)

    def rows(self, chosen: NDArray[np.int64]) -> "FixTable":
        """Return some of the fixes."""
        return FixTable(
            time_s=self.time_s[chosen],
            position_m=self.position_m[chosen],
            white_m2=self.white_m2[chosen],
            sigma_wander_m=self.sigma_wander_m[chosen],
            wander_time_s=self.wander_time_s[chosen],
            source=self.source[chosen],
            names=self.names,
            known_clocks=self.known_clocks,
            outlier_prior=self.outlier_prior[chosen],
            index=self.index[chosen],
        )

    @property
    def sigma_m(self) -> Array:
        """Standard deviation (n,) of both parts of the error in a coordinate, m."""
        return np.asarray(np.sqrt(np.trace(self.white_m2, axis1=1, axis2=2) / 2.0 + self.sigma_wander_m**2))

    def wander_m2(self, other: "FixTable") -> Array:
        """Return the covariance (n, k) of the wandering errors of these fixes and others in each coordinate, m²."""
        apart_s = np.abs(self.time_s[:, None] - other.time_s)
        correlated_s = np.minimum(self.wander_time_s[:, None], other.wander_time_s)
        same = self.source[:, None] == other.source
        earlier = self.time_s[:, None] <= other.time_s
        variance = np.where(earlier, self.sigma_wander_m[:, None], other.sigma_wander_m) ** 2  # what both have had
        return np.asarray(same * variance * np.exp(-apart_s / correlated_s))


def table_of(fixes: Sequence[PositionFix], start: StartPose, begin_s: float) -> FixTable:
    """Make the table of all fixes, with a known start position as a fix at the beginning."""
    known = list(fixes)
    index = list(range(len(fixes)))
    if start.position_m is not None:
        sigma = max(start.sigma_position_m, _LEAST_SIGMA_M)
        known.insert(0, PositionFix(begin_s, np.array(start.position_m), sigma**2 * np.eye(2), START_SOURCE))
        index.insert(0, -1)
    names = tuple(dict.fromkeys(fix.source for fix in known))
    first = [next(fix for fix in known if fix.source == name) for name in names]
    sigma_wander_m = np.zeros(len(known))
    for name in names:
        own = sorted((i for i, fix in enumerate(known) if fix.source == name), key=lambda i: known[i].time_s)
        sigma_wander_m[own] = wander_chain([known[i] for i in own])[1]
    table = FixTable(
        time_s=np.array([fix.time_s for fix in known]),
        position_m=np.array([fix.position_m for fix in known], dtype=np.float64),
        white_m2=np.array([fix.covariance_m2 for fix in known], dtype=np.float64),
        sigma_wander_m=sigma_wander_m,
        wander_time_s=np.array([fix.wander_time_s for fix in known]),
        source=np.array([names.index(fix.source) for fix in known]),
        names=names,
        known_clocks=frozenset(i for i, fix in enumerate(first) if fix.clock_known),
        outlier_prior=np.array([_OUTLIER_PRIOR[fix.robust] for fix in known]),
        index=np.array(index),
    )
    return table.rows(np.lexsort((table.index, table.time_s)))


@dataclass(frozen=True)
class Section:
    """Section of a walk.

    Attributes
    ----------
    path
        Path of the steps of the whole walk.
    table
        All fixes of the section.
    chosen
        Numbers of the fixes in `table` that are compared with each other.
    heading
        Expected heading of the path and its standard deviation, rad; None where it is unknown.
    sigma_scale
        Standard deviation of the length scale.
    """

    path: DeadReckonedPath
    table: FixTable
    chosen: NDArray[np.int64]
    heading: tuple[float, float] | None
    sigma_scale: float

    @cached_property
    def compared(self) -> FixTable:
        """The fixes that are compared with each other."""
        return self.table.rows(self.chosen)

    def path_under(self, shifts_s: Array) -> tuple[ReckonedPoints, Array]:
        """Return the path at the n compared fixes if their clocks are corrected.

        Explanations differ little in this and much else, so that it is kept.

        Parameters
        ----------
        shifts_s
            Correction (n,) of the time of each fix, s.

        Returns
        -------
        ReckonedPoints
            Points of the path at their times.
        Array
            (2 n, 2 n) covariance of their errors, m².
        """
        key = shifts_s.tobytes()
        if key not in self._paths:
            points = self.path.at(self.compared.time_s + shifts_s)
            self._paths[key] = points, self.path.covariance(points, points, points.first_pose)
        return self._paths[key]

    @cached_property
    def _paths(self) -> dict[bytes, tuple[ReckonedPoints, Array]]:
        """Paths so far by the clock corrections."""
        return {}


def sections_of(
    path: DeadReckonedPath, table: FixTable, heading: tuple[float, float] | None, sigma_scale: float
) -> list[Section]:
    """Divide a walk into sections. heading: that of the start, and its standard deviation, rad; None if unknown."""
    chosen = _spread(table)
    begun_s = path.time_s[path.lost - 1]
    parts = [part for part in np.split(chosen, np.searchsorted(table.time_s[chosen], begun_s)) if len(part)]
    groups = [own for part in parts for own in np.array_split(part, -(-len(part) // MOST_FIXES))]
    borders = [0, *(own[0] for own in groups[1:]), len(table)]
    return [
        Section(path, table.rows(np.arange(begin, end)), own - begin, heading if begin == 0 else None, sigma_scale)
        for own, begin, end in zip(groups, borders[:-1], borders[1:], strict=True)
    ]


def _spread(table: FixTable) -> NDArray[np.int64]:
    """Choose fixes of each source that are apart from each other; a poor one may be left out between better ones."""
    chosen: list[int] = []
    last_s: dict[int, float] = {}
    for i, (time_s, source) in enumerate(zip(table.time_s, table.source, strict=True)):
        if time_s - last_s.get(int(source), -np.inf) >= APART_S or table.sigma_wander_m[i] == 0.0:
            chosen.append(i)
            last_s[int(source)] = float(time_s)
    return np.array(chosen)
