"""A device that began to record while the walk was under way: what led to its start is told by another device.

Taken by itself such a device would begin where the walk began, which is wrong by all that was walked before, and
would drag the devices that it is tied to back there. It borrows the steps of one that recorded then. Their errors are
taken for independent of the lender's, as those of two devices that count the same steps are anyway. All this is ours.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.estimators.common.tethers import SIGMA_SET_OFF_RAD
from pdr_est.frames import wrap_angle
from pdr_est.types.measurements import DeviceMeasurements, StepOdometry
from pdr_est.types.track import Track

_SIGMA_PLACE_M = 0.2  # within a step the pace is not known
_NEAR_S = 0.3  # steps of two devices that end no further apart may be the same one


def with_way_to_start(devices: Sequence[DeviceMeasurements], late_s: float) -> list[DeviceMeasurements]:
    """The devices, in their order, each beginning at the start of the walk.

    late_s: a device that begins that long after the first one borrows the way to its own start. One that nobody
    recorded with at its start stays as it is.
    """
    first_s = min((one.start_s for one in devices), default=0.0)
    complete: dict[str, DeviceMeasurements] = {}
    for one in sorted(devices, key=lambda device: device.start_s):
        donor = _lender(list(complete.values()), one.start_s) if one.start_s - first_s > late_s else None
        complete[one.device] = one if donor is None else _led(one, donor)
    return [complete[one.device] for one in devices]


def from_own_start(
    track: Track, devices: Sequence[DeviceMeasurements], extended: Sequence[DeviceMeasurements]
) -> Track:
    """The track without what was borrowed. devices, led: as they were before and after `with_way_to_start`."""
    late_s = {one.device: one.start_s for one, whole in zip(devices, extended, strict=True) if whole is not one}
    begin_s = np.array([late_s.get(str(name), -np.inf) for name in track.device])
    own = track.rows_where(track.time_s >= begin_s)
    begins = np.isin(own.time_s, list(late_s.values())) & np.isin(own.device, list(late_s))
    return replace(
        own,
        step_length_m=np.where(begins, 0.0, own.step_length_m),
        moving_from_s=np.where(begins, own.time_s, own.moving_from_s),
    )


def _lender(earlier: Sequence[DeviceMeasurements], start_s: float) -> DeviceMeasurements | None:
    """Of the devices that made steps before and after a time, the one that began first."""
    return next((one for one in earlier if any(step.time_s > start_s for step in _steps(one))), None)


def _led(one: DeviceMeasurements, donor: DeviceMeasurements) -> DeviceMeasurements:
    own, lent = _steps(one), _steps(donor)
    before = [replace(step, device=one.device) for step in lent if step.time_s < one.start_s]
    under_way = next(step for step in lent if step.time_s >= one.start_s)
    first_s = own[0].time_s if own else one.start_s
    turns_rad = [step.heading_change_rad for step in lent if one.start_s <= step.time_s <= first_s + _NEAR_S]
    begin_s = before[-1].time_s if before else donor.start_s
    moving_s = max(under_way.start_s, begin_s)
    share = (one.start_s - moving_s) / (under_way.time_s - moving_s) if one.start_s > moving_s else 0.0
    arrival = StepOdometry(
        device=one.device,
        time_s=one.start_s,
        start_s=begin_s,
        length_m=share * under_way.length_m,
        heading_change_rad=float(wrap_angle(sum(turns_rad))),
        covariance=np.diag([_SIGMA_PLACE_M, _SIGMA_PLACE_M, SIGMA_SET_OFF_RAD]) ** 2,
        mode=own[0].mode if own else under_way.mode,
        observed=False,
    )
    # A detector may put the first step back to before the first sample.
    after = [m for m in one.measurements if not (isinstance(m, StepOdometry) and m.time_s <= one.start_s)]
    return DeviceMeasurements(one.device, donor.start_s, (*before, arrival, *after))


def _steps(one: DeviceMeasurements) -> list[StepOdometry]:
    return [m for m in one.measurements if isinstance(m, StepOdometry) and m.device == one.device]
