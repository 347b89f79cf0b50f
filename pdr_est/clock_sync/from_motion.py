"""Estimate the clock of one device against another's from the motion of the walk that both recorded.

Three searches, each finer than the one before and guided by it:

1. over all shifts: walking intensity and turns, which do not repeat within a walk;
2. in windows of minutes: the rhythm of the steps, which tells which step is which;
3. in windows of seconds: heel strikes, exact to a hundredth of a second but alike at every step, so that only the lag
   closest to the result of the second search counts.
"""

from dataclasses import dataclass

import numpy as np

from pdr_est.clock_sync.clock_jumps import jump_log_likelihood_ratio
from pdr_est.clock_sync.common_signals import RATE_HZ, CommonSignals, extract_common_signals
from pdr_est.clock_sync.robust_line import SIGMA_SKEW, ClockLine, constant_offset_line, fit_clock_line
from pdr_est.clock_sync.same_walk import same_walk_log_odds
from pdr_est.clock_sync.step_duration import step_samples_in_window
from pdr_est.clock_sync.step_matching import match_steps, without_alternation
from pdr_est.clock_sync.windows import comparison_windows
from pdr_est.frames import Array
from pdr_est.params import Fraction, Positive, params
from pdr_est.types.clock import ClockEstimate
from pdr_est.types.recording import DeviceRecording

_LEAST_S = 4.0  # of a window
_SAME_SHIFT_S = 1.0  # shifts that are not closer are both compared
_MOVING = 0.5  # of the usual root mean square of the heel strikes: a window below it was not walked
_LAGS = 2  # lags that are tried in the time of a sample; the best is interpolated
_LAG_S = 1.0 / (_LAGS * RATE_HZ)


@params
class MotionClockParams:
    """Parameters of the three searches for a clock difference; all values are ours."""

    near_s: Positive = 4.0
    """Shifts within this time, s, of the best one count as the same result of the first search."""

    least_lead: Fraction = 0.15
    """Least share by which the agreement of the best shift must exceed that of every shift not near it."""

    step_window_s: Positive = 240.0
    """Least length, s, of the windows of the second search."""

    step_sigma_s: Positive = 0.08
    """Standard deviation, s, of the shift that one window of the second search finds."""

    least_step_lead: Positive = 0.2
    """Least lead (see `StepMatch`) by which the step found must beat any other step."""

    strike_window_s: Positive = 8.0
    """Length, s, of the windows of the third search."""

    strike_search_s: Positive = 0.2
    """Largest lag, s, from the result of the second search at which heel strikes are compared."""

    least_agreement: Fraction = 0.3
    """Least correlation of the heel strikes of a window whose lag counts."""

    least_windows: int = 3
    """Least number of windows whose lags lie on one line."""

    least_share: Fraction = 0.75
    """Least share of windows on the line, among those in which both devices moved."""

    jump_log_likelihood_ratio: Positive = 6.0
    """Least log-likelihood ratio by which another shift must fit some half minute better than the line if the clock
    is taken to jump: odds of 400, since 80 shifts are compared."""

    systematic_s: Positive = 0.02
    """Time, s, by which devices at different places on the body feel one heel strike apart."""


@dataclass(frozen=True)
class _WindowLags:
    """Clock differences found in windows in which both devices moved, (n,) each; times on the reference clock."""

    time_s: Array
    difference_s: Array
    agreement: Array


def estimate_clock_from_motion(
    reference: DeviceRecording, other: DeviceRecording, parameters: MotionClockParams | None = None
) -> ClockEstimate:
    """Estimate offset and skew of the other device's clock, however far apart the clocks are.

    Both devices must have recorded parts of the same walk. Where the recordings do not determine the clock, the
    field `doubts` of the result says why.

    Raises
    ------
    RecordingError
        For a device without an accelerometer, or with less than 5 s of it.
    """
    return estimate_clock_and_same_walk_odds(reference, other, parameters)[0]


def estimate_clock_and_same_walk_odds(
    reference: DeviceRecording, other: DeviceRecording, parameters: MotionClockParams | None = None
) -> tuple[ClockEstimate, float | None]:
    """Estimate the clock as `estimate_clock_from_motion` does, and the log-odds that both recorded one walk.

    The odds (see `same_walk_log_odds`) are those near the estimated shift or near the clocks as recorded, whichever
    are greater; None where nobody walks for long enough.
    """
    chosen = parameters or MotionClockParams()
    one, two = extract_common_signals(reference), extract_common_signals(other)
    shift_s, agreement, lead = _search_all_shifts(one, two, chosen.near_s)
    clock = _refine(one, two, shift_s, agreement, lead, chosen)
    return clock, same_walk_log_odds(one, two, (shift_s,) if abs(shift_s) < _SAME_SHIFT_S else (shift_s, 0.0))


def _refine(
    one: CommonSignals, two: CommonSignals, shift_s: float, agreement: float, lead: float, chosen: MotionClockParams
) -> ClockEstimate:
    """Run the second and the third search from the shift, agreement and lead of the first."""
    rough, step_lead = _search_steps(one, two, shift_s, chosen)
    lags = _search_heel_strikes(one, two, rough, chosen)
    agree = lags.agreement >= chosen.least_agreement
    line, count = rough, 0
    if agree.any():
        times_s, differences_s = lags.time_s[agree], lags.difference_s[agree]
        line = fit_clock_line(times_s, differences_s, SIGMA_SKEW, 0.25 * chosen.systematic_s)
        count = int(line.inlier.sum())
    share = count / max(len(agree), 1)
    return ClockEstimate(
        offset_s=line.offset_s,
        skew=line.slope,
        sigma_s=float(np.hypot(np.sqrt(line.covariance[0, 0]), chosen.systematic_s)),
        sigma_skew=float(np.sqrt(line.covariance[1, 1])),
        at_s=line.at_s,
        quality=share,
        method="walk",
        doubts=(
            *_doubts(agreement, lead, step_lead, count, share, chosen),
            *_jumps(jump_log_likelihood_ratio(one, two, line), chosen),
        ),
    )


def _doubts(
    agreement: float, lead: float, step_lead: float, count: int, share: float, chosen: MotionClockParams
) -> tuple[str, ...]:
    """Say which of the three searches has no clear result."""
    doubts = []
    if lead < chosen.least_lead:
        doubts.append(f"a quite different shift fits nearly as well (agreement {agreement:.2f}, lead {lead:.2f})")
    if step_lead < chosen.least_step_lead:
        doubts.append(f"it is unclear which step is which: another one fits nearly as well (lead {step_lead:.2f})")
    if count < chosen.least_windows or share < chosen.least_share:
        doubts.append(
            f"the steps of only {count} windows, {share:.0%} of all, fit one line: nobody walks, or the clock jumps"
        )
    return tuple(doubts)


def _jumps(log_likelihood_ratio: float, chosen: MotionClockParams) -> tuple[str, ...]:
    """Say that another shift fits a part of the walk better."""
    if log_likelihood_ratio < chosen.jump_log_likelihood_ratio:
        return ()
    return ("another shift fits some half minute much better: the clock jumps",)


def _search_all_shifts(one: CommonSignals, two: CommonSignals, near_s: float) -> tuple[float, float, float]:
    """Return the shift at which intensity and turns agree best, that agreement, and its relative lead."""
    from scipy.signal import fftconvolve  # slow to load, and not needed for a single device

    total, kinds = np.zeros(len(one.log_intensity) + len(two.log_intensity) - 1), 0
    for a, b in ((one.log_intensity, two.log_intensity), (one.turn_rate_radps, two.turn_rate_radps)):
        if a is not None and b is not None:
            a, b = a - a.mean(), b - b.mean()
            size = float(np.sqrt((a @ a) * (b @ b)))
            total += fftconvolve(b, a[::-1]) / max(size, 1e-12)
            kinds += 1
    total /= kinds
    best = int(np.argmax(total))
    away = np.abs(np.arange(len(total)) - best) > near_s * RATE_HZ
    second = float(total[away].max(initial=0.0))
    shift_s = two.start_s - one.start_s + (best - (len(one.log_intensity) - 1)) / RATE_HZ
    return shift_s, float(total[best]), 1.0 - second / max(float(total[best]), 1e-12)


def _search_steps(
    one: CommonSignals, two: CommonSignals, shift_s: float, chosen: MotionClockParams
) -> tuple[ClockLine, float]:
    """Fit a line to the step matches of all windows; without a window keep the shift, with a lead of 0."""
    constant = constant_offset_line(shift_s)
    windows = comparison_windows(one, two, constant, chosen.step_window_s, 0.0, _LEAST_S)
    matches = [match_steps(one, two, rows, shift_s) for rows in windows]
    if not matches:
        return constant, 0.0
    middles_s = np.array([one.time_s[rows].mean() for rows in windows])
    shifts_s = np.array([match.shift_s for match in matches])
    line = fit_clock_line(middles_s, shifts_s, SIGMA_SKEW, chosen.step_sigma_s)
    return line, float(np.median([match.lead for match in matches]))


def _search_heel_strikes(
    one: CommonSignals, two: CommonSignals, line: ClockLine, chosen: MotionClockParams
) -> _WindowLags:
    """Find the lag of the heel strikes in each window, close to a known line."""
    from scipy.interpolate import CubicSpline

    there = CubicSpline(two.time_s, two.heel_strikes_mps2)
    reach = round(chosen.strike_search_s * RATE_HZ)
    windows = comparison_windows(one, two, line, chosen.strike_window_s, reach / RATE_HZ, _LEAST_S)
    sizes = np.array([np.std(one.heel_strikes_mps2[rows]) for rows in windows])
    found = []
    for rows, size in zip(windows, sizes, strict=True):
        if size < _MOVING * float(np.median(sizes)):
            continue
        middle_s = float(one.time_s[rows].mean())
        difference_s = float(line.difference_at(np.array(middle_s)))
        step = step_samples_in_window(one, two, rows, difference_s)
        here: Array = without_alternation(one, one.heel_strikes_mps2, one.time_s[rows[0]], len(rows), step)
        first_s = one.time_s[rows[0]] + difference_s - (reach + step) / RATE_HZ
        fine: Array = there(first_s + _LAG_S * np.arange(_LAGS * (len(rows) + 2 * reach + step)))
        fine = 0.5 * (fine[_LAGS * step :] + fine[: -_LAGS * step])
        shifted = np.lib.stride_tricks.sliding_window_view(fine, _LAGS * len(rows))[:, ::_LAGS]
        lags_s: Array = np.linspace(-reach, reach, len(shifted)) / RATE_HZ
        lag_s, agreement = _best_lag(here, shifted, lags_s)
        found.append((middle_s, difference_s + lag_s, agreement))
    return _WindowLags(*np.array(found, dtype=np.float64).reshape(-1, 3).T)


def _best_lag(values: Array, shifted: Array, lags_s: Array) -> tuple[float, float]:
    """Return lag and height of the highest correlation peak of (n,) with (lags, n) values; (0, -1) if none."""
    values = values - values.mean()
    centred = shifted - shifted.mean(axis=1, keepdims=True)
    size = np.maximum(np.linalg.norm(centred, axis=1) * np.linalg.norm(values), 1e-12)
    agreement = centred @ values / size
    peaks = np.flatnonzero((agreement[1:-1] >= agreement[:-2]) & (agreement[1:-1] > agreement[2:])) + 1
    if not len(peaks):
        return 0.0, -1.0
    k = int(peaks[np.argmax(agreement[peaks])])
    before, top, after = agreement[k - 1 : k + 2]
    return float(lags_s[k] + 0.5 * _LAG_S * (before - after) / (before - 2.0 * top + after)), float(top)
