"""Metrics after learning from the other walks of a person: which walks teach, and that none teaches itself."""

import math
from dataclasses import replace

import numpy as np
import pytest
from result_rows import result_row

from pdr_est.calibration.step_length_fit import SIGMA_LOG_SCALE, SIGMA_WALK, ScaleObservation, fit_calibration
from pdr_est.experiment.scoring.profiles import (
    PROFILE_METRICS,
    SIGMA_OF_SEVERAL,
    PositionCase,
    person_or_folder,
    uppermost_folder,
    with_profiles,
)
from pdr_est.types.outcome import TrackOutcome

ATE, RATIO, COVERED = PROFILE_METRICS
TRUTH_M = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]])


def row(walk: str, person: str = "ann", variant: str = "X", track: str = "device") -> TrackOutcome:
    return result_row(walk, variant, {ATE: None}, track, {"person": person})


def case(scale: float, seen: bool = True) -> PositionCase:
    """A walk whose true scale is that, at one cadence, and whose fixes tell it exactly or not at all."""
    observation = ScaleObservation(math.log(scale), 0.0, 0.6) if seen else None
    return PositionCase(observation, 0.6, TRUTH_M / scale, TRUTH_M, 1.0 / scale)


def shrunk(scales: list[float], sigma_walk: float = SIGMA_WALK) -> float:
    """The normal prior times the walks, by hand."""
    information = len(scales) / sigma_walk**2
    return math.exp(information / (information + SIGMA_LOG_SCALE**-2) * float(np.mean(np.log(scales))))


def test_a_walk_learns_from_the_other_walks_of_its_person_only() -> None:
    rows = [row("s/a"), row("s/b"), row("s/c"), row("s/d", "bob"), row("t/e"), row("s/b", variant="Y")]
    cases = [case(scale) for scale in (1.2, 1.25, 1.1, 0.8, 0.7, 0.6)]
    completed, missing = with_profiles(rows, cases, person_or_folder)
    assert completed[0].metrics[RATIO] == pytest.approx(shrunk([1.25, 1.1]) / 1.2)
    assert completed[1].metrics[RATIO] == pytest.approx(shrunk([1.2, 1.1]) / 1.25)
    assert sorted(missing) == ["s/b", "s/d", "t/e"]  # s/b of the other variant has nobody
    assert missing["s/d"].endswith("no other walk of s/bob to learn from")
    assert completed[3].metrics == {ATE: None}


def test_a_walk_that_tells_nothing_is_scored_and_teaches_nobody() -> None:
    completed, missing = with_profiles(
        [row("s/a"), row("s/b"), row("s/c")], [case(1.2, seen=False), case(1.1), None], person_or_folder
    )
    assert completed[0].metrics[RATIO] == pytest.approx(shrunk([1.1]) / 1.2)
    assert list(missing) == ["s/b"]


def test_its_own_truth_never_teaches_a_walk() -> None:
    """However the walk's own scale is, the learnt one is the same."""
    for own in (0.7, 1.0, 1.4):
        completed, _ = with_profiles([row("s/a"), row("s/b")], [case(own), case(1.1)], person_or_folder)
        assert completed[0].metrics[RATIO] == pytest.approx(shrunk([1.1]) / own)


def test_the_error_is_that_of_the_scaled_track() -> None:
    learnt = fit_calibration([ScaleObservation(math.log(1.2), 0.0, 0.6)] * 1000)
    right = case(1.2).errors(learnt)
    assert right[ATE] == pytest.approx(0.0, abs=1e-3)
    assert right[RATIO] == pytest.approx(1.0, abs=1e-4)
    assert right[COVERED] == 1.0
    wrong = case(1.5).errors(learnt)
    spread_m = math.sqrt(np.square(TRUTH_M - TRUTH_M.mean(axis=0)).sum(axis=1).mean())
    assert wrong[ATE] == pytest.approx((1.0 - 1.2 / 1.5) * spread_m, rel=1e-3)
    assert wrong[COVERED] == 0.0
    quick = replace(case(1.2), log_cadence=0.8).errors(learnt)
    assert quick[RATIO] == pytest.approx(math.exp(0.2 * learnt.mean[1]), rel=1e-3)


def test_who_belongs_together() -> None:
    assert person_or_folder(row("s/x/a")) == person_or_folder(row("s/y/b"))
    assert person_or_folder(row("a")) is not None
    unknown = person_or_folder(row("s/a", "unknown"))
    assert unknown is not None
    assert (unknown.name, unknown.sigma_walk) == ("s", SIGMA_OF_SEVERAL)
    assert person_or_folder(row("a", "unknown")) is None
    site = uppermost_folder(row("site1/F1/a"))
    assert site is not None
    assert (site.name, site.sigma_walk) == ("site1", SIGMA_OF_SEVERAL)
    assert uppermost_folder(row("a")) is None
