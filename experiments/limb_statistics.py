"""How arms and thighs move a phone: statistics of steady walking by which simulated limbs are held against real ones.

All of them are medians over windows of `WINDOW_S` in which the phone moves as in walking, so that turns of the walker
and pauses do not matter. None needs to know how the phone lies in the hand or in the pocket.
"""

from collections.abc import Iterator

import numpy as np
from scipy.signal import butter, sosfiltfilt

from pdr_est.frames import Array

WINDOW_S = 5.0
LEAST_MPS2 = 1.0  # root mean square of the acceleration of a walk
HARMONICS = 4
STRIDE_HZ = np.arange(0.62, 1.31, 0.01)


def arm_harmonics(level_mps2: Array, rate_hz: float) -> tuple[float, float, float]:
    """Measure the swing of an arm.

    Parameters
    ----------
    level_mps2 : ndarray, shape (n, 3)
        Acceleration without gravity, two level axes and up.
    rate_hz : float
        Sampling rate.

    Returns
    -------
    tuple of float
        Amplitude of the forward acceleration once a stride, m/s^2, forward being the direction in which that is
        greatest; the ratio of the amplitude twice a stride to it; the amplitude of the vertical acceleration twice a
        stride, m/s^2.
    """
    found = []
    for window in _windows(level_mps2, rate_hz):
        spectrum = _stride_spectrum(window, rate_hz)
        first = spectrum[0, :2]
        forward = np.linalg.eigh(np.real(np.outer(first, first.conj())))[1][:, -1]
        once, twice = np.abs(spectrum[:2, :2] @ forward)
        found.append((once, twice / once, np.abs(spectrum[1, 2])))
    if not found:
        return np.nan, np.nan, np.nan
    first, ratio, bounce = np.median(found, axis=0).tolist()
    return first, ratio, bounce


def kept_turn(up: Array, acceleration_mps2: Array, rate_hz: float) -> float:
    """Measure which share of a turn a gyroscope sees about the phone's mean vertical: the mean cosine of its tilt.

    Parameters
    ----------
    up : ndarray, shape (n, 3)
        Unit vector upwards in device axes.
    acceleration_mps2 : ndarray, shape (n, 3)
        Acceleration without gravity, which tells where the phone is carried in a walk.
    rate_hz : float
        Sampling rate.
    """
    found = []
    for window in _windows(np.hstack([acceleration_mps2, up]), rate_hz):
        found.append(float(np.linalg.norm(window[:, 3:].mean(axis=0))))
    return float(np.median(found)) if found else np.nan


def swing_axes(up: Array, acceleration_mps2: Array, rate_hz: float) -> Array:
    """Find the axes in which a swinging phone would lie in the hand as in MMPDR, Fig. 1(c).

    Returns
    -------
    ndarray, shape (3, 3)
        Unit vectors x, y, z as rows, in device axes: x up at the mean, y along the swing.
    """
    mean = up.mean(axis=0)
    x = mean / np.linalg.norm(mean)
    band = sosfiltfilt(butter(2, [0.6, 1.4], "bandpass", fs=rate_hz, output="sos"), acceleration_mps2, axis=0)
    level = band - np.outer(band @ x, x)
    y = np.linalg.eigh(level.T @ level)[1][:, -1]
    return np.stack([x, y, np.cross(x, y)])


def _windows(signals: Array, rate_hz: float) -> Iterator[Array]:
    """Cut signals (n, k) into windows, and leave out those whose first three are not those of a walk."""
    size = int(WINDOW_S * rate_hz)
    for start in range(0, len(signals) - size + 1, size):
        window = signals[start : start + size]
        if np.sqrt((window[:, :3] ** 2).sum(axis=1).mean()) > LEAST_MPS2:
            yield window


def _stride_spectrum(window: Array, rate_hz: float) -> Array:
    """Fit the harmonics of the stride (HARMONICS, axes), complex, at the stride frequency that fits best."""
    fits = [_fit(window, frequency, rate_hz) for frequency in STRIDE_HZ]
    return min(fits, key=lambda fit: fit[1])[0]


def _fit(window: Array, frequency: float, rate_hz: float) -> tuple[Array, float]:
    """Fit harmonics of one stride frequency by least squares; return them and the squared residual."""
    angle = 2.0 * np.pi * frequency / rate_hz * np.outer(np.arange(len(window)), np.arange(1, HARMONICS + 1))
    columns = np.hstack([np.ones((len(window), 1)), np.cos(angle), np.sin(angle)])
    solution = np.linalg.lstsq(columns, window, rcond=None)[0]
    cosine, sine = solution[1 : HARMONICS + 1], solution[HARMONICS + 1 :]
    return cosine - 1j * sine, float(((window - columns @ solution) ** 2).sum())
