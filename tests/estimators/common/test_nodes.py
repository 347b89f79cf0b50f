"""Nodes that are built step by step are those of the whole walk, whatever is forgotten on the way."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest
from estimator_walks import DEVICE, STEP_S, fix, heading_prior, step, straight
from hypothesis import given, settings
from hypothesis import strategies as st

from pdr_est.estimators.common.nodes import Node, NodeBuilder, sort_fixes
from pdr_est.estimators.common.timeline import build_timeline
from pdr_est.types.measurements import HeadingPrior, PositionFix, StepOdometry

times = st.floats(-1.0, 12.0) | st.sampled_from([STEP_S * k for k in range(24)])


def walk_with_pauses(rng: np.random.Generator, count: int) -> list[StepOdometry]:
    """Steps with pauses, some of which take no time."""
    steps, time_s = [], 0.0
    for k in range(1, count + 1):
        start_s = time_s + float(rng.choice([0.0, 0.0, 0.0, 1.5]))
        time_s = start_s + float(rng.choice([0.0, 0.5, 0.5, 0.5]))
        steps.append(replace(step(k), start_s=start_s, time_s=time_s))
    return steps


def same(one: Node, other: Node) -> bool:
    return repr(one) == repr(other)


@settings(max_examples=80, deadline=None)
@given(st.integers(0, 9999), st.lists(times, max_size=6), st.lists(times, max_size=4), st.lists(times, max_size=4))
def test_one_step_at_a_time_gives_the_nodes_of_the_whole_walk(
    seed: int, fixes_s: list[float], splits_s: list[float], priors_s: list[float]
) -> None:
    steps = walk_with_pauses(np.random.default_rng(seed), 12)
    fixes = [PositionFix(t, np.array([float(k), 0.0]), np.eye(2)) for k, t in enumerate(fixes_s)]
    priors = [HeadingPrior(DEVICE, t, 0.1 * k, 0.1) for k, t in enumerate(priors_s)]
    whole = build_timeline(DEVICE, 0.0, [*steps, *fixes, *priors], splits_s).nodes
    builder = NodeBuilder(0.0)
    for one in steps:
        builder.append(one)
    for prior in priors:
        builder.append(prior)
    ordered, splits = sort_fixes(fixes), sorted(splits_s)
    nodes = [builder.nodes_of(number, ordered, splits) for number in range(13)]
    for number in range(4, 13):  # numbers stay when steps are forgotten
        builder.forget(number - 1)
        nodes[number] = builder.nodes_of(number, ordered, splits)
    flat = [node for own in nodes for node in own]
    assert len(flat) == len(whole)
    assert all(map(same, flat, whole))
    information = sum(1.0 / float(one.covariance_m2[0, 0]) for node in flat for one in node.fixes)
    assert information == pytest.approx(len(fixes))  # each exactly once, those in quick succession averaged
    assert sum(len(node.priors) for node in flat) == len(priors)
    assert builder.count == 12
    assert builder.remembered <= 2


def test_a_fix_between_two_steps_that_take_no_time_is_used_once() -> None:
    steps = [step(1), replace(step(2), time_s=STEP_S, start_s=STEP_S), step(3)]
    nodes = build_timeline(DEVICE, 0.0, [*steps, fix(1, 0.0, 0.0)]).nodes
    assert [len(node.fixes) for node in nodes] == [0, 1, 0, 0]


@pytest.mark.parametrize(("known_until_s", "expected"), [(1.0, 0), (1.2, 1), (1.6, 2), (inf, 3)])
def test_fixes_after_the_last_step_wait_until_it_is_known_that_the_walker_stands(
    known_until_s: float, expected: int
) -> None:
    builder = NodeBuilder(0.0)
    for one in straight(2):
        builder.append(one)
    fixes = sort_fixes(fix(k / STEP_S, 0.0, 0.0) for k in (1.2, 1.6, 9.0))
    assert len(builder.standing_fixes(2, fixes, known_until_s)) == expected
    (node,) = builder.nodes_of(2, fixes, (), known_until_s)
    assert len(node.fixes) == expected
    builder.append(replace(step(4), start_s=1.4))  # the walker goes on before the second of them
    assert len(builder.standing_fixes(2, fixes)) == 1


def test_fixes_of_one_time_are_used_in_the_same_order_offline_and_online() -> None:
    fixes = [fix(1, float(k), 0.0) for k in range(3)]
    (_, node) = build_timeline(DEVICE, 0.0, [step(1), *fixes]).nodes
    assert node.fixes == sort_fixes(fixes)
    assert [one.position_m[0] for one in node.fixes] == [2.0, 1.0, 0.0]


def test_the_first_step_may_move_the_start_and_a_prior_there_belongs_to_it() -> None:
    builder = NodeBuilder(0.0)
    builder.append(replace(step(1), time_s=-0.02, start_s=-0.4))
    builder.append(heading_prior(-0.04, 0.3))
    assert builder.step_end_s(0) == -0.02
    (start,), (first,) = builder.nodes_of(0), builder.nodes_of(1)
    assert len(start.priors) == 1
    assert not first.priors


def test_heading_is_observed_by_fixes_and_absolute_priors_only() -> None:
    node = build_timeline(DEVICE, 0.0, [step(1)]).nodes[1]
    relative, absolute = (HeadingPrior(DEVICE, STEP_S, 0.0, 0.1, relative=r) for r in (True, False))
    assert not node.observes_heading
    assert not replace(node, priors=(relative,)).observes_heading
    assert replace(node, priors=(relative, absolute)).observes_heading
    assert replace(node, fixes=(fix(1, 0.0, 0.0),)).observes_heading
