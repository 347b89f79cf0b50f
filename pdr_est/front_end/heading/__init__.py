"""Heading of each step: one file a method, chosen by name."""

from typing import Literal, assert_never, get_args

from pdr_est.front_end.heading.magnetometer import MagnetometerHeading
from pdr_est.front_end.heading.step_yaw import StepYaw
from pdr_est.params import params
from pdr_est.stage import Stage

HeadingName = Literal["auto", "step-yaw", "magnetometer"]
HEADINGS: tuple[HeadingName, ...] = get_args(HeadingName)
HeadingUse = Literal["increments", "priors"]


@params
class HeadingParams:
    """method: which one. use: what becomes of the directions of straight paths that a method finds: "increments"
    corrects the headings of the steps by them, "priors" leaves the headings as they were and hands the directions to
    the estimator as heading priors, which it weighs."""

    method: HeadingName = "auto"
    use: HeadingUse = "priors"


def needs_magnetometer(parameters: HeadingParams) -> bool:
    """Whether the method wants the magnetic field with the samples of a step."""
    return parameters.method == "magnetometer"


def heading_stage(rate_hz: float, parameters: HeadingParams) -> Stage:
    """Stage Step -> Step that fills in heading_rad, sigma_turn_rad and, on straight paths, straight_rad."""
    match parameters.method:
        case "auto" | "step-yaw":
            return StepYaw()
        case "magnetometer":
            return MagnetometerHeading()
    assert_never(parameters.method)
