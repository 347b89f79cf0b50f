"""Pedestrian dead reckoning: tracks with honest uncertainty from the inertial recordings of phones.

    import pdr_est

    recording = pdr_est.read("demo-out/simulated-walk.csv")
    track = pdr_est.smooth(recording)
    track.to_csv("my-track.csv")
    print(track.position_m[-1], track.covariance_m2[-1])

Everything that a user needs is a name of this package. The modules below hold the parts; see `docs/`.

From recording to track
-----------------------
A **recording** holds the raw samples of one or several **devices** (phones) of one walk. The **front end** processes
each device by a chain of **stages**: resampling to a uniform rate, attitude, carrying mode, step detection, gait,
step length, heading, odometry. It emits **measurements**. An **estimator** computes a **track** from them: a pose
with covariance at the end of every step.

Types
-----
- Recording: signals of all devices of one walk, as `read` returns it or `Recording.from_arrays` makes it.
- Step: a detected step with carrying mode, gait, length and heading.
- StepOdometry: length and heading change of one step, with their covariance.
- HeadingPrior: heading of a device at one time, in the map or relative to an unknown direction.
- PositionFix: known position with covariance, such as GPS or a surveyed point.
- DeviceTether: upper bound on the distance between two devices on one body.
- LoopClosure: the walk ends where it began.
- FloorPlan: walkable areas and walls of a floor, as `read_floor_plan` returns it.
- BuildingPlan: the plans of several floors, as `read_building_plan` returns them. PresentFloor: the floor that the
  walker is on from a time.
- StartPose: position and heading at the start, as far as they are known.
- DeviceMeasurements: all measurements of one device.
- Track: result of an estimator. *Filtered* poses use the past only, *smoothed* poses use the whole walk, *delayed*
  poses use the past and a fixed time after it. The device "fused" is the person, from all devices. Its `findings`
  tell what does not fit.
- PlaceSearch: where on its floor plan a walk was whose start is not known: `Track.places`.
- PoseRegion: the places where the walker may be at each pose, where one ellipse does not say it: `Track.region`.
- Finding: something about a walk that does not fit, such as a position fix that disagrees with the steps; its
  `FindingKind` is what it is about.
- Config: all settings; frozen, validated, with a default for each.
- Profile: the own step length of a walker, which `learn` finds in walks with fixes or of known length.
  `apply_profile` puts it into a Config, `save_profile` and `load_profile` keep it in a file.
- Parts: stages and an estimator of your own, in place of those of the library. `Estimator` is the contract of an
  estimator and `EstimatorSpec` states its abilities.
- WalkGraph: the GTSAM factor graph of a walk, made by `build_graph`, to which you can add factors of your own.
- Tracker: the same pipeline online, fed with `SensorBlock` while the phones record.

Words
-----
- step, stride: from one foot contact to the next of the other foot; two steps.
- segment: part of a recording without a gap.
- carrying mode: HOLDING (in front of the body), SWING (swinging hand), POCKET, OTHER, TRANS (between two).
- heading: direction in which the person walks. It is not the yaw of the phone.
- dominant directions: the few directions, at equal angles, that the corridors of a building follow.
- fix, tether, prior: see PositionFix, DeviceTether, HeadingPrior.

Frames
------
- device: as on Android, x to the right, y up along the screen, z out of the screen.
- level: z up; the yaw about it has an arbitrary zero.
- map: x east, y north, origin as the recording or the user gives it.
- own: like the map frame, but with the origin at the start of the walk and the first step along x; used where neither
  a start nor fixes are known.

Headings count counter-clockwise from east. Quaternions have w first and rotate from device to level or map.

Units and names
---------------
SI units: seconds, metres, radians, hertz; magnetic field in µT. Names end in their unit where a reader could doubt
it: ``length_m``, ``heading_rad``, ``rate_hz``, ``acceleration_mps2``, ``covariance_m2``. ``sigma_x`` is the standard
deviation of ``x``. ``time_s`` counts on the clock of the recording. ``(n, 3)`` in a docstring is the shape of an
array, n samples or poses long. Specific force is the accelerometer signal including gravity; it points up when a
device lies still.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pdr_est.calibration.learning import learn
    from pdr_est.calibration.profile import Profile, apply_profile
    from pdr_est.calibration.profile_file import load_profile, save_profile
    from pdr_est.config import Config, load_config
    from pdr_est.errors import ConfigError, EstimationError, FloorPlanError, OutputError, PdrError, RecordingError
    from pdr_est.estimators.factor_graph.build import WalkGraph, build_graph
    from pdr_est.estimators.spec import Estimator, EstimatorSpec
    from pdr_est.io.floor_plans.building import read_building_plan
    from pdr_est.io.floor_plans.reading import read_floor_plan
    from pdr_est.io.formats.registry import read
    from pdr_est.online import Tracker
    from pdr_est.parts import Parts
    from pdr_est.preprocessing.merge import merge_recordings
    from pdr_est.public_api import analyse, detect_steps, estimate, smooth
    from pdr_est.types.analysis import DeviceWalk
    from pdr_est.types.findings import Finding, FindingKind
    from pdr_est.types.floor_plan import BuildingPlan, FloorPlan, PresentFloor, WalkableArea
    from pdr_est.types.measurements import (
        DeviceMeasurements,
        DeviceTether,
        HeadingPrior,
        LoopClosure,
        PositionFix,
        StartPose,
        StepOdometry,
    )
    from pdr_est.types.on_plan.places import PlaceSearch
    from pdr_est.types.recording import DeviceRecording, Recording, Signal
    from pdr_est.types.region import PoseRegion
    from pdr_est.types.sensors import Channel, SensorBlock
    from pdr_est.types.steps import CarryingMode, Step
    from pdr_est.types.track import Track

__version__: str

__all__ = [
    "BuildingPlan",
    "CarryingMode",
    "Channel",
    "Config",
    "ConfigError",
    "DeviceMeasurements",
    "DeviceRecording",
    "DeviceTether",
    "DeviceWalk",
    "EstimationError",
    "Estimator",
    "EstimatorSpec",
    "Finding",
    "FindingKind",
    "FloorPlan",
    "FloorPlanError",
    "HeadingPrior",
    "LoopClosure",
    "OutputError",
    "Parts",
    "PdrError",
    "PlaceSearch",
    "PoseRegion",
    "PositionFix",
    "PresentFloor",
    "Profile",
    "Recording",
    "RecordingError",
    "SensorBlock",
    "Signal",
    "StartPose",
    "Step",
    "StepOdometry",
    "Track",
    "Tracker",
    "WalkGraph",
    "WalkableArea",
    "__version__",
    "analyse",
    "apply_profile",
    "build_graph",
    "detect_steps",
    "estimate",
    "learn",
    "load_config",
    "load_profile",
    "merge_recordings",
    "read",
    "read_building_plan",
    "read_floor_plan",
    "save_profile",
    "smooth",
]

_MODULES = {
    "pdr_est.calibration.learning": ("learn",),
    "pdr_est.calibration.profile": ("Profile", "apply_profile"),
    "pdr_est.calibration.profile_file": ("load_profile", "save_profile"),
    "pdr_est.config": ("Config", "load_config"),
    "pdr_est.estimators.factor_graph.build": ("WalkGraph", "build_graph"),
    "pdr_est.estimators.spec": ("Estimator", "EstimatorSpec"),
    "pdr_est.errors": (
        "ConfigError",
        "EstimationError",
        "FloorPlanError",
        "OutputError",
        "PdrError",
        "RecordingError",
    ),
    "pdr_est.io.floor_plans.building": ("read_building_plan",),
    "pdr_est.io.floor_plans.reading": ("read_floor_plan",),
    "pdr_est.io.formats.registry": ("read",),
    "pdr_est.online": ("Tracker",),
    "pdr_est.parts": ("Parts",),
    "pdr_est.preprocessing.merge": ("merge_recordings",),
    "pdr_est.public_api": ("analyse", "detect_steps", "estimate", "smooth"),
    "pdr_est.types.analysis": ("DeviceWalk",),
    "pdr_est.types.findings": ("Finding", "FindingKind"),
    "pdr_est.types.floor_plan": ("BuildingPlan", "FloorPlan", "PresentFloor", "WalkableArea"),
    "pdr_est.types.measurements": (
        "DeviceMeasurements",
        "DeviceTether",
        "HeadingPrior",
        "LoopClosure",
        "PositionFix",
        "StartPose",
        "StepOdometry",
    ),
    "pdr_est.types.recording": ("DeviceRecording", "Recording", "Signal"),
    "pdr_est.types.on_plan.places": ("PlaceSearch",),
    "pdr_est.types.region": ("PoseRegion",),
    "pdr_est.types.sensors": ("Channel", "SensorBlock"),
    "pdr_est.types.steps": ("CarryingMode", "Step"),
    "pdr_est.types.track": ("Track",),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> Any:
    """Import a public name at its first use: the libraries behind it take seconds, during which Ctrl-C must work."""
    if name == "__version__":
        globals()[name] = _version()
        return globals()[name]
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'pdr_est' has no attribute {name!r}: its names are {', '.join(__all__)}")
    value = getattr(import_module(_MODULE_OF[name]), name)
    globals()[name] = value
    return value


def _version() -> str:
    from importlib.metadata import (
        PackageNotFoundError,
        version,
    )  # takes as long to load as all that a help text needs

    try:
        return version("pdr-est")
    except PackageNotFoundError:  # run from a source tree that is not installed
        return "0+unknown"


def __dir__() -> list[str]:
    """List the public names, whether or not they have been imported yet."""
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
