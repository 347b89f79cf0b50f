"""Position fixes of one moment that contradict each other are told, offline and online."""

from dataclasses import replace

import numpy as np
from estimator_walks import fix

from pdr_est.evaluate.walk_findings.contradictions import ContradictionsSoFar, contradictions
from pdr_est.evaluate.walk_findings.so_far import FindingsSoFar
from pdr_est.types.measurements import PositionFix


def pair(apart_m: float) -> list[PositionFix]:
    return [fix(0, 0.0, 0.0), fix(20, 14.0, 0.0), fix(20, 14.0, apart_m), fix(40, 28.0, 0.0)]


def test_two_places_at_one_time_are_told_with_their_distance() -> None:
    (found,) = contradictions(pair(12.0))
    assert found.doubtful
    assert found.begin_s == found.end_s == 10.0
    assert found.value == 12.0
    assert "12.0 m apart" in found.message


def test_what_the_errors_allow_and_repetitions_are_no_contradictions() -> None:
    assert contradictions(pair(1.5)) == []
    assert contradictions(pair(0.0)) == []
    elsewhere = [fix(0, 0.0, 0.0), fix(20, 14.0, 0.0)]  # of different moments
    assert contradictions(elsewhere) == []


def test_a_wandering_error_is_common_to_one_source_only() -> None:
    one = replace(fix(20, 0.0, 0.0), source="gps", sigma_wander_m=20.0)
    other = replace(one, position_m=np.array([12.0, 0.0]))
    assert len(contradictions([one, other])) == 1
    assert contradictions([one, replace(other, source="network")]) == []


def test_chance_hardly_ever_is_a_contradiction() -> None:
    rng = np.random.default_rng(3)
    told = 0
    for _ in range(400):
        ends = [replace(fix(k, 0.0, 0.0, 1.0), position_m=rng.standard_normal(2)) for k in range(6) for _ in (0, 1)]
        so_far = ContradictionsSoFar()
        told += bool(contradictions(ends)) + any(so_far.add(one) is not None for one in ends)
    assert told <= 24


def test_online_it_is_told_once_at_the_next_update() -> None:
    so_far = FindingsSoFar(0.06)
    for one in pair(12.0):
        so_far.add_fix(one)
    (found,) = so_far.add([], 1.0)
    assert "contradict each other" in found.message
    assert so_far.add([], 1.0) == []
