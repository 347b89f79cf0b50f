"""Findings about the consistency of a walk's measurements: what does not fit, and what an estimator did about it."""

from dataclasses import dataclass
from enum import StrEnum


class FindingKind(StrEnum):
    """Kind of a finding: what it is about."""

    FIXES = "fixes"
    """Fixes that disagree with the steps or with each other and count less."""

    FIX_ACCURACY = "fix-accuracy"
    """A source of fixes whose stated accuracy does not fit its errors."""

    STEPS = "steps"
    """Steps that disagree with the fixes more than usual and count less."""

    FIX_CLOCK = "fix-clock"
    """A source of fixes whose clock is shifted against the recording."""

    START_HEADING = "start-heading"
    """A given start heading that contradicts the fixes, or one that the measurements cannot decide."""

    LENGTH_SCALE = "length-scale"
    """A length scale that is far from what is usual."""

    CLOSURE = "closure"
    """A walk that is said to end where it began, though its steps lead elsewhere."""

    TETHER = "tether"
    """Devices that are farther apart than their tether allows."""

    PLACEMENT = "placement"
    """A change of the place of a phone after which the heading offset is not decided."""

    NORTH = "north"
    """The device's knowledge of north: disturbed, or in contradiction to the rest."""

    PLAN = "plan"
    """A floor plan that does not fit the walk, or a place on it that is not decided."""


@dataclass(frozen=True)
class Finding:
    """Something about a walk that does not fit, or that an estimator had to choose.

    Attributes
    ----------
    kind
        What it is about.
    message
        The finding in words, with its numbers.
    device
        Name of the device that it concerns; empty for the whole walk.
    begin_s, end_s
        Time span that it concerns, s; None for the whole walk.
    value, sigma
        The number that does not fit and its standard deviation, in the unit that the message names; None without one.
    doubtful
        True where the user should look: the command line prints it as a warning. False for a choice that is certain.
    """

    kind: FindingKind
    message: str
    device: str = ""
    begin_s: float | None = None
    end_s: float | None = None
    value: float | None = None
    sigma: float | None = None
    doubtful: bool = True

    @property
    def words(self) -> str:
        """The finding in one line, with the name of its device."""
        named = not self.device or self.message.startswith(f"{self.device}: ")
        return self.message if named else f"{self.device}: {self.message}"
