"""Parts of the map of a report that follow neither from the walk nor from its recording."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from pdr_est.types.track import Track


@dataclass(frozen=True)
class MapExtras:
    """Variants of the track, and a background below it.

    Attributes
    ----------
    variants
        Other tracks of the walk, in the same frame, by their names.
    background
        Description of what lies below the track, by `Background.placed`; None without any.
    floors
        Floors of a walk over several: of each its name, its plan like `background`, and when the walker was there.
    image_hosts
        Origins of the background's pictures, if it is loaded from a server.
    """

    variants: Mapping[str, Track] = field(default_factory=dict)
    background: dict[str, Any] | None = None
    floors: tuple[dict[str, Any], ...] = ()
    image_hosts: tuple[str, ...] = ()


NO_EXTRAS = MapExtras()
