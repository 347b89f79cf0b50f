"""The numbers of an evaluation as one JSON document: `evaluation.json`, and the source of the page's tables."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pdr_est.evaluate.position_errors import polyline_length
from pdr_est.evaluate.trajectories.scores import TRACK_METRICS, Alignment, TrajectoryScore
from pdr_est.io.trajectories import Trajectory
from pdr_est.report.walk.summary import Json, package_versions, to_json
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.recording import GeoOrigin
from pdr_est.types.track import Track

_FEW_SCORED = 0.5  # share of the true positions below which something is probably wrong with the clocks


@dataclass(frozen=True)
class Evaluation:
    """A track from a file, scored against the truth.

    Attributes
    ----------
    track_file, truth_file
        Both as they were read.
    track
        The track on the clock and in the frame of the truth, before any alignment.
    truth
        The true positions.
    scores
        Scores of each device.
    alignment
        Move of the track for the errors at each position.
    alignment_reason
        Reason for that choice, in words.
    time_offset_s, standing_s
        What the user added to the times of the track, and how long the walker stands at its ends, s.
    origin
        Origin of the frame on the Earth, if it has one.
    inputs
        SHA-256 of each input file by its name.
    """

    track_file: Trajectory
    truth_file: Trajectory
    track: Track
    truth: TruePositions
    scores: Sequence[TrajectoryScore]
    alignment: Alignment
    alignment_reason: str
    time_offset_s: float
    standing_s: float
    origin: GeoOrigin | None
    inputs: Mapping[str, str]

    @property
    def remarks(self) -> tuple[str, ...]:
        """Doubts and remarks, in words."""
        words = [*self.track_file.notes, *self.truth_file.notes]
        for score in self.scores:
            left_out, count = score.pairs.not_scored, len(self.truth.time_s)
            if left_out:
                few = len(score.pairs) < _FEW_SCORED * count
                doubt = ": check that both files have the same clock and unit of time" if few else ""
                words.append(
                    f"{score.device}: {left_out} of {count} true positions are not scored, because the track does "
                    f"not cover their times{doubt}"
                )
        return tuple(words)


def evaluation_document(evaluation: Evaluation) -> Json:
    """Describe an evaluation as JSON-serialisable data."""
    truth = evaluation.truth
    document: Json = to_json(
        {
            "track": _file(evaluation.track_file),
            "truth": _file(evaluation.truth_file)
            | {"kind": truth.source, "sigma_m": truth.sigma_m, "length_m": polyline_length(truth.position_m)},
            "inputs": evaluation.inputs,
            "clock": {
                "track": evaluation.track_file.clock.value,
                "truth": evaluation.truth_file.clock.value,
                "time_offset_s": evaluation.time_offset_s,
                "standing_s": evaluation.standing_s,
            },
            "origin": evaluation.origin,
            "alignment": {
                "name": evaluation.alignment.value,
                "meaning": evaluation.alignment.words,
                "reason": evaluation.alignment_reason,
            },
            "devices": [_device(score) for score in evaluation.scores],
            "metrics": {
                name: {"alignment": aligned, "meaning": words} for name, (aligned, words) in TRACK_METRICS.items()
            },
            "remarks": evaluation.remarks,
            "versions": package_versions(),
        }
    )
    return document


def _file(trajectory: Trajectory) -> Json:
    return {
        "file": trajectory.place,
        "format": trajectory.format,
        "positions": len(trajectory),
        "devices": trajectory.devices,
        "in_degrees": trajectory.in_degrees,
        "begin_s": trajectory.span_s[0],
        "end_s": trajectory.span_s[1],
    }


def _device(score: TrajectoryScore) -> Json:
    return {
        "device": score.device,
        "metrics": score.metrics,
        "missing": score.missing,
        "truth_points": len(score.pairs),
        "truth_points_not_scored": score.pairs.not_scored,
        "error_after_alignment_m": score.error_quantiles_m,
        "rotation_deg": math.degrees(score.transform.rotation_rad),
        "translation_m": score.transform.translation_m,
    }


def metric_rows(document: Mapping[str, Any]) -> list[tuple[str, str, str, list[float | None]]]:
    """List each metric that a device has or misses: its name, alignment, meaning and the value of each device."""
    devices = document["devices"]
    return [
        (name, about["alignment"], about["meaning"], [device["metrics"].get(name) for device in devices])
        for name, about in document["metrics"].items()
        if any(name in device["metrics"] or name in device["missing"] for device in devices)
    ]


def missing_rows(document: Mapping[str, Any]) -> list[str]:
    """Say which metrics have no value, and why, with one line for all of the same reason."""
    by_reason: dict[str, list[str]] = {}
    for device in document["devices"]:
        for name, reason in device["missing"].items():
            words = name if len(document["devices"]) == 1 else f"{name} of {device['device']}"
            by_reason.setdefault(reason, []).append(words)
    return [f"{', '.join(names)}: {reason}" for reason, names in by_reason.items()]
