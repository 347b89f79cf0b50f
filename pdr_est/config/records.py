"""The configuration: one frozen record that nests the parameters of every stage."""

from collections.abc import Mapping
from dataclasses import field, replace
from typing import Annotated, Any

from annotated_types import Ge, Le

from pdr_est.clock_sync import ClockMethod, GivenClock
from pdr_est.estimators import AUTO, ESTIMATORS, Estimator, estimator_named
from pdr_est.estimators.common.fix_noise import FixNoiseParams
from pdr_est.estimators.common.tethers import TetherParams
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.robust_dr.params import MapFusionParams
from pdr_est.front_end.attitude import AttitudeParams
from pdr_est.front_end.gait import GaitParams
from pdr_est.front_end.heading import HeadingParams
from pdr_est.front_end.height import HeightParams
from pdr_est.front_end.mode import ModeParams
from pdr_est.front_end.odometry import OdometryParams
from pdr_est.front_end.step_length import StepLengthParams, WalkerParams
from pdr_est.front_end.steps import StepsParams
from pdr_est.params import NonNegative, Positive, params
from pdr_est.params.validation_messages import contradiction
from pdr_est.parts import PartName
from pdr_est.preprocessing.resampling import ResampleParams
from pdr_est.types.measurements import StartPose

Coordinate = Annotated[float, Ge(-1e8), Le(1e8)]  # also UTM's, which reach 1e7 m
Reach = Annotated[float, Ge(-2.0), Le(2.0)]
Turn = Annotated[float, Ge(-6.3), Le(6.3)]


@params
class StartParams:
    """Start of the walk in the map frame; null means unknown."""

    x_m: Coordinate | None = None
    """East coordinate of the start, m; null if unknown."""

    y_m: Coordinate | None = None
    """North coordinate of the start, m; null if unknown."""

    heading_rad: Turn | None = None
    """Heading at the start, rad, counter-clockwise from east; null if unknown."""

    sigma_position_m: NonNegative = 0.5
    """Standard deviation of the start position in each coordinate, m."""

    sigma_heading_rad: NonNegative = 0.1
    """Standard deviation of the heading at the start, rad."""

    closed: bool = False
    """True if the walk ends where it began."""

    sigma_closed_m: Positive = 0.5
    """Standard deviation in each coordinate, m, of the end of a closed walk about its start."""

    def __post_init__(self) -> None:
        if (self.x_m is None) != (self.y_m is None):
            raise contradiction("x_m and y_m belong together: give both or none")

    def pose(self) -> StartPose:
        """Make the start pose for the estimators."""
        position = None if self.x_m is None or self.y_m is None else (self.x_m, self.y_m)
        return StartPose(position, self.heading_rad, self.sigma_position_m, self.sigma_heading_rad)


@params
class EstimatorParams:
    """Choice of the estimator; the parameters of each lie under its own name."""

    name: Annotated[str, PartName((AUTO, *ESTIMATORS))] = "auto"
    """Name of the estimator, or module:attribute for one of your own; auto is particle where there is a floor plan,
    because it keeps the track on it, and factor-graph where there is none."""

    parameters: dict[str, Any] = field(default_factory=dict, hash=False)
    """Arguments of an estimator of your own, which `name` names as module:attribute."""

    map_fusion: MapFusionParams = MapFusionParams()
    """Parameters of the estimators map-closed-form and map-general."""

    fixed_lag: FixedLagParams = FixedLagParams()
    """Parameters of the estimator fixed-lag."""

    particle: ParticleParams = ParticleParams()
    """Parameters of the estimator particle."""

    def make(self, on_plan: bool = False) -> Estimator:
        """Make the estimator of a walk, which has a floor plan or not.

        Raises PartError for an estimator from outside the package that cannot be made.
        """
        return estimator_named(self.name, self.parameters, self.map_fusion, self.fixed_lag, self.particle, on_plan)


@params
class Mounting:
    """Place of a device on the body, seen from the centre of motion."""

    device: str
    """Name of the device."""

    forward_m: Reach = 0.0
    """Distance of the device ahead of the centre, m."""

    left_m: Reach = 0.0
    """Distance of the device to the left of the centre, m."""

    @property
    def offset_m(self) -> tuple[float, float]:
        """Distance forward and to the left, m."""
        return self.forward_m, self.left_m


@params
class DevicesParams:
    """Several devices on one body."""

    clock: ClockMethod = "walk"
    """Source of the clocks of the other devices against the first one: "walk" estimates them from the motion that all
    recorded, "messages" from messages that the devices exchanged, "given" takes those in `clocks`, "none" takes the
    time stamps as they are."""

    clocks: tuple[GivenClock, ...] = ()
    """Clocks for the choice "given"."""

    tethered: bool = True
    """True if the distance between the devices is bounded by tethers."""

    tether: TetherParams = TetherParams()
    """Parameters of the tethers."""

    mountings: tuple[Mounting, ...] = ()
    """Places of the devices that do not sit in the centre of motion."""

    def mounting_of(self, device: str) -> Mounting:
        """Find the place of a device on the body, the centre if none is given."""
        return next((one for one in self.mountings if one.device == device), Mounting(device=device))


@params
class Config:
    """All settings, a section for each stage, in the order in which the data passes through the system."""

    resample: ResampleParams = ResampleParams()
    """Resampling of the recorded samples to the working rate."""

    attitude: AttitudeParams = AttitudeParams()
    """Attitude of the device, from which its samples are levelled."""

    mode: ModeParams = ModeParams()
    """Recognition of the carrying mode."""

    steps: StepsParams = StepsParams()
    """Detection of the steps."""

    gait: GaitParams = GaitParams()
    """Classification of the gait of each step."""

    walker: WalkerParams = WalkerParams()
    """The person who walks."""

    step_length: StepLengthParams = StepLengthParams()
    """Length of each step."""

    heading: HeadingParams = HeadingParams()
    """Heading of each step."""

    height: HeightParams = HeightParams()
    """Height of the walker and floors, by the air pressure."""

    odometry: OdometryParams = OdometryParams()
    """Uncertainty of the motion from step to step."""

    start: StartParams = StartParams()
    """Start of the walk."""

    fixes: FixNoiseParams = FixNoiseParams()
    """Errors of position fixes."""

    devices: DevicesParams = DevicesParams()
    """Several devices on one body."""

    estimator: EstimatorParams = EstimatorParams()
    """Estimator of the track."""

    def __post_init__(self) -> None:
        from pdr_est.config.contradictions import first_contradiction  # which knows this record

        found = first_contradiction(self)
        if found is not None:
            location, message = found
            raise contradiction(message, location)

    def with_estimator(self, name: str) -> "Config":
        """Make the same configuration with another estimator."""
        kept = self.estimator.parameters if name == self.estimator.name else {}
        return replace(self, estimator=replace(self.estimator, name=name, parameters=kept))

    def replace(self, changes: Mapping[str, Any]) -> "Config":
        """Make the same configuration with some settings changed.

        Parameters
        ----------
        changes
            New values by dotted key, such as `{"steps.detector": "mmpdr"}`, or nested by section.

        Raises
        ------
        ConfigError
            For unknown keys, with the key that is probably meant, for values of the wrong type or out of range, and
            for values that contradict each other.
        """
        from pdr_est.config.loading import config_with  # which knows this record

        return config_with(self, changes, "Config.replace")


PART_KEYS = {
    "mode": "method",
    "steps": "detector",
    "gait": "method",
    "step_length": "model",
    "heading": "method",
    "estimator": "name",
}
"""Sections whose part may be one from outside the package, with the key of its name."""
