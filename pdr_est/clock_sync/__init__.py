"""Clock synchronisation: bring the devices of one walk onto the clock of the first device.

Every phone stamps its samples with a clock of its own. This package estimates offset and skew of each clock against
that of the first device, the *reference clock*, and converts the recordings.

==================  ================================================================================================
file                content
==================  ================================================================================================
align_devices       entry point: choose the method, apply the clocks, check that the recordings overlap
from_motion         estimate a clock from the motion of the same walk, felt by both devices
from_messages       estimate clocks from time-stamped messages (Robust DR section V-B)
from_config         take clocks from the configuration
clock_jumps         find out whether a clock jumps within a walk
clock_model         apply an estimated clock to recordings and position fixes
common_signals      signals that are alike on all devices of one body: walking intensity, steps, turns
windows             windows of samples in which two devices are compared
step_duration       usual duration of a step
step_matching       find which step of one device is which step of the other
same_walk           probability that two recordings are of one walk
robust_line         robust straight line through clock differences
overlap             check that devices recorded at the same time
==================  ================================================================================================
"""

from pdr_est.clock_sync.align_devices import ClockMethod, align_device_clocks
from pdr_est.clock_sync.clock_model import apply_clock, move_fixes
from pdr_est.clock_sync.from_config import GivenClock
from pdr_est.clock_sync.from_messages import estimate_clock_from_messages
from pdr_est.clock_sync.from_motion import MotionClockParams, estimate_clock_from_motion
from pdr_est.clock_sync.overlap import coverage_warnings, devices_started_late, require_overlap
from pdr_est.types.clock import ClockEstimate

__all__ = [
    "ClockEstimate",
    "ClockMethod",
    "GivenClock",
    "MotionClockParams",
    "align_device_clocks",
    "apply_clock",
    "coverage_warnings",
    "devices_started_late",
    "estimate_clock_from_messages",
    "estimate_clock_from_motion",
    "move_fixes",
    "require_overlap",
]
