"""Apply an estimated clock to a recording and to position fixes."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.types.clock import ClockEstimate
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording


def apply_clock(device: DeviceRecording, clock: ClockEstimate) -> DeviceRecording:
    """Convert the time stamps of all channels of a device to the reference clock.

    The clock is noted among the decisions of the device, and its doubts among the warnings.
    """
    note = (
        f"clock ({clock.method}): ahead by {clock.offset_s:.4f} s at {clock.at_s:.1f} s, {clock.skew * 1e6:+.1f} ppm"
    )
    return replace(
        device.with_times(clock.to_reference),
        decisions=(*device.decisions, note),
        warnings=(*device.warnings, *(f"clock: {doubt}" for doubt in clock.doubts)),
    )


def move_fixes(fixes: Sequence[PositionFix], clock: ClockEstimate) -> tuple[PositionFix, ...]:
    """Convert the times of position fixes, stamped by the other device, to the reference clock."""
    times_s = clock.to_reference(np.array([fix.time_s for fix in fixes], dtype=np.float64))
    return tuple(replace(fix, time_s=float(time_s)) for fix, time_s in zip(fixes, times_s, strict=True))
