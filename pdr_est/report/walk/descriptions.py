"""Short descriptions, in words, of dominant directions, of the walker's length scale and of the frame of a track."""

import math

from pdr_est.estimators import AUTO, automatic_name
from pdr_est.types.analysis import DominantDirections
from pdr_est.types.track import Track

_MOST_ODDS = 1e6  # larger odds carry no more information


def describe_directions(found: DominantDirections | None) -> str:
    """Describe the dominant directions of the building in one line.

    Parameters
    ----------
    found : DominantDirections or None
        None if they were not searched or the walk had no straight part.
    """
    if found is None:
        return "no dominant directions: not searched, or no straight part"
    if not found.used:
        return f"no dominant directions: odds {_odds(found.log_odds)} for {_number(found.number)}"
    return f"building with {_number(found.number)}, odds {_odds(found.log_odds)}"


def _number(number: int) -> str:
    return "1 direction" if number == 1 else f"{number} directions"


def _odds(log_odds: float) -> str:
    """Write the odds of directions against all else: 150:1 for, 1:20 against."""
    odds = math.exp(min(abs(log_odds), math.log(_MOST_ODDS)))
    more = "more than " if abs(log_odds) > math.log(_MOST_ODDS) else ""
    text = f"{odds:,.0f}".replace(",", "\u202f") if odds >= 10.0 else f"{odds:.1f}"
    if log_odds < 0.0:
        return f"{'less than ' if more else ''}1:{text}"
    return f"{more}{text}:1"


def describe_choice(name: str, used: str) -> str:
    """Describe why an estimator was used.

    Parameters
    ----------
    name : str
        Name in the configuration.
    used : str
        Name of the estimator that was used.
    """
    if name != AUTO:
        return "chosen"
    on_plan = used == automatic_name(on_plan=True)
    return "the default with a floor plan, because it keeps the track on it" if on_plan else "the default"


def describe_length_scale(track: Track, with_fixes: bool, with_profile: bool) -> str:
    """Describe how the length scale of a track is known; without fixes and floor plan it stays at its prior.

    Parameters
    ----------
    track : Track
        Track with its length scale.
    with_fixes : bool
        True if the track was made with position fixes.
    with_profile : bool
        True if the track was made with a walker's profile.
    """
    reference = "the profile" if with_profile else "the length model"
    sigma = f"± {100.0 * track.sigma_length_scale:.1f} %" if math.isfinite(track.sigma_length_scale) else "± unknown"
    if not with_fixes and not track.on_plan:
        return f"not estimated without fixes: steps of {reference}, {sigma}"
    percent = 100.0 * (track.length_scale - 1.0)
    longer = "longer" if percent >= 0.0 else "shorter"
    source = " and ".join(["the fixes"] * with_fixes + ["the floor plan"] * track.on_plan)
    return f"estimated from {source}: steps {abs(percent):.1f} % {longer} than those of {reference}, {sigma}"


def describe_frame(frame: str, with_place: bool) -> str:
    """Describe where a track lies and which way is up.

    Parameters
    ----------
    frame : str
        "map", "north-up" or "own", as the summary has it.
    with_place : bool
        True if a position on the map was given.
    """
    if frame == "map":
        return "map: x east, y north"
    if frame == "north-up":
        return "local position, north-up: x east, y north, origin at the start of the walk"
    if with_place:
        return "own: through the given position on the map, but turned arbitrarily about it"
    return "own: origin at the start of the walk"
