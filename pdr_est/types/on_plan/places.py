"""Places on a floor plan where a walk may be that began anywhere, with their probabilities."""

from dataclasses import dataclass

UNIQUE_PROBABILITY = 0.95
"""Probability of a single place from which on the place of a walk counts as found (ours)."""

UNIQUE_SIGMA_M = 5.0
"""Largest standard deviation of a place that counts as found, m: about the width of a hall (ours)."""


@dataclass(frozen=True)
class PlaceMode:
    """Connected region of a plan in which the walker may be: a mode of the posterior.

    Attributes
    ----------
    probability
        Probability of being there, for a plan that is right. On the floors of ILC20, those below 95 % were too high.
    position_m
        Mean of the positions inside of the region, east and north, m.
    sigma_m
        Standard deviation of the positions inside of the region along its longest axis, m.
    """

    probability: float
    position_m: tuple[float, float]
    sigma_m: float

    @property
    def words(self) -> str:
        """The place in a few words."""
        place = f"({self.position_m[0]:.1f}, {self.position_m[1]:.1f}) ± {self.sigma_m:.1f} m"
        return f"{place} with a probability of {in_percent(self.probability)}"


@dataclass(frozen=True)
class PlacesAt:
    """Modes of the posterior of a position at one time.

    Attributes
    ----------
    time_s
        Time on the clock of the recording, s.
    walked_m
        Distance walked until then, m.
    modes
        Modes, the most probable one first. Those below 1 % are left out.
    """

    time_s: float
    walked_m: float
    modes: tuple[PlaceMode, ...]

    @property
    def unique(self) -> bool:
        """Tell whether one place has at least `UNIQUE_PROBABILITY` and at most `UNIQUE_SIGMA_M`."""
        best = self.modes[0]
        return best.probability >= UNIQUE_PROBABILITY and best.sigma_m <= UNIQUE_SIGMA_M


@dataclass(frozen=True)
class PlaceSearch:
    """Search for the place of a walk whose start is not known, by its floor plan.

    Attributes
    ----------
    filtered
        Places by the measurements until each of several times, in order of time: the first one at the start, the last
        one at the end of the walk.
    start
        Places where the walk began, by all measurements.
    end
        Places where the walk ended, by all measurements, found once more with the particles where it can have begun.
    """

    filtered: tuple[PlacesAt, ...]
    start: PlacesAt
    end: PlacesAt

    @property
    def unique_since(self) -> PlacesAt | None:
        """First time from which on the place was unique until the end of the walk; None if it is not at the end."""
        if not self.end.unique:
            return None
        found = None
        for places in reversed(self.filtered):
            if not places.unique:
                break
            found = places
        return found

    @property
    def words(self) -> str:
        """Result of the search in one sentence."""
        since, best = self.unique_since, self.end.modes[0]
        if since is not None:
            return (
                f"the place on the plan was found after {since.walked_m:.0f} m (at {since.time_s:.1f} s): the walk "
                f"ended at {best.words}"
            )
        others = len(self.end.modes) - 1
        more = ("", ", or at another place")[others] if others < 2 else f", or at one of {others} other places"
        return f"the place on the plan is not decided: the walk ended at {best.words}{more}"


def in_percent(probability: float) -> str:
    """Write a probability, which is never certain, in percent."""
    return "more than 99 %" if probability > 0.99 else f"{probability:.0%}".replace("%", " %")
