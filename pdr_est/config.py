"""The configuration: one frozen record that nests the parameters of every stage, YAML in and out."""

import difflib
import reprlib
from collections.abc import Hashable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated, Any

import yaml
from annotated_types import Ge, Le
from pydantic import TypeAdapter, ValidationError
from pydantic_core import ErrorDetails

from pdr_est.errors import ConfigError
from pdr_est.estimators import EstimatorName
from pdr_est.front_end.attitude import AttitudeParams
from pdr_est.front_end.gait import GaitParams, gait_model
from pdr_est.front_end.heading import HeadingParams
from pdr_est.front_end.mode import ModeParams
from pdr_est.front_end.odometry import OdometryParams
from pdr_est.front_end.step_length import StepLengthParams, WalkerParams
from pdr_est.front_end.steps import StepsParams, step_detector
from pdr_est.io.resample import ResampleParams
from pdr_est.params import NonNegative, Positive, params
from pdr_est.records import StartPose

Coordinate = Annotated[float, Ge(-1e8), Le(1e8)]  # also UTM's, which reach 1e7 m
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
    """name: which estimator."""

    name: EstimatorName = "factor-graph"


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
    estimator: EstimatorParams = EstimatorParams()

    def with_estimator(self, name: EstimatorName) -> "Config":
        """The same configuration with another estimator."""
        return replace(self, estimator=EstimatorParams(name=name))


_ADAPTER = TypeAdapter(Config)
_MOST_ERRORS = 3  # told at once
_LONGEST_VALUE = 60  # characters of a value in a message
_UNIT_WORDS = {"_m": "metres", "_s": "seconds", "_hz": "hertz", "_rad": "radians", "_mps": "m/s", "_mps2": "m/s^2"}


def load_config(path: str | Path, base: Config | None = None) -> Config:
    """Configuration from a YAML file; what the file leaves out is that of `base`, or keeps its default.

    Raises ConfigError that names the file and the key, for damaged YAML, unknown keys and values out of range.
    """
    data = load_yaml(path)
    config = config_from_dict({} if data is None else data, str(path))
    if base is None or data is None:
        return config if base is None else base
    return config_from_dict(_merged(config_to_dict(base), data), str(path))


def load_yaml(path: str | Path) -> Any:
    """What a YAML file holds. Raises ConfigError that names the file, also for a key that stands twice."""
    try:
        return yaml.load(Path(path).read_text(encoding="utf-8-sig"), Loader=_StrictLoader)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read ({error.strerror}): check the path") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: is not UTF-8 text: save it as UTF-8 YAML") from error
    except yaml.MarkedYAMLError as error:
        line = "" if error.problem_mark is None else f", line {error.problem_mark.line + 1}"
        raise ConfigError(f"{path}{line}: is not valid YAML ({error.problem}): correct it") from error
    except (yaml.YAMLError, RecursionError) as error:
        raise ConfigError(f"{path}: is not valid YAML ({' '.join(str(error).split())}): correct it") from error


def config_from_dict(data: Any, place: str) -> Config:
    """Validated configuration from nested dictionaries. place: what to call it in error messages.

    Raises ConfigError for unknown keys, values of the wrong type or out of range, and values that contradict
    each other.
    """
    _refuse_booleans(data, config_to_dict(Config()), place)
    try:
        config = _ADAPTER.validate_python(data)
    except ValidationError as error:
        details = error.errors()
        words = [_explain(detail) for detail in details[:_MOST_ERRORS]]
        if len(details) > _MOST_ERRORS:
            words.append(f"and {len(details) - _MOST_ERRORS} more")
        raise ConfigError(f"{place}: {'; '.join(words)}") from error
    _refuse_contradictions(config, place)
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


class _StrictLoader(yaml.SafeLoader):
    """YAML in which a key that stands twice is an error: the first one would be lost without a word."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[str] = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                continue
            if key.value in seen:
                raise yaml.constructor.ConstructorError(None, None, f"{key.value!r} stands twice", key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep)


def _merged(base: dict[str, Any], over: dict[str, Any]) -> dict[str, Any]:
    """The base with what stands in `over`, section by section."""
    merged = dict(base)
    for key, value in over.items():
        merged[key] = _merged(base[key], value) if isinstance(base.get(key), dict) else value
    return merged


def _refuse_booleans(data: Any, defaults: Any, place: str, section: str = "") -> None:
    """Validation would take true for 1; YAML also reads yes, no, on and off as booleans."""
    if not isinstance(data, dict) or not isinstance(defaults, dict):
        return
    for name in data.keys() & defaults.keys():
        if isinstance(data[name], bool) and not isinstance(defaults[name], bool):
            raise ConfigError(f"{place}: {section}{name} = {data[name]}: is true or false: give a number or a word")
        _refuse_booleans(data[name], defaults[name], place, f"{section}{name}.")


def _refuse_contradictions(config: Config, place: str) -> None:
    """Raises ConfigError for settings that are in range one by one but not together."""
    try:
        config.start.pose()
    except ConfigError as error:
        raise ConfigError(f"{place}: {error}") from error
    try:
        step_detector(config.resample.rate_hz, config.steps)
    except ConfigError as error:
        raise ConfigError(f"{place}: steps.{config.steps.detector.replace('-', '_')}: {error}") from error
    watched_s, compensated_s = config.mode.mmpdr.window_s, config.steps.mmpdr.transition_s
    if config.mode.method == config.steps.detector == "mmpdr" and watched_s != compensated_s:
        raise ConfigError(
            f"{place}: mode.mmpdr.window_s = {watched_s:g} and steps.mmpdr.transition_s = {compensated_s:g} are both "
            "the length of a transition: give them one value"
        )
    heading = config.heading
    gives_priors = heading.method == "auto" and heading.dominant.enabled and heading.use == "priors"
    if heading.dominant.direction_rad is not None and not gives_priors:
        raise ConfigError(
            f"{place}: heading.dominant.direction_rad = {heading.dominant.direction_rad:g}: is a direction in the "
            "map, which only heading.method auto with heading.use priors and heading.dominant.enabled makes use of: "
            "choose these, or leave it out"
        )
    if config.gait.model is not None:
        try:
            gait_model(config.gait)
        except ConfigError as error:
            raise ConfigError(f"{place}: gait.model: {error}") from error


def _explain(detail: ErrorDetails) -> str:
    location = detail["loc"]
    key = ".".join(str(part) for part in location) or "top level"
    value = _brief(detail["input"])
    match detail["type"]:
        case "unexpected_keyword_argument" | "extra_forbidden" | "invalid_key":
            known = _keys_of(location[:-1])
            near = difflib.get_close_matches(str(location[-1]), known, n=1)
            remedy = f"did you mean {near[0]!r}?" if near else f"known keys are {', '.join(known)}"
            return f"unknown key {key!r}: {remedy}"
        case "dataclass_type" | "dataclass_exact_type":
            return f"{key} = {value}: is a section, give it keys such as {_keys_of(location)[0]!r}"
        case "greater_than" | "greater_than_equal" | "less_than" | "less_than_equal" | "finite_number":
            return f"{key} = {value}: {detail['msg']}{_unit_hint(key)}"
    return f"{key} = {value}: {detail['msg']}"


def _brief(value: Any) -> str:
    text = reprlib.repr(value)
    return text if len(text) <= _LONGEST_VALUE else f"{text[:_LONGEST_VALUE]}…"


def _unit_hint(key: str) -> str:
    """The unit that the suffix of a key names: most values out of range are in another one."""
    _, underscore, suffix = key.rpartition("_")
    words = _UNIT_WORDS.get(underscore + suffix)
    return f"; the unit is {words}" if words is not None and "_per_" not in key else ""


def _keys_of(location: Sequence[int | str]) -> list[str]:
    """Keys of a section."""
    section: Any = config_to_dict(Config())
    for part in location:
        section = section.get(part, {}) if isinstance(section, dict) else {}
    return list(section) if isinstance(section, dict) else []
