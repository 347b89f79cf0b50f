"""The plan of a floor: where one can walk, and which walls stand in between, in the map frame."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array, GeoOrigin

_MOST_CELLS = 4_000_000  # numbers in one temporary array, 32 MB


@dataclass(frozen=True)
class WalkableArea:
    """Connected piece of floor on which people walk.

    Attributes
    ----------
    outline_m
        (n, 2) corners of the outline, east and north, m; the last corner joins the first.
    holes_m
        Outlines of the pieces inside that are not walkable, such as columns and closed rooms, each (k, 2), m.
    """

    outline_m: Array
    holes_m: tuple[Array, ...] = ()


@dataclass(frozen=True)
class FloorPlan:
    """Walkable area and walls of one floor, as a measurement: steps stay on the area and do not cross walls.

    Attributes
    ----------
    name
        Name in messages and files, such as that of the plan's file.
    areas
        Pieces of walkable floor. Their outlines and holes are walls.
    walls_m
        (n, 2, 2) further walls inside the areas: begin and end of each, east and north, m.
    sigma_m
        Standard deviation of the drawing: how far a wall may stand from where it is drawn, m.
    floor
        Name of the floor, such as "F2"; empty if there is only one.
    origin
        Place of the map frame on the Earth; None for a plan in local metres.
    notes
        Remarks of the reader.
    """

    name: str
    areas: tuple[WalkableArea, ...]
    walls_m: Array
    sigma_m: float
    floor: str = ""
    origin: GeoOrigin | None = None
    notes: tuple[str, ...] = ()

    @cached_property
    def borders_m(self) -> Array:
        """All edges of outlines and holes: begin and end of each (n, 2, 2), east and north, m."""
        edges = [_edges(ring) for ring in self.rings_m()]
        return np.concatenate(edges) if edges else np.empty((0, 2, 2))

    @cached_property
    def barriers_m(self) -> Array:
        """Everything that no step crosses, borders and further walls: (n, 2, 2), east and north, m."""
        return np.concatenate([self.borders_m, np.reshape(self.walls_m, (-1, 2, 2))])

    @cached_property
    def bounds_m(self) -> tuple[float, float, float, float]:
        """West, south, east and north end of the walkable area, m."""
        low, high = self.borders_m.min(axis=(0, 1)), self.borders_m.max(axis=(0, 1))
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    @cached_property
    def area_m2(self) -> float:
        """Size of the walkable area, m²."""
        return sum(
            _ring_area_m2(area.outline_m) - sum(_ring_area_m2(hole) for hole in area.holes_m) for area in self.areas
        )

    def contains(self, position_m: Array) -> NDArray[np.bool_]:
        """Tell which positions lie on the walkable area.

        Parameters
        ----------
        position_m
            (n, 2) east and north, m.

        Returns
        -------
        Array
            (n,) True where a position is inside of an outline and in none of its holes.
        """
        # From inside, a ray to the east crosses the borders an odd number of times, as areas do not overlap.
        begin, end = self.borders_m[:, 0], self.borders_m[:, 1]
        rise_m = end[:, 1] - begin[:, 1]
        slope = (end[:, 0] - begin[:, 0]) / np.where(rise_m == 0.0, 1.0, rise_m)
        inside = np.zeros(len(position_m), dtype=bool)
        for part in _parts(len(position_m), len(begin)):
            x, y = position_m[part, :1], position_m[part, 1:]
            spans = (begin[:, 1] > y) != (end[:, 1] > y)
            crosses = spans & (x < begin[:, 0] + (y - begin[:, 1]) * slope)
            inside[part] = np.count_nonzero(crosses, axis=1) % 2 == 1
        return inside

    def distance_outside_m(self, position_m: Array) -> Array:
        """Compute how far positions (n, 2), m, are from the walkable area (n,), m; 0 on it."""
        outside = np.flatnonzero(~self.contains(position_m))
        distance_m = np.zeros(len(position_m))
        for part in _parts(len(outside), len(self.borders_m)):
            distance_m[outside[part]] = _nearest_edge_m(position_m[outside[part]], self.borders_m)
        return distance_m

    def rings_m(self) -> Iterator[Array]:
        """Yield the corners (n, 2), m, of every outline and hole."""
        for area in self.areas:
            yield area.outline_m
            yield from area.holes_m


@dataclass(frozen=True)
class PresentFloor:
    """The floor that the walker is on from a time until the next such measurement.

    Attributes
    ----------
    time_s
        Time from which on it counts, s; minus infinity for the start of the walk.
    plan
        Plan of the floor; None between two floors, and on a floor without a plan.
    probability
        Probability that the walker is on this floor; elsewhere the walls of the plan mean nothing.
    """

    time_s: float
    plan: FloorPlan | None
    probability: float = 1.0


@dataclass(frozen=True)
class BuildingPlan:
    """Plans of several floors of a building, all in one map frame.

    Attributes
    ----------
    name
        Name in messages and files.
    plans
        Plan of each floor, the lowest one first.
    numbers
        Number of each floor, rising; those of neighbouring storeys differ by one.
    start
        Number of the floor on which the walk begins; None where it is not known.
    notes
        Remarks of the reader.
    """

    name: str
    plans: tuple[FloorPlan, ...]
    numbers: tuple[int, ...]
    start: int | None = None
    notes: tuple[str, ...] = ()

    def plan_of(self, number: int) -> FloorPlan | None:
        """Return the plan of the floor with a number; None for a floor without a plan."""
        return dict(zip(self.numbers, self.plans, strict=True)).get(number)

    @property
    def start_plan(self) -> FloorPlan | None:
        """Plan of the floor on which the walk begins; None where it is not known."""
        return None if self.start is None else self.plan_of(self.start)

    @property
    def origin(self) -> GeoOrigin | None:
        """Place of the map frame on the Earth; None for plans in local metres."""
        return self.plans[0].origin

    @property
    def floor_names(self) -> str:
        """Names of the floors in words, the lowest one first."""
        return ", ".join(plan.floor for plan in self.plans)

    @cached_property
    def all_floors(self) -> FloorPlan:
        """Areas and walls of all floors as one plan, for what they have in common, such as their directions."""
        return FloorPlan(
            self.name,
            tuple(area for plan in self.plans for area in plan.areas),
            np.concatenate([np.reshape(plan.walls_m, (-1, 2, 2)) for plan in self.plans]),
            max(plan.sigma_m for plan in self.plans),
            origin=self.origin,
        )


def _edges(ring_m: Array) -> Array:
    return np.stack([ring_m, np.roll(ring_m, -1, axis=0)], axis=1)


def _ring_area_m2(ring_m: Array) -> float:
    x, y = (ring_m - ring_m[0]).T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2.0)


def _parts(rows: int, columns: int) -> Iterator[slice]:
    """Divide rows so that a temporary array with so many columns stays small."""
    step = max(_MOST_CELLS // max(columns, 1), 1)
    yield from (slice(begin, begin + step) for begin in range(0, rows, step))


def _nearest_edge_m(position_m: Array, edges_m: Array) -> Array:
    """Compute the distance (n,) of positions (n, 2) to the nearest of edges (k, 2, 2), m."""
    along = edges_m[:, 1] - edges_m[:, 0]
    squared_m2 = np.maximum((along**2).sum(axis=1), 1e-12)
    from_begin = position_m[:, None] - edges_m[None, :, 0]
    share = np.clip((from_begin * along).sum(axis=2) / squared_m2, 0.0, 1.0)
    offset = from_begin - share[..., None] * along
    nearest: Array = np.sqrt((offset**2).sum(axis=2).min(axis=1))
    return nearest
