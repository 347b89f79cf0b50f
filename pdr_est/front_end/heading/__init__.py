"""Find the heading of each step; one file for each method, chosen by name.

* `posture_aware_yaw`: the default; `phone_posture` has its geometry, `placement_change/` the turns of the walker
  while the phone is put elsewhere.
* `step_yaw`: the mean yaw of the phone over the step (MMPDR Table IV).
* `mmpdr_aoc`: MMPDR's adaptive offset compensation.
* `psp`: the y axis of a phone in a pocket, with `hde_controller` and `tie_controller` (PSP).
* `acceleration_integration`: the integrated acceleration (Robust DR).
* `principal_axis`: the principal axis of the horizontal acceleration.
* `magnetometer`: the compass.
* `level_frame`, `stride_pairing`: geometry and pairing of steps that several methods share.
* `north/`: headings against north, for the method "auto".
* `course/`: stretches in which the walker moves sideways or backwards.
* `whole_walk/`: corrections that need the whole walk: the turns while the phone was put elsewhere, from all strides,
  and the dominant directions of the building.
"""

from dataclasses import field
from typing import Annotated, Any, Literal, get_args

from pdr_est.front_end.heading.acceleration_integration import AccelerationIntegration, AccelerationIntegrationParams
from pdr_est.front_end.heading.course.course_params import CourseParams
from pdr_est.front_end.heading.course.online_course import OnlineCourse
from pdr_est.front_end.heading.hde_controller import HdeParams
from pdr_est.front_end.heading.magnetometer import MagnetometerHeading
from pdr_est.front_end.heading.mmpdr_aoc import MmpdrHeading, MmpdrHeadingParams
from pdr_est.front_end.heading.north import NorthParams
from pdr_est.front_end.heading.placement_change.auto_params import AutoHeadingParams
from pdr_est.front_end.heading.posture_aware_yaw import PostureAwareYaw
from pdr_est.front_end.heading.principal_axis import PrincipalAxis, PrincipalAxisParams
from pdr_est.front_end.heading.psp import PspHeading
from pdr_est.front_end.heading.step_yaw import StepYaw
from pdr_est.front_end.heading.tie_controller import TieParams
from pdr_est.front_end.heading.whole_walk.dominant_directions import DominantParams
from pdr_est.front_end.heading.whole_walk.drift_correction import WholeWalkHeading
from pdr_est.params import params
from pdr_est.parts import STAGE, PartName, is_external, loaded, named_part
from pdr_est.stage import Chain, Stage

HeadingName = Literal[
    "auto", "step-yaw", "mmpdr", "gyro", "hde", "psp", "acceleration-integration", "principal-axis", "magnetometer"
]
HEADINGS: tuple[HeadingName, ...] = get_args(HeadingName)
# These integrate the rotation of a phone that stands upright in a trouser pocket.
IN_POCKETS: tuple[HeadingName, ...] = ("gyro", "hde", "psp")
HeadingUse = Literal["increments", "priors"]


@params
class HeadingParams:
    """Choose the heading method.

    The parameters of each method lie under its own name. The method "psp" has those of its controllers, `hde` and
    `tie`; "auto" has those of `principal_axis` and of the dominant directions, too.
    """

    method: Annotated[str, PartName(HEADINGS)] = "auto"
    """Name of the heading method."""
    parameters: dict[str, Any] = field(default_factory=dict, hash=False)
    """Arguments of a heading stage of your own, which `method` names as module:attribute."""
    use: HeadingUse = "priors"
    """Use of the directions of straight paths that a method finds: "increments" corrects the headings of the steps by
    them, "priors" leaves the headings as they were and hands the directions to the estimator as heading priors, which
    it weighs.
    """
    auto: AutoHeadingParams = AutoHeadingParams()
    """Parameters of the method "auto"."""
    dominant: DominantParams = DominantParams()
    """Parameters of the dominant directions, for the method "auto"."""
    course: CourseParams = CourseParams()
    """Parameters of the search for sideways and backward walking, for the method "auto"."""
    north: NorthParams = NorthParams()
    """Headings against north, for the method "auto"."""
    mmpdr: MmpdrHeadingParams = MmpdrHeadingParams()
    """Parameters of the method "mmpdr"."""
    hde: HdeParams = HdeParams()
    """Parameters of the HDE controller, for the methods "hde" and "psp"."""
    tie: TieParams = TieParams()
    """Parameters of the TIE controller, for the method "psp"."""
    acceleration_integration: AccelerationIntegrationParams = AccelerationIntegrationParams()
    """Parameters of the method "acceleration-integration"."""
    principal_axis: PrincipalAxisParams = PrincipalAxisParams()
    """Parameters of the method "principal-axis", which "auto" uses as well."""


def needs_magnetometer(parameters: HeadingParams) -> bool:
    """Return True if the method needs the magnetic field with the samples of a step.

    A stage from outside the package needs it if its class or factory has an attribute `needs_magnetometer` that is
    true.
    """
    if is_external(parameters.method):
        return bool(getattr(loaded(parameters.method, "heading.method"), "needs_magnetometer", False))
    return parameters.method == "magnetometer"


def heading_stage(rate_hz: float, parameters: HeadingParams) -> Stage:
    """Make the configured stage Step -> Step that fills in the heading.

    It fills in `heading_rad`, `sigma_turn_rad`, on straight paths `path_heading_rad`, and `turn_hypotheses` where the
    phone was put elsewhere.

    Raises
    ------
    PartError
        If a stage from outside the package cannot be made.
    """
    priors = parameters.use == "priors"
    match parameters.method:
        case "auto":
            yaw = PostureAwareYaw(parameters.auto, parameters.principal_axis)
            return Chain([yaw, OnlineCourse(parameters.course)]) if parameters.course.enabled else yaw
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
    """Make the stage Step -> Step that corrects headings at the end of the walk; None if there is nothing to correct.

    The method "auto" has three corrections, each with a switch of its own.
    """
    dominant = parameters.dominant if parameters.dominant.enabled else None
    placement = parameters.auto if parameters.auto.whole_walk else None
    course = parameters.course if parameters.course.enabled else None
    if parameters.method != "auto" or (dominant is None and placement is None and course is None):
        return None
    return WholeWalkHeading(dominant, as_priors=parameters.use == "priors", placement=placement, course=course)
