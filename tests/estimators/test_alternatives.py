"""Alternatives of a walk: turns and start headings that the measurements leave open, in estimators that smooth."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import DEVICE, fix, run, simulate, straight

from pdr_est.estimators import timelines_of
from pdr_est.estimators.alternatives import Alternative, alternatives_of, estimate_alternatives
from pdr_est.estimators.common.timeline import Timeline, build_timeline, track_from_nodes
from pdr_est.estimators.factor_graph.smoother import estimate
from pdr_est.types.findings import FindingKind
from pdr_est.types.measurements import (
    DeviceMeasurements,
    HeadingPrior,
    Measurement,
    PositionFix,
    StartPose,
    StepOdometry,
    TurnHypothesis,
)
from pdr_est.types.track import Track

KNOWN = StartPose((0.0, 0.0), 0.0, 0.1, 0.05)
UNTURNED = StartPose((0.0, 0.0), None, sigma_position_m=0.1)
QUIET = np.diag([0.005, 0.005, 1e-4])
CORNER = (TurnHypothesis(0.6, 0.0, 0.05, "straight on"), TurnHypothesis(0.4, np.pi / 2, 0.05, "corner"))
NORTH_ONLY = PositionFix(10.0, np.array([0.0, 7.0]), np.diag([50.0, 0.5]) ** 2)


def with_corner(steps: Sequence[StepOdometry], number: int = 10) -> list[StepOdometry]:
    """Put the phone elsewhere before a step."""
    turned = replace(steps[number], turn_hypotheses=CORNER, covariance=np.diag([0.005, 0.005, 0.6]))
    return [*steps[:number], turned, *steps[number + 1 :]]


def around_a_corner(*others: Measurement) -> list[Measurement]:
    return [*with_corner(straight(20, 0.7, QUIET)), *others]


def timeline(measurements: Sequence[Measurement]) -> Timeline:
    return build_timeline(DEVICE, 0.0, measurements)


def smoothed(measurements: Sequence[Measurement], start: StartPose, sigma_scale: float) -> Track:
    """Smooth a walk with its fixes as they are, without a comparison with the steps."""
    alternatives = alternatives_of([timeline(measurements)], start, sigma_scale)
    return estimate_alternatives(
        alternatives, lambda one: estimate(one.timelines, [], start, sigma_scale, one.start_headings_rad)
    )


def kinds(track: Track) -> list[FindingKind]:
    return [finding.kind for finding in track.findings]


def test_a_walk_without_doubt_has_one_alternative_that_is_itself() -> None:
    walk = timeline([*straight(20), fix(15, 10.0, 1.0)])
    (one,) = alternatives_of([walk], KNOWN, 0.1)
    assert one == Alternative(1.0, (walk,), (None,), ((),))


def test_alternatives_have_their_turns_and_probabilities() -> None:
    first, second = alternatives_of([timeline(around_a_corner())], KNOWN, 0.1)
    assert (first.probability, second.probability) == pytest.approx((0.6, 0.4))
    for one, turn in zip((first, second), CORNER, strict=True):
        node = one.timelines[0].nodes[11]
        assert node.heading_change_rad == turn.heading_change_rad
        assert node.covariance[2, 2] == pytest.approx(turn.sigma_rad**2)
        assert not node.turn_hypotheses
        assert one.start_headings_rad == (None,)


@pytest.mark.parametrize("truth", [(14.0, 0.0), (7.0, 7.0)])
def test_later_fixes_decide_for_the_right_turn(truth: tuple[float, float]) -> None:
    """And the smoothed track goes there from the turn on, without a word."""
    fixes = [fix(20, *truth, sigma_m=0.5)]
    (one,) = alternatives_of([timeline(around_a_corner(*fixes))], KNOWN, 0.1)
    assert one.probability == 1.0
    track = run("factor-graph", around_a_corner(*fixes), KNOWN)
    half = 0.5 * np.add(truth, (7.0, 0.0))
    assert track.position_m[15] == pytest.approx(half, abs=0.4)
    assert track.sigma_heading_rad[15] < 0.15
    assert FindingKind.PLACEMENT not in kinds(track)


def test_an_open_turn_is_told_and_covered() -> None:
    track = run("factor-graph", around_a_corner(), KNOWN)
    assert track.position_m[-1] == pytest.approx([14.0, 0.0], abs=0.1)
    off = np.array([7.0, 7.0]) - track.position_m[-1]
    assert off @ np.linalg.solve(track.covariance_m2[-1], off) < 5.99
    assert track.sigma_heading_rad[-1] == pytest.approx(np.sqrt(0.4) * np.pi / 2, rel=0.05)
    assert track.sigma_heading_rad[9] < 0.15  # before it, nothing is open
    (finding,) = [one for one in track.findings if one.kind is FindingKind.PLACEMENT]
    assert finding.message.startswith(f"{DEVICE}: after the phone was put elsewhere at 6 s")
    assert "probability of 60%" in finding.message
    assert finding.value == pytest.approx(0.6)
    assert finding.device == DEVICE


def test_a_turn_that_is_too_slight_to_be_an_alternative_is_covered() -> None:
    """One walk in a hundred went anywhere."""
    steps = straight(20, 0.7, QUIET)
    unusual = TurnHypothesis(0.01, 0.0, np.pi / np.sqrt(3.0), "unusual")
    turns = (replace(CORNER[0], probability=0.99), unusual)
    steps[10] = replace(steps[10], turn_hypotheses=turns, covariance=np.diag([0.005, 0.005, 0.04]))
    (one,) = alternatives_of([timeline(steps)], KNOWN, 0.1)
    assert one.timelines[0].nodes[11].covariance[2, 2] == pytest.approx(0.05**2 + 0.01 * np.pi**2 / 3.0)
    assert run("factor-graph", steps, KNOWN).findings == ()


def test_many_improbable_courses_are_covered_together() -> None:
    """Two changes with three unlikely turns each: 16 courses, of which four are smoothed."""
    turns = tuple(
        TurnHypothesis(probability, turn_rad, 0.02, "turn")
        for probability, turn_rad in ((0.91, 0.0), (0.03, 1.0), (0.03, -1.0), (0.03, 2.0))
    )
    steps = straight(30, 0.7, QUIET)
    for number in (10, 20):
        steps[number] = replace(steps[number], turn_hypotheses=turns, covariance=np.diag([0.005, 0.005, 0.2]))
    second_moment = 2.0 * 0.03 * (1.0 + 1.0 + 4.0)
    track = smoothed(steps, KNOWN, 0.1)
    assert track.sigma_heading_rad[-1] == pytest.approx(np.sqrt(second_moment), rel=0.12)


def test_each_of_two_open_turns_is_told() -> None:
    steps = with_corner(with_corner(straight(30, 0.7, QUIET), 10), 20)
    alternatives = alternatives_of([timeline(steps)], KNOWN, 0.1)
    assert [one.probability for one in alternatives] == pytest.approx([0.36, 0.24, 0.24, 0.16])
    track = run("factor-graph", steps, KNOWN)
    assert [one.begin_s for one in track.findings if one.kind is FindingKind.PLACEMENT] == [5.5, 10.5]


def constant(one: Alternative, north_m: float, heading_rad: float) -> Track:
    count = len(one.timelines[0].nodes)
    position = np.column_stack([np.arange(count), np.full(count, north_m)])
    covariance = np.tile(np.diag([0.5, 0.5, 0.01]), (count, 1, 1))
    return track_from_nodes(one.timelines[0], position, np.full(count, heading_rad), covariance, "smoothed", "own")


def test_tracks_are_put_together_as_a_mixture_about_the_most_probable() -> None:
    alternatives = alternatives_of([timeline(around_a_corner())], KNOWN, 0.1)
    places = {0.6: (0.0, 3.0), 0.4: (5.0, -3.0)}  # headings on both sides of the cut
    track = estimate_alternatives(alternatives, lambda one: constant(one, *places[round(one.probability, 3)]))
    assert (track.position_m[:, 1] == 0.0).all()
    assert track.covariance_m2 == pytest.approx(np.tile(np.diag([0.5, 0.5 + 0.4 * 25.0]), (len(track), 1, 1)))
    turned = 2.0 * np.pi - 6.0
    assert track.sigma_heading_rad == pytest.approx(np.full(len(track), np.sqrt(0.01 + 0.4 * turned**2)))


def test_fixes_that_fit_two_start_headings_give_both() -> None:
    """The walker went 14 m, and 7 m of them to the north."""
    measurements = [*straight(20, 0.7, QUIET), NORTH_ONLY]
    alternatives = alternatives_of([timeline(measurements)], UNTURNED, 0.02)
    assert [one.probability for one in alternatives] == pytest.approx([0.5, 0.5], abs=0.05)
    headings = sorted(float(one.start_headings_rad[0] or 0.0) for one in alternatives)
    assert headings == pytest.approx([np.pi / 6, np.pi * 5 / 6], abs=0.15)
    track = smoothed(measurements, UNTURNED, 0.02)
    assert abs(track.position_m[-1, 0]) == pytest.approx(14.0 * np.cos(np.pi / 6), abs=0.5)
    other = track.position_m[-1] * [-2.0, 0.0]
    assert other @ np.linalg.solve(track.covariance_m2[-1], other) < 5.99
    assert track.sigma_heading_rad[0] > 1.0
    (finding,) = [one for one in track.findings if one.kind is FindingKind.START_HEADING]
    assert "the measurements fit several start headings" in finding.message
    assert "give a start heading, or one more fix" in finding.message


def test_start_headings_go_with_the_turns_of_their_alternative() -> None:
    """The start heading is open as well as a turn; together with its turn each leads to where the fix is."""
    at = PositionFix(10.0, np.array([7.0, 7.0]), np.diag([0.5, 0.5]) ** 2)
    alternatives = alternatives_of([timeline(around_a_corner(at))], UNTURNED, 0.3)
    for one in alternatives:
        nodes, heading_rad = one.timelines[0].nodes, one.start_headings_rad[0]
        assert heading_rad is not None
        headings = heading_rad + np.cumsum([node.heading_change_rad for node in nodes])
        end = sum(node.length_m * np.exp(1j * h) for node, h in zip(nodes, headings, strict=True))
        assert np.angle(end / (7.0 + 7.0j)) == pytest.approx(0.0, abs=0.15)
    assert len({node.timelines[0].nodes[11].heading_change_rad for node in alternatives}) == 2


def test_one_more_fix_decides_between_two_start_headings() -> None:
    measurements = [*straight(20, 0.7, QUIET), NORTH_ONLY, fix(12, -7.3, 4.2)]
    (one,) = alternatives_of([timeline(measurements)], UNTURNED, 0.02)
    assert one.start_headings_rad == pytest.approx((np.pi * 5 / 6,), abs=0.15)
    track = smoothed(measurements, UNTURNED, 0.02)
    assert track.position_m[-1, 0] == pytest.approx(-14.0 * np.cos(np.pi / 6), abs=0.7)
    assert FindingKind.START_HEADING not in kinds(track)


def test_a_heading_of_which_little_is_known_is_no_alternative() -> None:
    """A vague fix leaves headings all round: they are one wide distribution, and nothing is put together."""
    alternatives = alternatives_of([timeline([*straight(20, 0.7, QUIET), fix(20, 1.0, 2.0, 30.0)])], UNTURNED, 0.02)
    assert len(alternatives) == 1


def test_a_turn_stays_decided_when_the_heading_is_lost_later() -> None:
    """A fix decides the corner; after a gap nothing is known of the heading, until two more fixes find it."""
    steps = with_corner(straight(60, 0.7, QUIET))
    steps[30] = replace(steps[30], covariance=np.diag([0.1, 0.1, 2.0]))
    fixes = [fix(20, 7.0, 7.0), fix(40, 0.0, 14.0), fix(60, -14.0, 14.0)]
    (one,) = alternatives_of([timeline([*steps, *fixes])], KNOWN, 0.1)
    node = one.timelines[0].nodes[11]
    assert node.heading_change_rad == CORNER[1].heading_change_rad
    assert not node.turn_hypotheses


def test_alternatives_of_devices_are_combined() -> None:
    steps = straight(20, 0.7, QUIET)
    second = [replace(one, device="b") for one in with_corner(steps)]
    devices = [
        DeviceMeasurements(DEVICE, 0.0, tuple(with_corner(steps))),
        DeviceMeasurements("b", 0.0, tuple(second)),
    ]
    alternatives = alternatives_of(timelines_of(devices), KNOWN, 0.1)
    assert [one.probability for one in alternatives] == pytest.approx([0.36, 0.24, 0.24, 0.16])
    assert len({tuple(t.nodes[11].heading_change_rad for t in one.timelines) for one in alternatives}) == 4


@pytest.mark.parametrize("device_b", [False, True])
def test_at_most_four_alternatives_are_smoothed_and_their_probabilities_add_up(device_b: bool) -> None:
    steps = straight(40, 0.7, QUIET)
    for number in (10, 20, 30) if device_b else (10, 20):
        steps = with_corner(steps, number)
    devices = [DeviceMeasurements(DEVICE, 0.0, tuple(steps))]
    if device_b:
        devices.append(DeviceMeasurements("b", 0.0, tuple(replace(one, device="b") for one in steps)))
    alternatives = alternatives_of(timelines_of(devices), KNOWN, 0.1)
    assert len(alternatives) <= 4
    if device_b:
        assert sum(len(turns) for turns in alternatives[0].open_turns) == 6
    assert sum(one.probability for one in alternatives) == pytest.approx(1.0)
    assert not any(node.turn_hypotheses for one in alternatives for t in one.timelines for node in t.nodes)


def test_more_open_turns_than_can_be_smoothed_one_by_one_are_covered_all_the_same() -> None:
    """Five corners, 32 walks: each turn has its probability and the spread of its hypotheses about the chosen one."""
    steps = straight(60, 0.7, QUIET)
    for number in (10, 20, 30, 40, 50):
        steps = with_corner(steps, number)
    (one,) = alternatives_of([timeline(steps)], KNOWN, 0.1)
    turns = [one.timelines[0].nodes[number + 1] for number in (10, 20, 30, 40, 50)]
    assert [node.heading_change_rad for node in turns] == [0.0] * 5
    second_moment = 0.05**2 + 0.4 * (np.pi / 2) ** 2
    assert [node.covariance[2, 2] for node in turns] == pytest.approx([second_moment] * 5, rel=0.05)
    track = run("factor-graph", steps, KNOWN)
    assert track.sigma_heading_rad[-1] == pytest.approx(np.sqrt(5.0 * second_moment), rel=0.1)
    found = [finding for finding in track.findings if finding.kind is FindingKind.PLACEMENT]
    assert [finding.begin_s for finding in found] == [5.5, 10.5, 15.5, 20.5, 25.5]
    assert [finding.value for finding in found] == pytest.approx([0.6] * 5, abs=0.03)


def test_a_heading_prior_decides_a_turn() -> None:
    prior = HeadingPrior(DEVICE, 8.0, np.pi / 2 + 0.1, 0.2)
    (one,) = alternatives_of([timeline(around_a_corner(prior))], KNOWN, 0.1)
    assert one.timelines[0].nodes[11].heading_change_rad == CORNER[1].heading_change_rad


@pytest.mark.parametrize("seed", range(6))
def test_the_mixture_covers_the_true_walk(seed: int) -> None:
    """Whichever way the walker went, by its prior probability; nothing decides."""
    rng = np.random.default_rng(seed)
    walk = simulate(rng, np.zeros(20), covariance=QUIET)
    chosen = CORNER[int(rng.random() < 0.4)]
    rotation = np.exp(1j * chosen.heading_change_rad)
    truth = walk.truth[:, 0] + 1j * walk.truth[:, 1]
    truth[11:] = truth[10] + rotation * (truth[11:] - truth[10])
    track = run("factor-graph", with_corner(walk.odometry), KNOWN)
    off = track.position_m[-1] - [truth[-1].real, truth[-1].imag]
    assert off @ np.linalg.solve(track.covariance_m2[-1], off) < 9.2
