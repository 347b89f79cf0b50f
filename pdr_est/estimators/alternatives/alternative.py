"""One possible course of a walk."""

from dataclasses import dataclass

from pdr_est.estimators.common.timeline import Timeline

DECIDED = 0.95
"""Probability of an alternative or a turn from which on nothing is reported; ours."""


@dataclass(frozen=True)
class Alternative:
    """One possible course of a walk.

    Attributes
    ----------
    probability
        Its probability among the alternatives.
    timelines
        Measurements of each device, with the turns that this alternative chose.
    start_headings_rad
        Heading of each device at the start of the walk to linearise at; None where it is known or unambiguous.
    open_turns
        Number of the node, and probability of the chosen turn, of each turn of each device that is not decided within
        this alternative. Its variance is then that of all its hypotheses about the chosen one.
    """

    probability: float
    timelines: tuple[Timeline, ...]
    start_headings_rad: tuple[float | None, ...]
    open_turns: tuple[tuple[tuple[int, float], ...], ...]
