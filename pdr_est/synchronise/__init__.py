"""Clocks of the devices of one walk: found from their recordings or messages, and brought onto one of them."""

from pdr_est.synchronise.clock import ClockEstimate, apply_clock, from_messages, move_fixes
from pdr_est.synchronise.devices import ClockMethod, on_one_clock
from pdr_est.synchronise.given import GivenClock
from pdr_est.synchronise.overlap import begun_late, outside_others, refuse_apart
from pdr_est.synchronise.walk import WalkClockParams, estimate_clock

__all__ = [
    "ClockEstimate",
    "ClockMethod",
    "GivenClock",
    "WalkClockParams",
    "apply_clock",
    "begun_late",
    "estimate_clock",
    "from_messages",
    "move_fixes",
    "on_one_clock",
    "outside_others",
    "refuse_apart",
]
