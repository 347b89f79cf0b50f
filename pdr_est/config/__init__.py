"""The configuration: one frozen record that nests the parameters of every stage, YAML in and out."""

from dataclasses import asdict, replace
from math import degrees
from pathlib import Path
from typing import Annotated, Any

import yaml
from annotated_types import Ge, Le
from pydantic import TypeAdapter, ValidationError

from pdr_est.clock_sync import ClockMethod, GivenClock
from pdr_est.config.messages import explain
from pdr_est.config.yaml_lines import Lines, Location, load_yaml_lines
from pdr_est.errors import ConfigError
from pdr_est.estimators import EstimatorName
from pdr_est.estimators.common.tethers import TetherParams
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.estimators.robust_dr.fusion import MapFusionParams
from pdr_est.front_end.attitude import AttitudeParams
from pdr_est.front_end.gait import GaitParams, gait_model
from pdr_est.front_end.heading import HeadingParams
from pdr_est.front_end.mode import ModeParams
from pdr_est.front_end.odometry import OdometryParams
from pdr_est.front_end.step_length import StepLengthParams, WalkerParams
from pdr_est.front_end.steps import StepsParams, step_detector
from pdr_est.params import NonNegative, Positive, params
from pdr_est.preprocessing.resampling import ResampleParams
from pdr_est.types.measurements import StartPose

Coordinate = Annotated[float, Ge(-1e8), Le(1e8)]  # also UTM's, which reach 1e7 m
Reach = Annotated[float, Ge(-2.0), Le(2.0)]
Turn = Annotated[float, Ge(-6.3), Le(6.3)]


@params
class StartParams:
    """Start pose in the map frame; null means unknown. heading_rad counter-clockwise from east. closed: whether the
    walk ends where it began, to sigma_closed_m."""

    x_m: Coordinate | None = None
    y_m: Coordinate | None = None
    heading_rad: Turn | None = None
    sigma_position_m: NonNegative = 0.5
    sigma_heading_rad: NonNegative = 0.1
    closed: bool = False
    sigma_closed_m: Positive = 0.5

    def pose(self) -> StartPose:
        """The start pose. Raises ConfigError when only one of x_m and y_m is given."""
        if (self.x_m is None) != (self.y_m is None):
            raise ConfigError("start: x_m and y_m belong together: give both or none")
        position = None if self.x_m is None or self.y_m is None else (self.x_m, self.y_m)
        return StartPose(position, self.heading_rad, self.sigma_position_m, self.sigma_heading_rad)


@params
class EstimatorParams:
    """name: which estimator. map_fusion: of map-closed-form and map-general; fixed_lag: of fixed-lag."""

    name: EstimatorName = "factor-graph"
    map_fusion: MapFusionParams = MapFusionParams()
    fixed_lag: FixedLagParams = FixedLagParams()


@params
class Mounting:
    """Where a device sits on the body: forward and left of the centre of motion."""

    device: str
    forward_m: Reach = 0.0
    left_m: Reach = 0.0

    @property
    def offset_m(self) -> tuple[float, float]:
        """Forward and left."""
        return self.forward_m, self.left_m


@params
class DevicesParams:
    """Several devices on one body. clock: "walk" finds the clocks of the others against the first one's from what
    they recorded, "messages" from messages that they exchanged, "given" takes them from `clocks`, "none" takes the
    times as they are. mountings: of devices that sit elsewhere than in the centre."""

    clock: ClockMethod = "walk"
    clocks: tuple[GivenClock, ...] = ()
    tethered: bool = True
    tether: TetherParams = TetherParams()
    mountings: tuple[Mounting, ...] = ()

    def mounting_of(self, device: str) -> Mounting:
        return next((one for one in self.mountings if one.device == device), Mounting(device=device))


@params
class Config:
    """Everything that can be set, one section a stage, in the order of the walk through the system."""

    resample: ResampleParams = ResampleParams()
    attitude: AttitudeParams = AttitudeParams()
    mode: ModeParams = ModeParams()
    steps: StepsParams = StepsParams()
    gait: GaitParams = GaitParams()
    walker: WalkerParams = WalkerParams()
    step_length: StepLengthParams = StepLengthParams()
    heading: HeadingParams = HeadingParams()
    odometry: OdometryParams = OdometryParams()
    start: StartParams = StartParams()
    devices: DevicesParams = DevicesParams()
    estimator: EstimatorParams = EstimatorParams()

    def with_estimator(self, name: EstimatorName) -> "Config":
        """The same configuration with another estimator."""
        return replace(self, estimator=replace(self.estimator, name=name))


_ADAPTER = TypeAdapter(Config)


def load_config(path: str | Path, base: Config | None = None) -> Config:
    """Configuration from a YAML file; what the file leaves out is that of `base`, or keeps its default.

    Raises ConfigError that names the file, the line and the key, for damaged YAML, unknown keys and values out of
    range.
    """
    data, lines = load_yaml_lines(path)
    config = config_from_dict({} if data is None else data, str(path), lines)
    if base is None or data is None:
        return config if base is None else base
    return config_from_dict(merged(config_to_dict(base), data), str(path), lines)


def config_from_dict(data: Any, place: str, lines: Lines | None = None) -> Config:
    """Validated configuration from nested dictionaries. place: what to call it in error messages. lines: where its
    values stand in the file that place names.

    Raises ConfigError for unknown keys, values of the wrong type or out of range, and values that contradict
    each other.
    """
    known = Lines() if lines is None else lines
    _refuse_booleans(data, config_to_dict(Config()), place, known)
    try:
        config = _ADAPTER.validate_python(data)
    except ValidationError as error:
        raise ConfigError(f"{place}: {explain(error, Config, known)}") from error
    _refuse_contradictions(config, place, known)
    return config


def check(config: Config) -> None:
    """Raise ConfigError if a value of a configuration made in Python is of the wrong type or out of range."""
    config_from_dict(config_to_dict(config), "configuration")


def config_to_dict(config: Config) -> dict[str, Any]:
    """Nested plain dictionaries, ready for YAML or JSON."""
    return asdict(config)


def config_to_yaml(config: Config) -> str:
    """The whole configuration as YAML, which `load_config` reads back to the same record."""
    return str(yaml.safe_dump(config_to_dict(config), sort_keys=False))


def merged(base: dict[str, Any], over: dict[str, Any]) -> dict[str, Any]:
    """The base with what stands in `over`, section by section."""
    result = dict(base)
    for key, value in over.items():
        sections = isinstance(base.get(key), dict) and isinstance(value, dict)
        result[key] = merged(base[key], value) if sections else value
    return result


def _refuse_booleans(data: Any, defaults: Any, place: str, lines: Lines, section: Location = ()) -> None:
    """Validation would take true for 1; YAML also reads yes, no, on and off as booleans."""
    if not isinstance(data, dict) or not isinstance(defaults, dict):
        return
    for name in data.keys() & defaults.keys():
        key = (*section, name)
        if isinstance(data[name], bool) and not isinstance(defaults[name], bool):
            words = f"{'.'.join(map(str, key))} = {data[name]}: is true or false: give a number or a word"
            raise ConfigError(f"{place}: {lines.words(key)}{words}")
        _refuse_booleans(data[name], defaults[name], place, lines, key)


def _refuse_contradictions(config: Config, place: str, lines: Lines) -> None:
    """Raises ConfigError for settings that are in range one by one but not together."""
    try:
        config.start.pose()
    except ConfigError as error:
        raise ConfigError(f"{place}: {lines.words(('start',))}{error}") from error
    if config.start.closed and config.estimator.name not in ("ekf", "factor-graph"):
        raise ConfigError(
            f"{place}: {lines.words(('start', 'closed'))}start.closed: "
            f"{config.estimator.name} makes no use of a walk that ends where it began: choose "
            "the estimator factor-graph or ekf"
        )
    try:
        step_detector(config.resample.rate_hz, config.steps)
    except ConfigError as error:
        section = config.steps.detector.replace("-", "_")
        raise ConfigError(f"{place}: {lines.words(('steps', section))}steps.{section}: {error}") from error
    watched_s, compensated_s = config.mode.mmpdr.window_s, config.steps.mmpdr.transition_s
    if config.mode.method == config.steps.detector == "mmpdr" and watched_s != compensated_s:
        raise ConfigError(
            f"{place}: {lines.words(('mode', 'mmpdr', 'window_s'))}"
            f"mode.mmpdr.window_s = {watched_s:g} and steps.mmpdr.transition_s = {compensated_s:g} are both "
            "the length of a transition: give them one value"
        )
    if config.devices.clocks and config.devices.clock != "given":
        raise ConfigError(
            f"{place}: {lines.words(('devices', 'clocks'))}devices.clocks: devices.clock = {config.devices.clock} "
            "makes no use of clocks that are given: choose given (--clock given), or leave them out"
        )
    heading = config.heading
    gives_priors = heading.method == "auto" and heading.dominant.enabled and heading.use == "priors"
    if heading.dominant.direction_rad is not None and not gives_priors:
        raise ConfigError(
            f"{place}: {lines.words(('heading', 'dominant', 'direction_rad'))}"
            f"heading.dominant.direction_rad = {heading.dominant.direction_rad:g} (--corridors "
            f"{degrees(heading.dominant.direction_rad):g}): is a direction in the map, of which heading.method = "
            f"{heading.method} (--heading-method) with heading.use = {heading.use} and heading.dominant.enabled = "
            f"{str(heading.dominant.enabled).lower()} makes no use: choose auto, priors and true, or leave it out"
        )
    if config.gait.model is not None:
        try:
            gait_model(config.gait)
        except ConfigError as error:
            raise ConfigError(f"{place}: {lines.words(('gait', 'model'))}gait.model: {error}") from error
