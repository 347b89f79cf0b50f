"""Describe what can be computed from the sensors of a device, and where a missing one may be."""

from collections.abc import Mapping, Sequence

from pdr_est.preprocessing.quality.sampling_rate import sampling_rate_warnings, slow_gyroscope_warnings
from pdr_est.types.recording import Signal

_UNUSED = "not used: "  # how readers name columns that they made nothing of, among their decisions
_MOST_NAMED = 200  # characters


def describe_capabilities(signals: Mapping[str, Signal], together: bool) -> tuple[str, ...]:
    """Describe what the sensors allow to compute, and what a missing or slow one prevents.

    Parameters
    ----------
    signals
        Signals with samples, by the name of their channel.
    together
        True when accelerometer and gyroscope ever run at the same time.
    """
    force, attitude = "specific_force" in signals, "attitude" in signals
    acceleration = signals.get("specific_force") or signals.get("linear_acceleration")
    slow = () if acceleration is None else sampling_rate_warnings(acceleration)
    if slow:
        return slow
    rate = "rotation_rate" in signals and bool(signals["rotation_rate"].values.any())
    if force and rate and not together:
        return ("accelerometer and gyroscope never run at the same time: a track is not possible",)
    if force and rate:
        turns = slow_gyroscope_warnings(signals["rotation_rate"])
        return ("steps and distance", *turns) if turns else ("steps, headings and a track",)
    if force:
        return ("no gyroscope: steps and distance are possible, headings and a track are not",)
    if acceleration is not None:
        return ("acceleration without gravity: steps can be counted, headings and a track are not possible",)
    if rate or attitude:
        return ("no accelerometer: rotations of the device are possible, steps and a track are not",)
    return ("no accelerometer and no gyroscope: nothing can be estimated",)


def suggest_unused_columns(decisions: Sequence[str]) -> str:
    """Name the columns that a reader made nothing of: a missing sensor with another title may be among them.

    Parameters
    ----------
    decisions
        Decisions of the reader.

    Returns
    -------
    str
        Words that continue "record it too"; "" when every column was used.
    """
    told = [decision.partition(_UNUSED)[2] for decision in decisions if _UNUSED in decision]
    if not told:
        return ""
    named = ", ".join(told)
    named = named if len(named) <= _MOST_NAMED else f"{named[:_MOST_NAMED]} …"
    return f", or, if it is among what was not used ({named}), name it with --map"
