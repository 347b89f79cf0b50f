"""A walk over several floors, by stairs and by lift, with a phone that records the air pressure."""

from pdr_est.simulate.riding.riding_body import Ride
from pdr_est.simulate.riding.vehicles import lift
from pdr_est.simulate.scenario import DeviceParams, Scenario
from pdr_est.simulate.sensors.sensor_errors import PHONE_BAROMETER, SensorParams
from pdr_est.simulate.walker.gait_stretches import StairStretch
from pdr_est.simulate.walker.step_schedule import Pause, WalkerGaitParams
from pdr_est.simulate.walker.walking_path import PathParams

_TREADS, _TREAD_M, _RISE_M = 20, 0.29, 0.175  # a storey of 3.5 m
_UP_AT_M, _DOWN_AT_M = 40.0, 120.0


def walk_over_floors(ride_s: float = 20.0) -> Scenario:
    """Make a walk that climbs a storey on stairs, takes a lift farther up, and goes down stairs again.

    Parameters
    ----------
    ride_s : float
        Time in the lift, s.
    """
    length_m = _TREADS * _TREAD_M
    stairs = (
        StairStretch(from_m=_UP_AT_M, to_m=_UP_AT_M + length_m, direction="up", tread_m=_TREAD_M, rise_m=_RISE_M),
        StairStretch(
            from_m=_DOWN_AT_M, to_m=_DOWN_AT_M + length_m, direction="down", tread_m=_TREAD_M, rise_m=_RISE_M
        ),
    )
    return Scenario(
        name="floors",
        path=PathParams(vertices_m=((0.0, 0.0), (60.0, 0.0), (60.0, 40.0), (0.0, 40.0))),
        gait=WalkerGaitParams(stretches=stairs, pauses=(Pause(at_m=80.0, duration_s=ride_s),)),
        devices=(DeviceParams(sensors=SensorParams(barometer=PHONE_BAROMETER)),),
        rides=(Ride(pause=0, vehicle=lift()),),
    )
