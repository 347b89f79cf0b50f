"""Check the gyroscope against the accelerometer: axes, signs, gains and clock, by gravity that must stay put.

See `pdr_est.io.conversion.gravity_drift` for the comparison, and for what it cannot see. The explanations are
compared by their likelihood: the gyroscope is right but for a constant bias and small errors of its gains; its axes
are ordered or signed otherwise; one axis has a wrong gain; its clock is late or early. Beforehand one recording in
fifty is taken to be faulty, simple faults more often than contrived ones. Constants are ours.

Over 395 sound recordings of real phones no other axes, signs or gain are better than the gyroscope as it is by more
than 4.7 in the logarithm of the likelihood, or reach a probability of 3 %; of faults put into them, other orders and
signs of the axes reach 9 in nine of ten, while an axis that reads half of the truth shows in one of ten: most phones
never turn over far enough. A fault is told from a probability of 20 % on, because its track is worth nothing.

What the fit takes for a constant bias is told if it is beyond that of any recording here.
(The unit shows without gravity, see `pdr_est.io.conversion.rotation_unit`.)
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.io.conversion.gravity_drift import WalkerVelocity, gravity_scatter, hann_means, log_likelihood
from pdr_est.io.conversion.gravity_windows import GravityWindows, gravity_windows, turned_by
from pdr_est.preprocessing.quality.gyroscope_fit import GyroscopeFit, fit_gyroscope
from pdr_est.types.recording import Signal

SURE_FAULT = 0.8
"""Probability of a fault of the gyroscope from which on it is no mere possibility."""

_FAULTY_SHARE = 0.02
_OF_AXES, _OF_GAINS, _OF_LAGS = 0.7, 0.2, 0.1  # shares of the faults
_PER_OPERATION = 0.3  # how much rarer a fault of axes is with each axis negated and each pair exchanged
_LEAST_PROBABILITY = 0.2
_LARGEST_BIAS_RADPS = 0.07  # 4 deg/s; the raw sensors of the belts of SisFall have up to 0.066
_BIAS_LOG_ODDS = 10.0  # improvement by the bias that no motion brings about; ours
_NOTHING_FITS_MPS2 = 2.0
_ARC = 4.0  # length of an arc by the standard deviation of a component of four points that are spread over it evenly
_LEAST_TOLD = 0.1  # of the probability of the best explanation
_MOST_TOLD = 3
_MOST_REFINED = 3  # explanations by axes whose bias is fitted
_LAGS_S = (-0.8, -0.4, -0.2, -0.1, 0.1, 0.2, 0.4, 0.8)
_AXES = "xyz"


@dataclass(frozen=True)
class _Explanation:
    """Explanation of a contradiction by one fault of the gyroscope.

    Attributes
    ----------
    words
        Explanation that follows "the gyroscope fits".
    log_odds
        Logarithm of its probability over that of a sound gyroscope.
    variance
        (k,) apparent movement of gravity in the windows, m²/s⁴, if it is true.
    """

    words: str
    log_odds: float
    variance: Array


def gyroscope_warnings(
    windows: GravityWindows, force: Signal, rate: Signal, least_probability: float = _LEAST_PROBABILITY
) -> tuple[str, ...]:
    """Warn if the gyroscope moves gravity about and an explanation fits better, or if nothing fits.

    Parameters
    ----------
    windows
        Windows of both sensors.
    force, rate
        (n, 3) specific force, m/s², and rotation rate, rad/s.
    least_probability
        Probability of a fault from which on it is told.
    """
    # No explanation can be better than gravity that does not move at all: most gyroscopes pass here.
    least_odds = least_probability / (1.0 - least_probability)
    enough = np.log(least_odds) - np.log(_FAULTY_SHARE * _OF_GAINS / 3.0)
    as_it_is = log_likelihood(gravity_scatter(windows.turned, windows), windows)
    if -as_it_is < enough:
        return ()
    sound = fit_gyroscope(windows.rate_radps, windows)
    if -sound.log_likelihood < enough:
        return _bias_warning(sound, as_it_is)
    return _fault_warning(windows, force, rate, sound, least_odds) or _bias_warning(sound, as_it_is)


def _bias_warning(sound: GyroscopeFit, as_it_is: float) -> tuple[str, ...]:
    """Warn of a bias that keeps gravity in its place and is too large to be followed.

    Parameters
    ----------
    sound
        Fit of bias and small errors of gains.
    as_it_is
        Log likelihood of the movement of gravity without them.
    """
    size_radps = float(np.linalg.norm(sound.bias_radps))
    if size_radps < _LARGEST_BIAS_RADPS or sound.log_likelihood - as_it_is < _BIAS_LOG_ODDS:
        return ()
    axes = ", ".join(f"{name} {bias:+.2f}" for name, bias in zip(_AXES, sound.bias_radps, strict=True))
    return (
        f"the gyroscope reads at least {size_radps:.2f} rad/s ({np.degrees(size_radps):.1f} deg/s) too much all the "
        f"time ({axes} rad/s, besides what it reads about the vertical): subtract what it reads while it lies still, "
        "or do not trust headings and track",
    )


def _fault_warning(
    windows: GravityWindows, force: Signal, rate: Signal, sound: GyroscopeFit, least_odds: float
) -> tuple[str, ...]:
    """Compare the explanations by a fault with a sound gyroscope, and warn of those that are probable."""
    others = sorted(_explanations(windows, force, rate, sound), key=lambda one: -one.log_odds)
    moved_mps2 = float(np.sqrt(sound.variance.max()))
    moved_deg = min(float(np.degrees(_ARC * moved_mps2 / STANDARD_GRAVITY_MPS2)), 180.0)
    odds = np.exp(np.minimum([one.log_odds for one in others], 500.0))
    maybe = "" if odds.sum() >= SURE_FAULT / (1.0 - SURE_FAULT) else "may "
    contradiction = (
        f"gyroscope and accelerometer {maybe}contradict each other: by the gyroscope gravity moves by up to "
        f"{moved_deg:.0f} deg within seconds, which the accelerometer does not see"
    )
    best_mps2 = max(_movement_mps2(others[0].variance), 1e-3)
    if best_mps2 > _NOTHING_FITS_MPS2:
        return (
            f"{contradiction}, and no other axes, signs, gain or delay of the gyroscope fit: do not trust headings "
            "and track; check that both sensors are of one device and one walk",
        )
    if odds.sum() < least_odds:
        return ()
    better = _movement_mps2(sound.variance) / best_mps2
    return (
        f"{contradiction}; the gyroscope fits {better:.1f} times better {_told(others, odds)}: correct its columns, "
        "or do not trust headings and track",
    )


def _told(others: Sequence[_Explanation], odds: Array) -> str:
    """List the best explanations with their probabilities; others: the most probable one first."""
    probabilities = odds / (1.0 + odds.sum())
    alike = int((probabilities >= _LEAST_TOLD * probabilities[0]).sum())
    told = [
        f"{one.words} (probability {probability:.0%})"
        for one, probability in zip(others[: min(alike, _MOST_TOLD)], probabilities, strict=False)
    ]
    more = f", or in one of {alike - _MOST_TOLD} more ways" if alike > _MOST_TOLD else ""
    return ", or ".join(told) + more


def _movement_mps2(variance: Array) -> float:
    """Return the root mean square of the apparent movement of gravity."""
    return float(np.sqrt(variance.mean()))


def _explanations(
    windows: GravityWindows, force: Signal, rate: Signal, sound: GyroscopeFit
) -> Iterator[_Explanation]:
    yield from _by_axes(windows, sound)
    for axis, name in enumerate(_AXES):
        fitted = fit_gyroscope(windows.rate_radps, windows, axis)
        if fitted.corrections[axis] < 0.0:
            continue  # rates that are too large cannot be told from motion that moves gravity
        log_odds = float(np.log(_FAULTY_SHARE * _OF_GAINS / 3.0)) + fitted.log_evidence - sound.log_evidence
        gain = 1.0 / max(1.0 + fitted.corrections[axis], 1e-3)
        words = f"if its {name} axis reads {gain:.2f} +- {fitted.sigmas[axis] * gain**2:.2f} of the truth"
        yield _Explanation(words, log_odds, fitted.variance)
    for lag_s in _LAGS_S:
        later = gravity_windows(force, rate, lag_s)
        if later is None or len(later) != len(windows):
            continue
        variance = gravity_scatter(later.turned, later)
        gained = log_likelihood(variance, later) - sound.log_likelihood
        words = f"{abs(lag_s):g} s {'later' if lag_s > 0.0 else 'earlier'} than its time stamps say"
        log_odds = float(np.log(_FAULTY_SHARE * _OF_LAGS / len(_LAGS_S))) + gained
        yield _Explanation(words, log_odds, variance)


def _by_axes(windows: GravityWindows, sound: GyroscopeFit) -> list[_Explanation]:
    """Try each other order and sign of the axes; the best ones once more, with a bias."""
    tried = [(axes, variance, log_likelihood(variance, windows)) for axes, variance in _other_axes(windows)]
    tried.sort(key=lambda one: -one[2])
    weights = np.array([_PER_OPERATION ** _operations(axes) for axes, _, _ in tried])
    shares = _FAULTY_SHARE * _OF_AXES * weights / weights.sum()
    found = []
    for number, ((axes, variance, likelihood), share) in enumerate(zip(tried, shares, strict=True)):
        if number < _MOST_REFINED:
            fitted = fit_gyroscope(windows.rate_radps @ axes.T, windows)
            if fitted.log_likelihood > likelihood:
                variance, likelihood = fitted.variance, fitted.log_likelihood
        names = ", ".join(f"{'-' if row.sum() < 0.0 else ''}{_AXES[np.abs(row).argmax()]}" for row in axes)
        log_odds = float(np.log(share)) + likelihood - sound.log_likelihood
        found.append(_Explanation(f"with axes ({names})", log_odds, variance))
    return found


def _operations(axes: Array) -> int:
    """Count the axes that are negated, all of them as one sense of rotation, and the pairs that are exchanged."""
    moved = int((np.abs(axes).argmax(axis=1) != np.arange(3)).sum())
    negated = int((axes < 0.0).sum())
    return (1 if negated == 3 else negated) + max(moved - 1, 0)


def _other_axes(windows: GravityWindows) -> Iterator[tuple[Array, Array]]:
    """Compute for each other order and sign of the axes its matrix (3, 3) and the movement of gravity (k,).

    For a proper rotation P, rates P w turn vectors as rates w turn the vectors P' f and P after them. All proper ones
    therefore need one integration, whose means are kept for each pair of components; the improper ones, which are
    left-handed, need a second one with the opposite sign. The velocity of the walker is unknown in all axes alike.
    """
    for sign in (1.0, -1.0):
        turned = turned_by(sign * windows.rate_radps, windows.period_s)
        walker = WalkerVelocity.of(turned, windows)
        pairs = hann_means(turned[..., None] * windows.force_mps2[:, :, None, None, :], windows.period_s)
        for order in itertools.permutations(range(3)):
            for signs in itertools.product((1.0, -1.0), repeat=3):
                axes = np.zeros((3, 3))
                axes[range(3), order] = signs
                proper = sign * axes
                if np.linalg.det(proper) < 0.0 or (axes == np.eye(3)).all():
                    continue
                yield axes, walker.scatter(np.einsum("kmabc,cb->kma", pairs, proper))
