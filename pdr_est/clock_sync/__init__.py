"""Clocks of the devices of one walk: found from their recordings or messages, and brought onto one of them."""

from pdr_est.clock_sync.align_devices import ClockMethod, on_one_clock
from pdr_est.clock_sync.clock_model import apply_clock, from_messages, move_fixes
from pdr_est.clock_sync.from_config import GivenClock
from pdr_est.clock_sync.from_motion import WalkClockParams, estimate_clock
from pdr_est.clock_sync.overlap import begun_late, outside_others, refuse_apart
from pdr_est.types.clock import ClockEstimate

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
