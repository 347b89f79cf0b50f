"""Describe what can be computed from the sensors of a device."""

from collections.abc import Mapping

from pdr_est.preprocessing.quality.sampling_rate import sampling_rate_warnings, slow_gyroscope_warnings
from pdr_est.types.recording import Signal


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
