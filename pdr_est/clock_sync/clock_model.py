"""How one device's clock runs against another's: from messages, and applied to a recording."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.clock_sync.robust_line import SIGMA_SKEW, fit_line
from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.types.clock import ClockEstimate
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording

_LEAST_SHARE = 0.75  # of the exchanges, on the line of a clock that does not jump; ours


def from_messages(t1_s: Array, t2_s: Array, t3_s: Array) -> ClockEstimate:
    """The clock of a device that answers messages: Robust DR section V-B.

    The reference device sends at t1 of its clock, the other receives and answers at t2 of its own, and the answer
    arrives at t3, (n,) each: the offset is t2 - (t1 + t3) / 2 if both ways take the same time. It cannot be wrong by
    more than half of the round trip. The paper has one exchange and so no skew; here the line through several gives
    one, and of these only exchanges of at most twice the shortest round trip count, for they wait in no queue.
    Raises RecordingError for stamps that are not finite, differ in number, or of which t3 is before t1.
    """
    t1_s, t2_s, t3_s = (np.atleast_1d(np.asarray(t, dtype=np.float64)) for t in (t1_s, t2_s, t3_s))
    if not (t1_s.ndim == 1 and len(t1_s) and t1_s.shape == t2_s.shape == t3_s.shape):
        raise RecordingError(
            f"clock messages with {t1_s.size}, {t2_s.size}, {t3_s.size} stamps: one of each is needed"
        )
    if not (np.isfinite([t1_s, t2_s, t3_s]).all() and np.all(t3_s >= t1_s)):
        raise RecordingError(
            "clock messages: every stamp must be finite, and no answer (t3) before its question (t1)"
        )
    trip_s = t3_s - t1_s
    quick = trip_s <= 2.0 * trip_s.min() + 1e-9
    middle_s, half_s = 0.5 * (t1_s + t3_s)[quick], 0.5 * trip_s[quick]
    # The delay of one way is anywhere between none and the whole trip, and much the same in all exchanges.
    bound_s = float(np.median(half_s))
    line = fit_line(middle_s, t2_s[quick] - middle_s, SIGMA_SKEW, max(bound_s / np.sqrt(3.0), 1e-4))
    asymmetry_s = bound_s / np.sqrt(3.0)
    share = float(np.mean(line.on_it))
    doubts = []
    if bound_s >= 0.1:
        doubts.append(f"messages took {2.0 * bound_s:.3f} s there and back: offsets within half of it")
    if share < _LEAST_SHARE:
        doubts.append(f"{line.on_it.sum()} of {len(line.on_it)} exchanges fit one line: a clock that jumps")
    return ClockEstimate(
        offset_s=line.offset_s,
        skew=line.slope,
        sigma_s=max(asymmetry_s, float(np.sqrt(line.covariance[0, 0]))),
        sigma_skew=float(np.sqrt(line.covariance[1, 1])),
        at_s=line.at_s,
        quality=share,
        method="messages",
        doubts=tuple(doubts),
    )


def apply_clock(device: DeviceRecording, clock: ClockEstimate) -> DeviceRecording:
    """What the other device recorded, on the reference clock: all channels, and a note among the decisions."""
    note = (
        f"clock ({clock.method}): ahead by {clock.offset_s:.4f} s at {clock.at_s:.1f} s, {clock.skew * 1e6:+.1f} ppm"
    )
    return replace(
        device.with_times(clock.to_reference),
        decisions=(*device.decisions, note),
        warnings=(*device.warnings, *(f"clock: {doubt}" for doubt in clock.doubts)),
    )


def move_fixes(fixes: Sequence[PositionFix], clock: ClockEstimate) -> tuple[PositionFix, ...]:
    """Fixes that the other device kept, on the reference clock."""
    times_s = clock.to_reference(np.array([fix.time_s for fix in fixes], dtype=np.float64))
    return tuple(replace(fix, time_s=float(time_s)) for fix, time_s in zip(fixes, times_s, strict=True))
