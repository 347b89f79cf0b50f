"""The clock of one device against another's from what both recorded of the same walk.

Three looks, each finer than the one before and led by it. Over all shifts: effort (starts, stops, briskness) and
turns, which repeat nowhere. In windows of minutes: the rhythm of the steps, for which step is which. In windows of
some seconds: heel strikes, exact to a hundredth of a second but alike at every step, so that only the one nearest to
the second look's answer counts.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import fftconvolve

from pdr_est.clock_sync.common_signals import RATE_HZ, CommonSignals, common_signals
from pdr_est.clock_sync.robust_line import SIGMA_SKEW, Line, fit_line, level_line, stretches
from pdr_est.clock_sync.same_walk import best_minute
from pdr_est.clock_sync.step_matching import same_step
from pdr_est.frames import Array
from pdr_est.params import Fraction, Positive, params
from pdr_est.types.clock import ClockEstimate
from pdr_est.types.recording import DeviceRecording

_LEAST_S = 4.0  # of a window
_MOVING = 0.5  # of the strikes' usual rms: below it there is nothing to compare
_LAG_S = 0.01  # between the lags that are tried; the best is interpolated


@params
class WalkClockParams:
    """Numbers of the three looks, all ours.

    near_s, least_lead: by how much of its agreement the best of all shifts must beat every shift that is not so near.
    step_window_s, step_sigma_s: least length of the windows of the second look, and standard deviation of what each
    finds. least_step_lead: by how much of its score (see `same_step`) the step it finds must beat any other.
    strike_window_s, strike_search_s: length of the windows of the third look, and how far from the second's answer
    their lags are looked for. least_agreement: correlation of a window whose lag counts. least_windows, least_share:
    how many of these must lie on one line, also as a share of those in which both devices moved. systematic_s: what
    devices at different places on a body feel a strike apart.
    """

    near_s: Positive = 4.0
    least_lead: Fraction = 0.15
    step_window_s: Positive = 240.0
    step_sigma_s: Positive = 0.08
    least_step_lead: Positive = 0.2
    strike_window_s: Positive = 8.0
    strike_search_s: Positive = 0.2
    least_agreement: Fraction = 0.3
    least_windows: int = 3
    least_share: Fraction = 0.75
    systematic_s: Positive = 0.02


@dataclass(frozen=True)
class _Windows:
    """Stretches in which both devices moved. time_s: their middles on the reference clock; difference_s: other clock
    less reference clock; agreement: correlation there; (n,) each."""

    time_s: Array
    difference_s: Array
    agreement: Array


def estimate_clock(
    reference: DeviceRecording, other: DeviceRecording, parameters: WalkClockParams | None = None
) -> ClockEstimate:
    """Offset and skew of the other device's clock, however far apart the clocks are.

    Both must have recorded parts of the same walk. Where the recordings do not tell, `doubts` says why. Raises
    RecordingError for a device without accelerometer, or with too little of it.
    """
    return clock_and_steps(reference, other, parameters)[0]


def clock_and_steps(
    reference: DeviceRecording, other: DeviceRecording, parameters: WalkClockParams | None = None
) -> tuple[ClockEstimate, float | None]:
    """`estimate_clock`, and how well the steps agree in the best minute (see `best_minute`), also with the clocks as
    they were recorded."""
    chosen = parameters or WalkClockParams()
    one, two = common_signals(reference), common_signals(other)
    shift_s, agreement, lead = _over_all_shifts(one, two, chosen.near_s)
    clock = _refined(one, two, shift_s, agreement, lead, chosen)
    return clock, best_minute(one, two, (shift_s, 0.0))


def _refined(
    one: CommonSignals, two: CommonSignals, shift_s: float, agreement: float, lead: float, chosen: WalkClockParams
) -> ClockEstimate:
    """The second and the third look, from the shift that the first one found, its agreement and its lead."""
    rough, step_lead = _steps(one, two, shift_s, chosen)
    strikes = _windows(one, two, rough, chosen)
    agree = strikes.agreement >= chosen.least_agreement
    line, count = rough, 0
    if agree.any():
        times_s, differences_s = strikes.time_s[agree], strikes.difference_s[agree]
        line = fit_line(times_s, differences_s, SIGMA_SKEW, 0.25 * chosen.systematic_s)
        count = int(line.on_it.sum())
    share = count / max(len(agree), 1)
    doubts = _doubts(agreement, lead, step_lead, count, share, chosen)
    return ClockEstimate(
        offset_s=line.offset_s,
        skew=line.slope,
        sigma_s=float(np.hypot(np.sqrt(line.covariance[0, 0]), chosen.systematic_s)),
        sigma_skew=float(np.sqrt(line.covariance[1, 1])),
        at_s=line.at_s,
        quality=share,
        method="walk",
        doubts=doubts,
    )


def _doubts(
    agreement: float, lead: float, step_lead: float, count: int, share: float, chosen: WalkClockParams
) -> tuple[str, ...]:
    doubts = []
    if lead < chosen.least_lead:
        doubts.append(f"a quite different shift fits nearly as well (agreement {agreement:.2f}, lead {lead:.2f})")
    if step_lead < chosen.least_step_lead:
        doubts.append(f"which step is which is unsure: another one fits nearly as well (lead {step_lead:.2f})")
    if count < chosen.least_windows or share < chosen.least_share:
        doubts.append(
            f"steps of {count} stretches only, {share:.0%} of all, fit one line: no walk, or a clock that jumps"
        )
    return tuple(doubts)


def _over_all_shifts(one: CommonSignals, two: CommonSignals, near_s: float) -> tuple[float, float, float]:
    """Difference of the clocks at which effort and turns agree best; how well; and by which share of that more than
    at any difference that is not near."""
    total, kinds = np.zeros(len(one.effort) + len(two.effort) - 1), 0
    for a, b in ((one.effort, two.effort), (one.turn, two.turn)):
        if a is not None and b is not None:
            a, b = a - a.mean(), b - b.mean()
            size = float(np.sqrt((a @ a) * (b @ b)))
            total += fftconvolve(b, a[::-1]) / max(size, 1e-12)
            kinds += 1
    total /= kinds
    best = int(np.argmax(total))
    away = np.abs(np.arange(len(total)) - best) > near_s * RATE_HZ
    second = float(total[away].max(initial=0.0))
    shift_s = two.start_s - one.start_s + (best - (len(one.effort) - 1)) / RATE_HZ
    return shift_s, float(total[best]), 1.0 - second / max(float(total[best]), 1e-12)


def _steps(one: CommonSignals, two: CommonSignals, shift_s: float, chosen: WalkClockParams) -> tuple[Line, float]:
    """The line of the second look, and the median lead of its windows; without any, what the first look knows."""
    level = level_line(shift_s)
    windows = stretches(one, two, level, chosen.step_window_s, 0.0, _LEAST_S)
    found = [same_step(one, two, rows, shift_s) for rows in windows]
    if not found:
        return level, 0.0
    middles_s = np.array([one.time_s[rows].mean() for rows in windows])
    line = fit_line(middles_s, np.array([step.shift_s for step in found]), SIGMA_SKEW, chosen.step_sigma_s)
    return line, float(np.median([step.lead for step in found]))


def _windows(one: CommonSignals, two: CommonSignals, line: Line, chosen: WalkClockParams) -> _Windows:
    """Lags of the heel strikes in consecutive windows, close to a line."""
    there = CubicSpline(two.time_s, two.strikes)
    reach_s = chosen.strike_search_s
    lags_s = np.arange(-reach_s, reach_s + 0.5 * _LAG_S, _LAG_S)
    windows = stretches(one, two, line, chosen.strike_window_s, reach_s, _LEAST_S)
    sizes = np.array([np.std(one.strikes[rows]) for rows in windows])
    found = []
    for rows, size in zip(windows, sizes, strict=True):
        if size < _MOVING * float(np.median(sizes)):
            continue
        time_s = one.time_s[rows]
        middle_s = float(time_s.mean())
        shifted = there(time_s + line.value(time_s) + lags_s[:, None])
        lag_s, agreement = _best_lag(one.strikes[rows], shifted, lags_s)
        found.append((middle_s, float(line.value(np.array(middle_s))) + lag_s, agreement))
    return _Windows(*np.array(found, dtype=np.float64).reshape(-1, 3).T)


def _best_lag(values: Array, shifted: Array, lags_s: Array) -> tuple[float, float]:
    """Lag of the highest peak of the correlation of values (n,) with shifted (lags, n), and its height; -1 without a
    peak inside."""
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
