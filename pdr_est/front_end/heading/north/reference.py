"""Choose the source of north for a device, and find the declination at its place."""

from dataclasses import dataclass
from typing import Literal

from pdr_est.front_end.heading.north.declination import SIGMA_MODEL_RAD, magnetic_declination
from pdr_est.front_end.heading.north.params import NorthParams
from pdr_est.types.recording import DeviceRecording, GeoOrigin
from pdr_est.types.sensors import AttitudeReference, Channel


@dataclass(frozen=True)
class NorthReference:
    """Source of the direction of north for one device.

    Attributes
    ----------
    source
        "device" for the recorded attitude, "magnetometer" for the recorded field.
    declination_rad
        Angle from true north to the north of the source, rad, clockwise.
    sigma_declination_rad
        Its standard deviation, rad.
    usual_axes
        True if the axes of the device are those that phones have: the second to the top of the screen, the third out
        of it.
    """

    source: Literal["device", "magnetometer"]
    declination_rad: float = 0.0
    sigma_declination_rad: float = 0.0
    usual_axes: bool = True

    @property
    def channel(self) -> Channel:
        """Return the channel that the source needs."""
        return Channel.ATTITUDE if self.source == "device" else Channel.MAGNETIC_FIELD


def north_reference(
    device: DeviceRecording, origin: GeoOrigin | None, epoch_s: float | None, parameters: NorthParams
) -> NorthReference | None:
    """Choose the source of north for a device, and find the declination.

    Parameters
    ----------
    device
        The recording of the device.
    origin
        Origin of the map frame; None where the place is not known, and the declination neither.
    epoch_s
        Unix time of time zero, s, or None.
    parameters
        Choice of the source.

    Returns
    -------
    NorthReference or None
        None where the source was not recorded, where it is not known what its yaw counts from, or for "none".
    """
    by_device = device.attitude is not None and device.attitude_reference.is_north
    if by_device and parameters.source in ("auto", "device"):
        if device.attitude_reference is AttitudeReference.TRUE_NORTH:
            return NorthReference("device", 0.0, SIGMA_MODEL_RAD, device.usual_axes)
        return NorthReference("device", *_declination(origin, epoch_s, parameters), device.usual_axes)
    if device.magnetic_field is not None and parameters.source in ("auto", "magnetometer"):
        return NorthReference("magnetometer", *_declination(origin, epoch_s, parameters), device.usual_axes)
    return None


def _declination(origin: GeoOrigin | None, epoch_s: float | None, parameters: NorthParams) -> tuple[float, float]:
    if origin is None:
        return 0.0, parameters.sigma_declination_rad
    return magnetic_declination(origin.latitude_deg, origin.longitude_deg, epoch_s)
