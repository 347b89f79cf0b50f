"""What the tests of carried phones share: integrating ideal sensors, and looking at a walk in parts."""

import numpy as np
from scipy.integrate import cumulative_simpson
from scipy.signal import welch
from scipy.spatial.transform import Rotation

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.simulate import DeviceParams, PathParams, Pause, Scenario, SensorParams, SimulatedWalk, WalkerGaitParams
from pdr_est.simulate import simulate_walk as _simulate
from pdr_est.simulate.motion.rigid_body import RigidMotion

CADENCE_HZ = 1.8
STRAIGHT = PathParams(vertices_m=((0.0, 0.0), (60.0, 0.0)))
TURNS = PathParams(vertices_m=((0.0, 0.0), (8.0, 0.0), (8.0, 6.0), (14.0, 9.0)))


def walk_with(device: DeviceParams, path: PathParams = STRAIGHT, **gait: object) -> SimulatedWalk:
    """A walk with one device, at the usual cadence."""
    return _simulate(
        Scenario(path=path, gait=WalkerGaitParams(cadence_hz=CADENCE_HZ, **gait), devices=(device,), seed=5)
    )  # type: ignore[arg-type]


def finely_walked(device: DeviceParams) -> RigidMotion:
    """The motion at 500 Hz on a path with turns and a pause, for tests of physics."""
    pause = Pause(at_m=10.0, duration_s=2.0)
    fine = DeviceParams(carry=device.carry, changes=device.changes, sensors=SensorParams(rate_hz=500.0))
    return walk_with(fine, TURNS, pauses=(pause,)).devices[0].motion


def orientation_error_rad(motion: RigidMotion) -> Array:
    """How far each attitude is from the one before it turned on by the gyroscope."""
    rate, step_s = motion.rotation_rate_radps, float(motion.time_s[1] - motion.time_s[0])
    orientation = Rotation.from_quat(motion.quaternion, scalar_first=True)
    turned = orientation[:-1] * Rotation.from_rotvec(0.5 * step_s * (rate[1:] + rate[:-1]))
    error: Array = (orientation[1:].inv() * turned).magnitude()
    return error


def twice_integrated(motion: RigidMotion) -> Array:
    """Positions (n, 3) from the accelerometer, the true orientation, and the true start."""
    step_s = float(motion.time_s[1] - motion.time_s[0])
    orientation = Rotation.from_quat(motion.quaternion, scalar_first=True)
    acceleration = orientation.apply(motion.specific_force_mps2) - [0.0, 0.0, STANDARD_GRAVITY_MPS2]
    start = [motion.east.rate[0], motion.north.rate[0], motion.up.rate[0]]
    velocity = start + cumulative_simpson(acceleration, dx=step_s, axis=0, initial=0.0)
    position: Array = motion.position_m[0] + cumulative_simpson(velocity, dx=step_s, axis=0, initial=0.0)
    return position


def walking_part(walk: SimulatedWalk) -> slice:
    """Samples of the first device from the third step to the third last one."""
    time_s = walk.devices[0].motion.time_s
    first, last = np.searchsorted(time_s, walk.steps.time_s[[2, -3]])
    return slice(int(first), int(last))


def strongest_hz(signal: Array, rate_hz: float = 100.0) -> float:
    """Frequency of the highest peak of the spectrum."""
    frequency, power = welch(signal, fs=rate_hz, nperseg=min(len(signal), 2048))
    return float(frequency[np.argmax(power)])


def up_in(motion: RigidMotion) -> Array:
    """Unit vector up in device axes (n, 3)."""
    return motion.in_device(np.array([0.0, 0.0, 1.0]))
