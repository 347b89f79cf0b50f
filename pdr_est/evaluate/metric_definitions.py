"""Definitions of the metrics, with their units and ideal values."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from pdr_est.evaluate.statistics import Average


@dataclass(frozen=True)
class Metric:
    """Meaning of a metric.

    Attributes
    ----------
    text : str
        One or two sentences.
    ideal : float
        Value of a perfect track; nearer values are better.
    with_fixes : bool
        True for a metric of a track that was given position fixes.
    pooled_by : str or None
        Name of the count of a walk by which means over walks are weighted; None if every walk has the same weight.
    """

    text: str
    ideal: float = 0.0
    with_fixes: bool = False
    pooled_by: str | None = None


_UNITS: Mapping[str, str] = MappingProxyType({"_m": "m", "_deg": "deg", "_per_min": "1/min"})


def unit_of(metric: str) -> str:
    """Return the unit of a metric, which is the end of its name; empty for ratios and shares."""
    return next((unit for ending, unit in _UNITS.items() if metric.endswith(ending)), "")


def pooled_average(metric: str, rows: Iterable[tuple[float | None, Mapping[str, int]]]) -> Average:
    """Average a metric over walks, weighted by a count of each walk where its definition says so.

    Parameters
    ----------
    metric : str
        Name of the metric.
    rows : iterable of (float or None, Mapping)
        Value of each walk, and its counts by name.

    Raises
    ------
    KeyError
        If a walk has a value and not the count by which it is weighted.
    """
    pooled_by = DEFINITIONS[metric].pooled_by if metric in DEFINITIONS else None
    known = list(rows)
    weights = None
    if pooled_by is not None:
        weights = [0.0 if value is None else float(counts[pooled_by]) for value, counts in known]
    return Average.of((value for value, _ in known), weights)


def with_unit(metric: str) -> str:
    """Return the metric as a heading with its unit, such as `error_open_m (m)`."""
    unit = unit_of(metric)
    return f"{metric} ({unit})" if unit else metric


ALIGNED_NOTE = (
    "* This estimator takes no measurement from the position fixes: as far as its start is not given, the whole "
    "track is moved and turned to fit all of them, the last one included. A filter knows at each step only the fixes "
    "until then, so that its errors do not compare with these; those of a smoother do."
)
"""Footnote to metrics with fixes of an estimator that only aligns its track with them; `marked` refers to it."""


def marked(variant: str, metric: str, aligned: Collection[str]) -> str:
    """Return the name of a variant, marked for `ALIGNED_NOTE` if its value of the metric is that of an aligned track.

    Parameters
    ----------
    variant, metric : str
        Names.
    aligned : collection of str
        Names of the variants whose estimator only aligns its track with the fixes.
    """
    return (
        f"{variant} *" if variant in aligned and metric in DEFINITIONS and DEFINITIONS[metric].with_fixes else variant
    )


_START = "after moving the first true position onto the track and turning to the first one at least 20 m away"
_HELD = "of a track that was given the other true positions as fixes"
_GPS = "of a track whose only fixes are the GPS positions in the recording"
_NORTH = "of a track that was given the first true position, and whose direction comes from the phone's north"
_PLAN = "of a track that was given the floor plan and the first true position"
_PROFILE = "with the step length learnt from sparse fixes of the other walks of the person, or of the place"
_CALIBRATED = "after calibrating the walker on other walks of the set"

DEFINITIONS: Mapping[str, Metric] = MappingProxyType(
    {
        "error_open_m": Metric(f"Mean distance to the true positions, from the sensors alone, {_START}."),
        "final_drift": Metric(f"Distance to the last true position {_START}, per length of the true way."),
        "ate_rigid_m": Metric(
            "Root of the mean squared distance to the true positions after the best rotation and translation of the "
            "whole track, from the sensors alone."
        ),
        "length_ratio": Metric(
            "Length of the track between the first and the last true position over the length of the true way.", 1.0
        ),
        "error_heldout_m": Metric(f"Mean distance to the held-out true positions {_HELD}.", with_fixes=True),
        "coverage95": Metric(
            f"Share of the held-out true positions inside the stated 95 % region {_HELD}. More than 0.95 is as wrong "
            "as less.",
            0.95,
            with_fixes=True,
        ),
        "nees_mean": Metric(
            f"Mean squared error in units of the stated covariance, at the held-out true positions {_HELD}. 2 is "
            "right; more: the track claims to be surer than it is.",
            2.0,
            with_fixes=True,
        ),
        "error_start_m": Metric(f"Mean distance to the later true positions {_NORTH}, nothing aligned."),
        "heading_start_error_deg": Metric(
            f"Rotation, without its sign, of the best rigid alignment of the track to the true positions {_NORTH}."
        ),
        "coverage95_start": Metric(
            f"Share of the later true positions inside the stated 95 % region {_NORTH}. More than 0.95 is as wrong "
            "as less.",
            0.95,
        ),
        "error_plan_m": Metric(f"Mean distance to the later true positions {_PLAN}, nothing aligned."),
        "coverage95_plan": Metric(
            f"Share of the later true positions inside the stated 95 % region {_PLAN}. More than 0.95 is as wrong as "
            "less.",
            0.95,
        ),
        "outside_plan": Metric(f"Share of the poses outside of the walkable area {_PLAN}."),
        "error_heldout_plan_m": Metric(f"error_heldout_m with the floor plan, {_HELD}.", with_fixes=True),
        "coverage95_heldout_plan": Metric(
            f"coverage95 with the floor plan, {_HELD}. More than 0.95 is as wrong as less.", 0.95, with_fixes=True
        ),
        "error_gps_m": Metric(f"Mean distance to the surveyed points {_GPS}, nothing aligned.", with_fixes=True),
        "coverage95_gps": Metric(
            f"Share of the surveyed points inside the stated 95 % region {_GPS}, 0.2 m per axis added for "
            "the points. More than 0.95 is as wrong as less.",
            0.95,
            with_fixes=True,
        ),
        "scale_gps": Metric(
            f"Learnt ratio of the walker's step length to that of the step-length model {_GPS}.", 1.0, with_fixes=True
        ),
        "error_gps_raw_m": Metric(
            "Mean distance of the GPS positions themselves to the surveyed points: the positions are interpolated "
            "linearly at the times of the points; a point before the first or after the last of them takes that one."
        ),
        "leg_length_mae_m": Metric(
            "Mean difference of the distances between successive true positions, over all of them, from the sensors "
            "alone.",
            pooled_by="legs",
        ),
        "leg_vector_mae_m": Metric(
            "Mean distance of the displacements between successive true positions, over all of them, after the best "
            "rotation of each walk, from the sensors alone.",
            pooled_by="legs",
        ),
        "leg_turn_mae_m": Metric(
            "Mean distance of the displacements between successive true positions, each as seen from the direction "
            "of the one before it, over all for which that one is at least 1 m long, and 0.5 m in the track, from "
            "the sensors alone.",
            pooled_by="leg_turns",
        ),
        "mode_accuracy": Metric("Share of the walking time that is labelled with the true carrying mode.", 1.0),
        "count_error": Metric("Difference of the detected and the true number of steps, per true number."),
        "step_precision": Metric(
            "Share of the detected steps that match a true one within 0.3 s, each at most once, after taking out the "
            "median offset.",
            1.0,
        ),
        "step_recall": Metric("Share of the true steps that match a detected one in the same way.", 1.0),
        "steps_missed": Metric("True steps that match no detected one, per true number, where steps are annotated."),
        "steps_extra": Metric("Detected steps that match no true one, per true number, where steps are annotated."),
        "speed_ratio": Metric("Length of the track per duration of the recording over the true speed.", 1.0),
        "heading_rms_deg": Metric(
            "Root of the mean squared difference of the directions of travel of track and truth, on legs of at least "
            "3 m, after the best rotation of the whole track, from the sensors alone."
        ),
        "turn_error_deg": Metric(
            "Difference of the heading change from 2 s before to 2 s after an annotated turn and its angle, median "
            "over the turns."
        ),
        "heading_net_error_deg": Metric(
            "Difference of the heading change over the whole walk and the sum of the annotated turns."
        ),
        "distance_error": Metric("Difference of the length of the way and the true one, per true length."),
        "stride_error": Metric("Mean difference of a stride's length and the measured one, per measured length."),
        "stride_error_by_time": Metric("The same with the way between the times of its beginning and its end."),
        "scale_coverage68": Metric(
            "Whether the length of the way is right within the stated standard deviation of its scale.", 0.68
        ),
        "gait_accuracy": Metric("Share of the steps with the true class of gait.", 1.0),
        "walking_accuracy": Metric("Share of the steps with the true class, jogging and running being one.", 1.0),
        "count_plausibility": Metric("Detected steps over those that the spectrum of the signals tells.", 1.0),
        "false_steps_per_min": Metric("Detected steps a minute of somebody who takes none."),
        "distance_error_calibrated": Metric(f"distance_error {_CALIBRATED}."),
        "stride_error_calibrated": Metric(f"stride_error {_CALIBRATED}."),
        "stride_error_by_time_calibrated": Metric(f"stride_error_by_time {_CALIBRATED}."),
        "ate_rigid_profile_m": Metric(f"ate_rigid_m {_PROFILE}."),
        "length_ratio_profile": Metric(f"length_ratio {_PROFILE}.", 1.0),
        "scale_coverage68_profile": Metric(
            f"Whether length_ratio_profile is right within the profile's own standard deviation, {_PROFILE}.",
            0.68,
        ),
        "scale_coverage68_calibrated": Metric(f"scale_coverage68 {_CALIBRATED}.", 0.68),
    }
)
