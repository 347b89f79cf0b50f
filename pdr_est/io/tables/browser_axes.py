"""Settle the order of `rotationRate.alpha, beta, gamma`: browsers and systems do not agree which axes these are.

The old text of the standard turns alpha about z, beta about x and gamma about y; some browsers and React Native on
iOS count x, y, z instead. Gravity, turned by the gyroscope, must stay where the accelerometer sees it: that decides.
"""

from dataclasses import replace

from pdr_est.frames import Array
from pdr_est.io.conversion.gravity_drift import gravity_scatter, log_likelihood
from pdr_est.io.conversion.gravity_windows import gravity_windows, turned_by
from pdr_est.types.recording import DeviceRecording, Signal

_DECISIVE = 4.6  # log of the odds 99 : 1
_AS_XYZ = (2, 0, 1)  # columns of alpha, beta, gamma among those that were read as x, y, z


def settle_browser_axes(device: DeviceRecording) -> DeviceRecording:
    """Return a device whose gyroscope has the order of axes that gravity confirms.

    Parameters
    ----------
    device
        Device whose rotation rate was read with alpha about z, beta about x, gamma about y.
    """
    force, rate = device.specific_force, device.rotation_rate
    if force is None or rate is None:
        return device
    windows = gravity_windows(force, rate)
    if windows is None:
        return _told(device, rate, "alpha is taken as the rotation about z; the recording is too short to confirm it")

    def fit(rate_radps: Array) -> float:
        return log_likelihood(gravity_scatter(turned_by(rate_radps, windows.period_s), windows), windows)

    gain = fit(windows.rate_radps[..., _AS_XYZ]) - fit(windows.rate_radps)
    if gain > _DECISIVE:
        turned = Signal(rate.time_s, rate.values[:, _AS_XYZ])
        decision = "alpha, beta, gamma turn about x, y, z, because gravity then stays where the accelerometer sees it"
        return replace(device, rotation_rate=turned, decisions=(*device.decisions, decision))
    if gain < -_DECISIVE:
        decision = "alpha, beta, gamma turn about z, x, y, because gravity then stays where the accelerometer sees it"
        return replace(device, decisions=(*device.decisions, decision))
    return _told(device, rate, "whether alpha turns about z or x is not certain: z is taken; state it with --map")


def _told(device: DeviceRecording, rate: Signal, warning: str) -> DeviceRecording:
    return replace(device, rotation_rate=rate, warnings=(*device.warnings, warning))
