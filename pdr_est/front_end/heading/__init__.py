"""Heading of each step: one file a method, chosen by name."""

from dataclasses import field
from typing import Annotated, Any, Literal, get_args

from pdr_est.front_end.heading.acceleration_integration import AccelerationIntegration, AccelerationIntegrationParams
from pdr_est.front_end.heading.hde_controller import HdeParams
from pdr_est.front_end.heading.magnetometer import MagnetometerHeading
from pdr_est.front_end.heading.mmpdr_aoc import MmpdrHeading, MmpdrHeadingParams
from pdr_est.front_end.heading.posture_aware_yaw import AutoHeadingParams, PostureAwareYaw
from pdr_est.front_end.heading.principal_axis import PrincipalAxis, PrincipalAxisParams
from pdr_est.front_end.heading.psp import PspHeading
from pdr_est.front_end.heading.step_yaw import StepYaw
from pdr_est.front_end.heading.tie_controller import TieParams
from pdr_est.front_end.heading.whole_walk.dominant_directions import DominantParams
from pdr_est.front_end.heading.whole_walk.stage import WholeWalkHeading
from pdr_est.params import params
from pdr_est.parts import STAGE, PartName, is_external, loaded, named_part
from pdr_est.stage import Stage

HeadingName = Literal[
    "auto", "step-yaw", "mmpdr", "gyro", "hde", "psp", "acceleration-integration", "principal-axis", "magnetometer"
]
HEADINGS: tuple[HeadingName, ...] = get_args(HeadingName)
# These integrate the rotation of a phone that stands upright in a trouser pocket.
IN_POCKETS: tuple[HeadingName, ...] = ("gyro", "hde", "psp")
HeadingUse = Literal["increments", "priors"]


@params
class HeadingParams:
    """method: which one. use: what becomes of the directions of straight paths that a method finds: "increments"
    corrects the headings of the steps by them, "priors" leaves the headings as they were and hands the directions to
    the estimator as heading priors, which it weighs. The parameters of each method lie under its own name; `psp` has
    those of its controllers, `hde` and `tie`, and `auto` also those of the dominant directions, `dominant`."""

    method: Annotated[str, PartName(HEADINGS)] = "auto"
    parameters: dict[str, Any] = field(default_factory=dict, hash=False)
    """Arguments of a heading stage of your own, which `method` names as module:attribute."""
    use: HeadingUse = "priors"
    auto: AutoHeadingParams = AutoHeadingParams()
    dominant: DominantParams = DominantParams()
    mmpdr: MmpdrHeadingParams = MmpdrHeadingParams()
    hde: HdeParams = HdeParams()
    tie: TieParams = TieParams()
    acceleration_integration: AccelerationIntegrationParams = AccelerationIntegrationParams()
    principal_axis: PrincipalAxisParams = PrincipalAxisParams()


def needs_magnetometer(parameters: HeadingParams) -> bool:
    """Check whether the method needs the magnetic field with the samples of a step.

    A stage from outside the package needs it if its class or factory has an attribute `needs_magnetometer` that is
    true.
    """
    if is_external(parameters.method):
        return bool(getattr(loaded(parameters.method, "heading.method"), "needs_magnetometer", False))
    return parameters.method == "magnetometer"


def heading_stage(rate_hz: float, parameters: HeadingParams) -> Stage:
    """Make the configured stage, which fills in heading_rad, sigma_turn_rad and, on straight paths, path_heading_rad.

    Raises PartError for one from outside the package that cannot be made.
    """
    priors = parameters.use == "priors"
    match parameters.method:
        case "auto":
            return PostureAwareYaw(parameters.auto, parameters.principal_axis)
        case "step-yaw":
            return StepYaw()
        case "mmpdr":
            return MmpdrHeading(parameters.mmpdr)
        case "gyro":
            return PspHeading(rate_hz, None, None, priors)
        case "hde":
            return PspHeading(rate_hz, parameters.hde, None, priors)
        case "psp":
            return PspHeading(rate_hz, parameters.hde, parameters.tie, priors)
        case "acceleration-integration":
            return AccelerationIntegration(rate_hz, parameters.acceleration_integration)
        case "principal-axis":
            return PrincipalAxis(parameters.principal_axis)
        case "magnetometer":
            return MagnetometerHeading()
    own: Stage = named_part(parameters.method, parameters.parameters, STAGE, "heading.method", {"rate_hz": rate_hz})
    return own


def whole_walk_stage(parameters: HeadingParams) -> WholeWalkHeading | None:
    """Stage Step -> Step that sets headings right at the end of the walk; None for a method that has none."""
    if parameters.method != "auto" or not parameters.dominant.enabled:
        return None
    return WholeWalkHeading(parameters.dominant, as_priors=parameters.use == "priors")
