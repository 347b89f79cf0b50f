"""What each metric means, and the value that would be right."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True)
class Definition:
    """text: one or two sentences. ideal: the value of a perfect track; the nearer, the better."""

    text: str
    ideal: float = 0.0


_UNITS: Mapping[str, str] = MappingProxyType({"_m": "m", "_deg": "deg", "_per_min": "1/min"})


def unit_of(metric: str) -> str:
    """The unit of a metric, as the end of its name says; empty for ratios and shares."""
    return next((unit for ending, unit in _UNITS.items() if metric.endswith(ending)), "")


def with_unit(metric: str) -> str:
    """The metric as a heading: `error_open_m (m)`; ratios and shares have none."""
    unit = unit_of(metric)
    return f"{metric} ({unit})" if unit else metric


_START = "after moving the first true position onto the track and turning to the first one at least 20 m away"
_HELD = "of a track that was given the other true positions as fixes"
_CALIBRATED = "after calibrating the walker on other walks of the set"

DEFINITIONS: Mapping[str, Definition] = MappingProxyType(
    {
        "error_open_m": Definition(f"Mean distance to the true positions, from the sensors alone, {_START}."),
        "final_drift": Definition(f"Distance to the last true position {_START}, per length of the true way."),
        "ate_rigid_m": Definition(
            "Root of the mean squared distance to the true positions after the best rotation and translation of the "
            "whole track, from the sensors alone."
        ),
        "length_ratio": Definition(
            "Length of the track between the first and the last true position over the length of the true way.", 1.0
        ),
        "error_heldout_m": Definition(f"Mean distance to the held-out true positions {_HELD}."),
        "coverage95": Definition(
            f"Share of the held-out true positions inside the stated 95 % region {_HELD}. More than 0.95 is as wrong "
            "as less.",
            0.95,
        ),
        "nees_mean": Definition(
            f"Mean squared error in units of the stated covariance, at the held-out true positions {_HELD}. 2 is "
            "right; more: the track claims to be surer than it is.",
            2.0,
        ),
        "mode_accuracy": Definition("Share of the walking time that is labelled with the true carrying mode.", 1.0),
        "count_error": Definition("Difference of the detected and the true number of steps, per true number."),
        "step_precision": Definition(
            "Share of the detected steps that match a true one within 0.3 s, each at most once, after taking out the "
            "median offset.",
            1.0,
        ),
        "step_recall": Definition("Share of the true steps that match a detected one in the same way.", 1.0),
        "turn_error_deg": Definition(
            "Difference of the heading change from 2 s before to 2 s after an annotated turn and its angle, median "
            "over the turns."
        ),
        "heading_net_error_deg": Definition(
            "Difference of the heading change over the whole walk and the sum of the annotated turns."
        ),
        "distance_error": Definition("Difference of the length of the way and the true one, per true length."),
        "stride_error": Definition("Mean difference of a stride's length and the measured one, per measured length."),
        "stride_error_by_time": Definition("The same with the way between the times of its beginning and its end."),
        "scale_coverage68": Definition(
            "Whether the length of the way is right within the stated standard deviation of its scale.", 0.68
        ),
        "gait_accuracy": Definition("Share of the steps with the true class of gait.", 1.0),
        "walking_accuracy": Definition("Share of the steps with the true class, jogging and running being one.", 1.0),
        "count_plausibility": Definition("Detected steps over those that the spectrum of the signals tells.", 1.0),
        "false_steps_per_min": Definition("Detected steps a minute of somebody who takes none."),
        "distance_error_calibrated": Definition(f"distance_error {_CALIBRATED}."),
        "stride_error_calibrated": Definition(f"stride_error {_CALIBRATED}."),
        "stride_error_by_time_calibrated": Definition(f"stride_error_by_time {_CALIBRATED}."),
        "scale_coverage68_calibrated": Definition(f"scale_coverage68 {_CALIBRATED}.", 0.68),
    }
)
