"""Devices that begin to record late: another device, the donor, provides the steps that lead to their start.

Taken by itself, such a device would begin where the walk began. That is wrong by everything that was walked before,
and tethers would draw the other devices back there. It therefore takes over the steps of a device that recorded at
that time. Their errors are treated as independent of the donor's, like those of any two devices that count the same
steps. This method is our own.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.estimators.common.initial_state import SIGMA_INITIAL_HEADING_RAD
from pdr_est.frames import wrap_angle
from pdr_est.types.measurements import DeviceMeasurements, StepOdometry
from pdr_est.types.track import Track

_SIGMA_POSITION_M = 0.2  # the pace within a step is not known
_SAME_STEP_S = 0.3  # steps of two devices that end within this time may be the same step


def extend_late_devices(devices: Sequence[DeviceMeasurements], late_s: float) -> list[DeviceMeasurements]:
    """Extend the measurements of late devices back to the start of the walk.

    Parameters
    ----------
    devices
        Measurements of each device.
    late_s
        A device that begins this much later than the first one is extended. It stays as it is if no other device
        recorded at its start.

    Returns
    -------
    list of DeviceMeasurements
        The devices in their order; those that are not extended are the same objects.
    """
    first_s = min((one.start_s for one in devices), default=0.0)
    complete: dict[str, DeviceMeasurements] = {}
    for one in sorted(devices, key=lambda device: (device.start_s, device.device)):
        donor = _donor(list(complete.values()), one.start_s) if one.start_s - first_s > late_s else None
        complete[one.device] = one if donor is None else _extended(one, donor)
    return [complete[one.device] for one in devices]


def without_extension(
    track: Track, devices: Sequence[DeviceMeasurements], extended: Sequence[DeviceMeasurements]
) -> Track:
    """Remove from a track the poses before the own start of late devices.

    Parameters
    ----------
    track
        Track of the extended devices.
    devices, extended
        Measurements before and after `extend_late_devices`.
    """
    late_s = {one.device: one.start_s for one, whole in zip(devices, extended, strict=True) if whole is not one}
    begin_s = np.array([late_s.get(str(name), -np.inf) for name in track.device])
    own = track.rows_where(track.time_s >= begin_s)
    begins = np.isin(own.time_s, list(late_s.values())) & np.isin(own.device, list(late_s))
    return replace(
        own,
        step_length_m=np.where(begins, 0.0, own.step_length_m),
        moving_from_s=np.where(begins, own.time_s, own.moving_from_s),
    )


def _donor(earlier: Sequence[DeviceMeasurements], start_s: float) -> DeviceMeasurements | None:
    """Choose the first device that still makes steps after a time."""
    return next((one for one in earlier if any(step.time_s > start_s for step in _steps(one))), None)


def _extended(one: DeviceMeasurements, donor: DeviceMeasurements) -> DeviceMeasurements:
    """Put the donor's steps up to the start of a late device before its own measurements."""
    own, of_donor = _steps(one), _steps(donor)
    before = [replace(step, device=one.device) for step in of_donor if step.time_s < one.start_s]
    under_way = next(step for step in of_donor if step.time_s >= one.start_s)
    first_s = own[0].time_s if own else one.start_s
    turns_rad = [step.heading_change_rad for step in of_donor if one.start_s <= step.time_s <= first_s + _SAME_STEP_S]
    begin_s = before[-1].time_s if before else donor.start_s
    moving_s = max(under_way.start_s, begin_s)
    share = (one.start_s - moving_s) / (under_way.time_s - moving_s) if one.start_s > moving_s else 0.0
    arrival = StepOdometry(
        device=one.device,
        time_s=one.start_s,
        start_s=begin_s,
        length_m=share * under_way.length_m,
        heading_change_rad=float(wrap_angle(sum(turns_rad))),
        covariance=np.diag([_SIGMA_POSITION_M, _SIGMA_POSITION_M, SIGMA_INITIAL_HEADING_RAD]) ** 2,
        mode=own[0].mode if own else under_way.mode,
        observed=False,
    )
    # A detector may put the first step back to before the first sample.
    after = [m for m in one.measurements if not (isinstance(m, StepOdometry) and m.time_s <= one.start_s)]
    return DeviceMeasurements(one.device, donor.start_s, (*before, arrival, *after))


def _steps(one: DeviceMeasurements) -> list[StepOdometry]:
    return [m for m in one.measurements if isinstance(m, StepOdometry) and m.device == one.device]
