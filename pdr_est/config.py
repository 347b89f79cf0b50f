"""The configuration: one frozen record that nests the parameters of every stage, YAML in and out."""

import difflib
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, Literal

import yaml
from pydantic import TypeAdapter, ValidationError
from pydantic_core import ErrorDetails

from pdr_est.errors import ConfigError
from pdr_est.estimators import EstimatorName
from pdr_est.front_end.attitude import AttitudeParams
from pdr_est.front_end.heading.step_yaw import HeadingParams
from pdr_est.front_end.mode import ModeParams
from pdr_est.front_end.odometry import OdometryParams
from pdr_est.front_end.step_length import StepLengthParams, WalkerParams
from pdr_est.front_end.steps.band_peaks import BandPeaksParams
from pdr_est.front_end.steps.mmpdr import MmpdrStepParams
from pdr_est.front_end.steps.segmentation import SegmentationParams
from pdr_est.io.resample import ResampleParams
from pdr_est.params import NonNegative, params
from pdr_est.records import StartPose


@params
class StepsParams:
    """detector: which step detector; its parameters lie under its own name."""

    detector: Literal["band-peaks", "mmpdr"] = "band-peaks"
    band_peaks: BandPeaksParams = BandPeaksParams()
    mmpdr: MmpdrStepParams = MmpdrStepParams()
    segmentation: SegmentationParams = SegmentationParams()


@params
class StartParams:
    """Start pose in the map frame; null means unknown. heading_rad counter-clockwise from east."""

    x_m: float | None = None
    y_m: float | None = None
    heading_rad: float | None = None
    sigma_position_m: NonNegative = 0.5
    sigma_heading_rad: NonNegative = 0.1

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


def load_config(path: str | Path) -> Config:
    """Configuration from a YAML file; what the file leaves out keeps its default.

    Raises ConfigError that names the file and the key, for damaged YAML, unknown keys and values out of range.
    """
    try:
        data = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read ({error.strerror}): check the path") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: is not UTF-8 text: save it as UTF-8 YAML") from error
    except yaml.YAMLError as error:
        raise ConfigError(f"{path}: is not valid YAML: {' '.join(str(error).split())}") from error
    return config_from_dict({} if data is None else data, str(path))


def config_from_dict(data: Any, place: str) -> Config:
    """Validated configuration from nested dictionaries. place: what to call it in error messages."""
    try:
        config = _ADAPTER.validate_python(data)
    except ValidationError as error:
        raise ConfigError(f"{place}: {'; '.join(_explain(detail) for detail in error.errors())}") from error
    config.start.pose()  # refuses half a position
    return config


def config_to_dict(config: Config) -> dict[str, Any]:
    """Nested plain dictionaries, ready for YAML or JSON."""
    return asdict(config)


def config_to_yaml(config: Config) -> str:
    """The whole configuration as YAML, which `load_config` reads back to the same record."""
    return str(yaml.safe_dump(config_to_dict(config), sort_keys=False))


def _explain(detail: ErrorDetails) -> str:
    key = ".".join(str(part) for part in detail["loc"]) or "top level"
    if detail["type"] in ("unexpected_keyword_argument", "extra_forbidden"):
        known = _keys_beside(detail["loc"])
        near = difflib.get_close_matches(str(detail["loc"][-1]), known, n=1)
        remedy = f"did you mean {near[0]!r}?" if near else f"known keys are {', '.join(known)}"
        return f"unknown key {key!r}: {remedy}"
    return f"{key} = {detail['input']!r}: {detail['msg']}"


def _keys_beside(location: tuple[int | str, ...]) -> list[str]:
    section: Any = config_to_dict(Config())
    for part in location[:-1]:
        section = section.get(part, {}) if isinstance(section, dict) else {}
    return list(section) if isinstance(section, dict) else []
