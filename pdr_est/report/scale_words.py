"""What the estimated scale of the walker's steps means, in words."""

import math

from pdr_est.track import Track


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
