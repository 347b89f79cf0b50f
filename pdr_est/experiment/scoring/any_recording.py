"""How a walk of an experiment is scored: as its suite does, or by what its recording knows of the truth."""

import zlib
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from pdr_est.estimators.person.track import NAME as FUSED
from pdr_est.evaluate.heading_errors import HEADING_METRICS
from pdr_est.evaluate.held_out_fixes import WAYPOINT_SIGMA_M
from pdr_est.evaluate.position_errors import OPEN_METRICS
from pdr_est.evaluate.step_detection import STEP_METRICS
from pdr_est.experiment.config import FixesParams
from pdr_est.experiment.scoring.annotated_steps import heading_part, step_part
from pdr_est.experiment.scoring.positions import (
    HELDOUT_METRICS,
    HeldOut,
    position_parts,
    score_open,
    score_positions,
    score_waypoints,
)
from pdr_est.experiment.scoring.track_scores import (
    MODE_METRIC,
    MetricPart,
    device_scores,
    mode_part,
    person_scores,
    step_times_s,
)
from pdr_est.experiment.suite import AnalysedWalk, Scores, Suite, WalkFile, as_recorded
from pdr_est.frames import Array
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.track import Track

_NO_POSITIONS, _NO_STEPS = "the true positions are not known", "no annotated step"


@dataclass(frozen=True)
class HeldOutProtocol:
    """fixes: what the estimators get. seed, walk: of the errors of fixes on a walk whose truth has none."""

    fixes: FixesParams
    seed: int = 0
    walk: str = ""

    def held_out(self, truth: TruePositions) -> HeldOut | None:
        """Which points are given, for a walk with that truth."""
        if self.fixes.protocol == "none":
            return None
        own = self.fixes.protocol == "every"
        every, sigma_m = (self.fixes.every, self.fixes.sigma_m) if own else (HeldOut.every, HeldOut.sigma_m)
        if truth.sigma_m == 0.0:
            return HeldOut(every, sigma_m, 0.0, partial(_noise, self.seed, self.walk, sigma_m))
        return HeldOut(every, sigma_m, truth.sigma_m if own else WAYPOINT_SIGMA_M)


def knows_positions(suite: Suite) -> bool:
    """Whether the suite scores tracks by true positions, so that some of them can be fixes."""
    return suite.score in (score_open, score_waypoints)


def judged(suite: Suite | None, judge: HeldOutProtocol) -> Suite:
    """The suite with the experiment's fixes instead of its own; None is for recordings with their own truth.

    Metrics after a calibration on other walks are left out: here a walk is worked on alone.
    """
    held_out = HELDOUT_METRICS if judge.fixes.protocol != "none" else ()
    if suite is None:
        metrics = (*OPEN_METRICS, *held_out, MODE_METRIC, *STEP_METRICS, *HEADING_METRICS)
        return Suite("recordings", ".", metrics, _no_walk, as_recorded, partial(_score_known, judge=judge))
    metrics = tuple(name for name in suite.metrics if name not in suite.calibrated)
    if not knows_positions(suite):
        return replace(suite, metrics=metrics, calibrated_on=0, calibrated=())
    opened = tuple(name for name in metrics if name in OPEN_METRICS)
    others = tuple(name for name in metrics if name not in (*OPEN_METRICS, *HELDOUT_METRICS))
    return replace(suite, metrics=(*opened, *held_out, *others), score=partial(_score_positions, judge=judge))


def _score_positions(walk: AnalysedWalk, judge: HeldOutProtocol) -> list[Scores]:
    truth = walk.recording.truth.positions
    return score_positions(walk, None if truth is None else judge.held_out(truth))


def _score_known(walk: AnalysedWalk, judge: HeldOutProtocol) -> list[Scores]:
    """Every metric that the truth of the recording allows, of each device and of the person who carries several."""
    track = walk.track()
    scores = [
        device_scores(
            walk,
            device,
            mode_part(walk, device),
            *_known_parts(walk, device.device, step_times_s(device), track, judge),
        )
        for device in walk.devices
    ]
    if FUSED in track.devices:
        step_s = track.of_device(FUSED).time_s[1:]
        scores.append(person_scores(walk, *_known_parts(walk, FUSED, step_s, track, judge)))
    return scores


def _known_parts(
    walk: AnalysedWalk, name: str, step_s: Array, track: Track, judge: HeldOutProtocol
) -> list[MetricPart]:
    """Of one device, or of the person. step_s: (n,) times of the steps; track: of all, from the sensors only."""
    truth = walk.recording.truth
    parts: list[MetricPart] = []
    if truth.positions is None or not len(truth.positions.time_s):
        parts.append(MetricPart(missing=dict.fromkeys((*OPEN_METRICS, *HELDOUT_METRICS), _NO_POSITIONS)))
    else:
        parts += position_parts(walk, name, track, truth.positions, judge.held_out(truth.positions))
    if truth.steps is None or not len(truth.steps.time_s):
        parts.append(MetricPart(missing=dict.fromkeys((*STEP_METRICS, *HEADING_METRICS), _NO_STEPS)))
    else:
        parts += [step_part(walk, step_s), heading_part(walk, track.of_device(name))]
    return parts


def _no_walk(_folder: Path) -> list[WalkFile]:
    """`find` of what is no suite."""
    return []


def _noise(seed: int, walk: str, sigma_m: float, count: int) -> Array:
    """Errors (count, 2) of fixes, the same for every variant of a walk."""
    rng = np.random.default_rng([seed, zlib.crc32(walk.encode())])
    return sigma_m * rng.standard_normal((count, 2))
