"""Check the gyroscope against the accelerometer: axes, signs and clock, by gravity that must stay where it is.

See `pdr_est.io.conversion.gravity_windows` for the comparison, and for what it cannot see. The explanations are
compared by their likelihood: the gyroscope is right but for a constant bias; its axes are ordered or signed
otherwise; its clock is late or early. One recording in fifty is taken to be faulty beforehand, each explanation
equally often. Constants are ours. Eight of 358 real recordings have a window in which gravity moves suspiciously, and
in none of them an explanation fits better than the gyroscope as it is by more than a fifth. (The unit shows without
gravity, see `pdr_est.io.conversion.rotation_unit`.)
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.io.conversion.gravity_windows import (
    GravityWindows,
    cross_matrices,
    gravity_scatter,
    gravity_windows,
    hann_means,
    log_likelihood,
    scatter,
    turned_by,
)
from pdr_est.types.recording import Signal

_BIAS_SIGMA_RADPS = 0.05  # raw gyroscopes of belts have up to 0.1 rad/s
_FAULTY_SHARE = 0.02
_LEAST_PROBABILITY = 0.8
_SUSPICIOUS_MPS2 = 0.8  # movement of gravity in a window: without one like that nothing is compared
_LEAST_IMPROVEMENT = 1.5  # of that movement: a slightly better fit is chance, however many windows repeat it
_NOTHING_FITS_MPS2 = 2.0
_ARC = 4.0  # length of an arc by the standard deviation of a component of four points that are spread over it evenly
_AS_GOOD = 4.0  # difference of log likelihoods of explanations that are told together
_MOST_TOLD = 3
_LAGS_S = (-0.8, -0.4, -0.2, -0.1, 0.1, 0.2, 0.4, 0.8)
_AXES = "xyz"


@dataclass(frozen=True)
class _Explanation:
    """Explanation of a contradiction by one fault of the gyroscope.

    Attributes
    ----------
    words
        Explanation that follows "the gyroscope fits".
    variance
        (k,) apparent movement of gravity in the windows, m²/s⁴, if it is true.
    log_likelihood
        Log likelihood of that movement.
    """

    words: str
    variance: Array
    log_likelihood: float


def gyroscope_warnings(windows: GravityWindows, force: Signal, rate: Signal) -> tuple[str, ...]:
    """Warn if the gyroscope moves gravity about and an explanation fits better, or if nothing fits.

    Parameters
    ----------
    windows
        Windows of both sensors.
    force, rate
        (n, 3) specific force, m/s², and rotation rate, rad/s.
    """
    # The bias is fitted only where it matters, because most gyroscopes pass without.
    own = gravity_scatter(windows.turned, windows)
    if np.sqrt(own.max()) < _SUSPICIOUS_MPS2:
        return ()
    own = _scatter_without_bias(windows)
    moved_mps2 = _movement_mps2(own)
    if np.sqrt(own.max()) < _SUSPICIOUS_MPS2:
        return ()
    others = sorted(_explanations(windows, force, rate), key=lambda one: -one.log_likelihood)
    best_mps2 = max(_movement_mps2(others[0].variance), 1e-3)
    moved_deg = min(float(np.degrees(_ARC * np.sqrt(own.max()) / STANDARD_GRAVITY_MPS2)), 180.0)
    contradiction = (
        "gyroscope and accelerometer contradict each other: by the gyroscope gravity moves by up to "
        f"{moved_deg:.0f} deg within seconds, which the accelerometer does not see"
    )
    if best_mps2 > _NOTHING_FITS_MPS2:
        return (
            f"{contradiction}, and no other axes, signs or delay of the gyroscope fit: do not trust headings and "
            "track; check that both sensors are of one device and one walk",
        )
    gains = np.array([one.log_likelihood for one in others]) - log_likelihood(own, windows)
    odds = _FAULTY_SHARE / (1.0 - _FAULTY_SHARE) * float(np.exp(np.minimum(gains, 500.0)).mean())
    better = moved_mps2 / best_mps2
    if better < _LEAST_IMPROVEMENT or odds < _LEAST_PROBABILITY / (1.0 - _LEAST_PROBABILITY):
        return ()
    return (
        f"{contradiction}; the gyroscope fits {better:.1f} times better {_told(others)}: correct its columns, or "
        "do not trust headings and track",
    )


def _told(others: Sequence[_Explanation]) -> str:
    """List the best explanations that are about equally likely; others: by their likelihood."""
    alike = [one.words for one in others if others[0].log_likelihood - one.log_likelihood < _AS_GOOD]
    more = f", or in one of {len(alike) - _MOST_TOLD} more ways" if len(alike) > _MOST_TOLD else ""
    return ", or ".join(alike[:_MOST_TOLD]) + more


def _movement_mps2(variance: Array) -> float:
    """Return the root mean square of the apparent movement of gravity."""
    return float(np.sqrt(variance.mean()))


def _scatter_without_bias(windows: GravityWindows) -> Array:
    """Compute the apparent movement (k,) of gravity after the gyroscope's most probable bias is removed."""
    bias = np.zeros(3)
    for _ in range(2):
        turned = turned_by(windows.rate_radps - bias, windows.period_s)
        force = np.einsum("kjab,kjb->kja", turned, windows.force_mps2)
        # A bias turns the axes of a sample by its integral, and gravity with them.
        effect = cross_matrices(force) @ (np.cumsum(turned, axis=1) * windows.period_s)
        means, slopes = hann_means(force, windows.period_s), hann_means(effect, windows.period_s)
        means, slopes = (one - one.mean(axis=1, keepdims=True) for one in (means, slopes))
        # Robust weights: a window whose gravity moves for another reason must not decide.
        weight = 1.0 / (windows.variance_m2ps4 + scatter(means))
        normal = np.einsum("k,kmab,kmac->bc", weight, slopes, slopes) + np.eye(3) / _BIAS_SIGMA_RADPS**2
        right = np.einsum("k,kmab,kma->b", weight, slopes, means) + bias / _BIAS_SIGMA_RADPS**2
        bias = bias - np.linalg.solve(normal, right)
    return gravity_scatter(turned_by(windows.rate_radps - bias, windows.period_s), windows)


def _explanations(windows: GravityWindows, force: Signal, rate: Signal) -> Iterator[_Explanation]:
    for words, variance in _other_axes(windows):
        yield _Explanation(words, variance, log_likelihood(variance, windows))
    for lag_s in _LAGS_S:
        later = gravity_windows(force, rate, lag_s)
        if later is None or len(later) != len(windows):
            continue
        variance = gravity_scatter(later.turned, later)
        words = f"{abs(lag_s):g} s {'later' if lag_s > 0.0 else 'earlier'} than its time stamps say"
        yield _Explanation(words, variance, log_likelihood(variance, later))


def _other_axes(windows: GravityWindows) -> Iterator[tuple[str, Array]]:
    """Compute the movement of gravity (k,) for each other order and sign of the gyroscope's axes.

    For a proper rotation P, rates P w turn vectors as rates w turn the vectors P' f and P after them. All proper ones
    therefore need one integration, whose means are kept for each pair of components; the improper ones, which are
    left-handed, need a second one with the opposite sign.
    """
    for sign in (1.0, -1.0):
        turned = turned_by(sign * windows.rate_radps, windows.period_s)
        pairs = hann_means(turned[..., None] * windows.force_mps2[:, :, None, None, :], windows.period_s)
        for order in itertools.permutations(range(3)):
            for signs in itertools.product((1.0, -1.0), repeat=3):
                axes = np.zeros((3, 3))
                axes[range(3), order] = signs
                proper = sign * axes
                if np.linalg.det(proper) < 0.0 or (axes == np.eye(3)).all():
                    continue
                names = ", ".join(f"{'-' if s < 0.0 else ''}{_AXES[k]}" for k, s in zip(order, signs, strict=True))
                means = np.einsum("kmabc,cb->kma", pairs, proper)
                yield f"with axes ({names})", scatter(means)
