"""Settle the axes of a rotation rate whose titles name angles, about which recorders do not agree.

The old text of the browsers' standard turns alpha about z, beta about x and gamma about y; some browsers and React
Native on iOS count x, y, z instead. Phones turn pitch about x and roll about y, vehicles the other way round.
Gravity, turned by the gyroscope, must stay where the accelerometer sees it: that decides.
"""

from collections.abc import Mapping
from dataclasses import replace

from pdr_est.frames import Array
from pdr_est.io.conversion.gravity_drift import gravity_scatter, log_likelihood
from pdr_est.io.conversion.gravity_windows import gravity_windows, turned_by
from pdr_est.types.recording import DeviceRecording, Signal

_DECISIVE = 4.6  # log of the odds 99 : 1
_WORDS: Mapping[tuple[int, ...], tuple[str, str, str]] = {
    (2, 0, 1): ("alpha, beta, gamma", "z, x, y", "x, y, z"),
    (1, 0, 2): ("pitch, roll", "x, y", "y, x"),
}
_REASON = "because gravity then stays where the accelerometer sees it"


def settle_angle_axes(device: DeviceRecording, other_order: tuple[int, ...]) -> DeviceRecording:
    """Return a device whose gyroscope has the order of axes that gravity confirms.

    Parameters
    ----------
    device
        Device whose rotation rate was read with alpha about z, beta about x, gamma about y, or pitch about x and roll
        about y.
    other_order
        Columns of that rotation rate that may be x, y and z instead.
    """
    angles, usual, other = _WORDS[other_order]
    force, rate = device.specific_force, device.rotation_rate
    if force is None or rate is None:
        return device
    windows = gravity_windows(force, rate)
    if windows is None:
        return _told(device, f"{angles} are taken to turn about {usual}; the recording is too short to confirm it")

    def fit(rate_radps: Array) -> float:
        return log_likelihood(gravity_scatter(turned_by(rate_radps, windows.period_s), windows), windows)

    gain = fit(windows.rate_radps[..., list(other_order)]) - fit(windows.rate_radps)
    if gain > _DECISIVE:
        turned = Signal(rate.time_s, rate.values[:, list(other_order)])
        decision = f"{angles} turn about {other}, {_REASON}"
        return replace(device, rotation_rate=turned, decisions=(*device.decisions, decision))
    if gain < -_DECISIVE:
        decision = f"{angles} turn about {usual}, {_REASON}"
        return replace(device, decisions=(*device.decisions, decision))
    return _told(
        device,
        f"whether {angles} turn about {usual} or {other} is not certain: {usual} is taken; state it with --map",
    )


def _told(device: DeviceRecording, warning: str) -> DeviceRecording:
    return replace(device, warnings=(*device.warnings, warning))
