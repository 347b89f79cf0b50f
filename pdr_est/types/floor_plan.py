"""The plan of a floor: where one can walk, and which walls stand in between, in the map frame."""

from dataclasses import dataclass

from pdr_est.frames import Array


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
    """

    name: str
    areas: tuple[WalkableArea, ...]
    walls_m: Array
    sigma_m: float
    floor: str = ""
