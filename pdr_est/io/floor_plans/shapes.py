"""Shapes that a plan draws, in its own units, before it is known where people can walk."""

from dataclasses import dataclass, field

from pdr_est.frames import Array


@dataclass(frozen=True)
class DrawnPolygon:
    """Polygon of a plan.

    Attributes
    ----------
    name
        What to call it in messages.
    rings
        Outline and then holes, each (n, 2) with n >= 3 corners; the last corner joins the first.
    """

    name: str
    rings: tuple[Array, ...]


@dataclass
class DrawnFloor:
    """Drawing of one floor, in degrees or metres.

    Attributes
    ----------
    floor
        Walkable pieces.
    closed
        Pieces that nobody walks on, such as shops, shafts and columns.
    undecided
        Pieces that the file says nothing about: the outermost are walkable, those inside of another are closed.
    walls
        Lines, each (n, 2) with n >= 2 points.
    """

    floor: list[DrawnPolygon] = field(default_factory=list)
    closed: list[DrawnPolygon] = field(default_factory=list)
    undecided: list[DrawnPolygon] = field(default_factory=list)
    walls: list[Array] = field(default_factory=list)

    def arrays(self) -> list[Array]:
        """List all coordinates: rings and lines, each (n, 2)."""
        polygons = (*self.floor, *self.closed, *self.undecided)
        return [*(ring for polygon in polygons for ring in polygon.rings), *self.walls]
