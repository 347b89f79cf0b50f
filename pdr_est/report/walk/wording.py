"""What the walk tells of the building's dominant directions, in words."""

import math

from pdr_est.types.analysis import DominantDirections
from pdr_est.types.track import Track

_MOST_ODDS = 1e6  # beyond it a number says no more


def directions_in_words(found: DominantDirections | None) -> str:
    """One line for the report. found: None if nobody looked for them or the walk had no straight stretch."""
    if found is None:
        return "no dominant directions: none looked for, or no straight stretch"
    if not found.used:
        return f"no dominant directions: odds {_odds(found.log_odds)} for {_number(found.number)}"
    return f"building with {_number(found.number)}, odds {_odds(found.log_odds)}"


def _number(number: int) -> str:
    return "1 direction" if number == 1 else f"{number} directions"


def _odds(log_odds: float) -> str:
    """Of directions against none: 150:1 for, 1:20 against."""
    odds = math.exp(min(abs(log_odds), math.log(_MOST_ODDS)))
    more = "more than " if abs(log_odds) > math.log(_MOST_ODDS) else ""
    text = f"{odds:,.0f}".replace(",", "\u202f") if odds >= 10.0 else f"{odds:.1f}"
    if log_odds < 0.0:
        return f"{'less than ' if more else ''}1:{text}"
    return f"{more}{text}:1"


def scale_in_words(track: Track, with_fixes: bool, with_profile: bool) -> str:
    """Of a track that was made with position fixes or without, and with a walker's profile or without.

    Without fixes nothing tells the scale: it stays what was expected.
    """
    of_whom = "the profile's" if with_profile else "the length model's"
    sigma = f"± {100.0 * track.sigma_length_scale:.1f} %" if math.isfinite(track.sigma_length_scale) else "± unknown"
    if not with_fixes:
        return f"not estimated, there being no fixes: {of_whom} steps, {sigma}"
    percent = 100.0 * (track.length_scale - 1.0)
    longer = "longer" if percent >= 0.0 else "shorter"
    return f"estimated from the fixes: steps {abs(percent):.1f} % {longer} than {of_whom}, {sigma}"
