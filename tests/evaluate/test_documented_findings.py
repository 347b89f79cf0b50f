"""docs/consistency.md has a sentence of every kind of finding as the program says it, apart from the numbers."""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from broken_fixes import corridor_turns, gps_fixes, surveyed_points
from estimator_walks import DEVICE, SIGMA_SCALE, fix, heading_prior, run, simulate, step, straight, usual_covariance

from pdr_est.estimators import SPECS, EstimatorName
from pdr_est.evaluate.walk_findings import findings_of
from pdr_est.frames import Array
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.floor_plan import FloorPlan, WalkableArea
from pdr_est.types.measurements import (
    DeviceMeasurements,
    DeviceTether,
    LoopClosure,
    Measurement,
    PositionFix,
    StartPose,
    StepOdometry,
    TurnHypothesis,
)
from pdr_est.types.track import concatenate

PAGE = Path(__file__).parents[2] / "docs" / "consistency.md"
ROW = re.compile(r"^\| `(?P<kind>[a-z-]+)` \| \*(?P<sentence>.+)\* \|$", re.MULTILINE)
NUMBER = re.compile(r"-?\d+(\.\d+)?")
UNKNOWN = StartPose()
KNOWN = StartPose((0.0, 0.0), 0.0, 0.3, 0.05)


def found(
    measurements: list[Measurement], start: StartPose = UNKNOWN, name: EstimatorName = "factor-graph"
) -> list[Finding]:
    track = run(name, measurements, start)
    device = DeviceMeasurements(DEVICE, 0.0, tuple(measurements))
    return [*track.findings, *findings_of(track, [device], [], start, SIGMA_SCALE, SPECS[name])]


def corridors(number: int, covariance: Array | None = None) -> tuple[list[StepOdometry], list[PositionFix], Array]:
    rng = np.random.default_rng([number, 9])
    walk = simulate(rng, corridor_turns(rng), covariance=covariance)
    return walk.odometry, surveyed_points(rng, walk.truth), walk.truth


def with_wrong_fixes() -> list[Finding]:
    steps, fixes, _ = corridors(1)
    moved = replace(fixes[2], position_m=fixes[2].position_m + np.array([0.0, 30.0]))
    return found([*steps, *fixes[:2], moved, *fixes[3:]])


def with_wrong_clock() -> list[Finding]:
    steps, fixes, _ = corridors(1)
    return found([*steps, *(replace(one, time_s=one.time_s + 4.0) for one in fixes)])


def with_wrong_accuracy() -> list[Finding]:
    rng = np.random.default_rng([12, 5])
    walk = simulate(rng, corridor_turns(rng))
    fixes = gps_fixes(rng, walk.truth)
    return found(
        [
            *walk.odometry,
            *(
                replace(one, covariance_m2=one.covariance_m2 / 16.0, sigma_wander_m=one.sigma_wander_m / 4.0)
                for one in fixes
            ),
        ]
    )


def with_worse_steps() -> list[Finding]:
    every = []
    for number in range(12):
        steps, _, truth = corridors(number, 36.0 * usual_covariance(0.7))
        rng = np.random.default_rng(number)
        usual = [replace(one, covariance=usual_covariance(0.7)) for one in steps]
        near = [fix(k, *(truth[k, :2] + rng.normal(0.0, 0.3, 2)), 0.3) for k in range(0, len(truth), 4)]
        every += found([*usual, *near])
        if any(one.kind == FindingKind.STEPS for one in every):
            break
    return every


def with_wrong_heading() -> list[Finding]:
    steps, fixes, _ = corridors(1)
    return found([*steps, *fixes], StartPose((0.0, 0.0), np.radians(170.0), 0.5, np.radians(5.0)))


def with_wrong_length() -> list[Finding]:
    rng = np.random.default_rng(8)
    walk = simulate(rng, corridor_turns(rng), scale=1.5)
    return found([*walk.odometry, *surveyed_points(rng, walk.truth)], StartPose((0.0, 0.0), 0.0, 0.1, 0.05))


def with_wrong_closure() -> list[Finding]:
    turns = np.repeat([0.0, np.pi / 2.0, 0.0], [20, 1, 20])
    walk: list[Measurement] = [step(k, 0.7, turn) for k, turn in enumerate(turns, 1)]
    return found([*walk, LoopClosure(DEVICE, 0.5)], KNOWN)


def with_wrong_north() -> list[Finding]:
    return found([*straight(30), *(heading_prior(k, 1.0, 0.2) for k in range(1, 30, 5))], KNOWN)


def with_another_place() -> list[Finding]:
    turns = (TurnHypothesis(0.7, 0.0, 0.1, "straight on"), TurnHypothesis(0.3, 1.6, 0.1, "axis"))
    walk = straight(20)
    walk[9] = replace(walk[9], turn_hypotheses=turns)
    return found(list(walk), KNOWN)


def with_a_long_tether() -> list[Finding]:
    first = run("factor-graph", straight(20), KNOWN)
    other = replace(
        first, device=np.array(["watch"] * len(first)), position_m=first.position_m + np.array([0.0, 9.0])
    )
    tethers = [DeviceTether(DEVICE, "watch", float(time_s), 2.0, 0.3) for time_s in first.time_s]
    both = concatenate([first, other])
    return list(findings_of(both, [], tethers, StartPose(), SIGMA_SCALE, SPECS["factor-graph"]))


def with_another_plan() -> list[Finding]:
    """A walk of 35 m through rooms of 3 m."""
    corners = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]])
    rooms = [WalkableArea(corners + np.array([4.0 * i, 4.0 * j - 10.0])) for i in range(10) for j in range(6)]
    plan = FloorPlan("mall.geojson", tuple(rooms), np.zeros((0, 2, 2)), 0.2)
    return found([*straight(50), plan], StartPose((2.0, 0.0), 0.0, 0.2, 0.05), "particle")


CASES = {
    "fixes": with_wrong_fixes,
    "fix-accuracy": with_wrong_accuracy,
    "steps": with_worse_steps,
    "fix-clock": with_wrong_clock,
    "start-heading": with_wrong_heading,
    "length-scale": with_wrong_length,
    "closure": with_wrong_closure,
    "tether": with_a_long_tether,
    "placement": with_another_place,
    "north": with_wrong_north,
    "plan": with_another_plan,
}


def documented() -> Iterator[tuple[str, str]]:
    for row in ROW.finditer(PAGE.read_text(encoding="utf-8")):
        yield row["kind"], row["sentence"]


def without_numbers(sentence: str) -> str:
    return NUMBER.sub("#", sentence)


def test_every_kind_has_a_sentence_and_a_meaning() -> None:
    kinds = [kind.value for kind in FindingKind]
    assert [kind for kind, _ in documented()] == kinds == list(CASES)
    meanings = re.findall(r"^\| `([a-z-]+)` \| (?!\*)", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert meanings == kinds


@pytest.mark.parametrize("kind", CASES)
def test_the_sentence_is_what_the_program_says(kind: str) -> None:
    said = {without_numbers(one.words) for one in CASES[kind]() if one.kind == kind}
    assert without_numbers(dict(documented())[kind]) in said
