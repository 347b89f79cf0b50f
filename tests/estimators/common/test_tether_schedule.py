"""Tether times: multiples of an interval on the common clock, the same for growing recordings and for whole ones."""

from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.tether_schedule import TetherSchedule
from pdr_est.estimators.common.tethers import TetherParams, node_tethers_between, tethers_between
from pdr_est.estimators.common.timeline import Timeline, build_timeline
from pdr_est.types.measurements import DeviceTether, StepOdometry


def schedule_of(*spans_s: tuple[float, float] | None, interval_s: float | None = 2.0) -> TetherSchedule:
    schedule = TetherSchedule(interval_s)
    schedule.spans_s = list(spans_s)
    return schedule


def test_tethers_lie_at_multiples_while_both_devices_record() -> None:
    schedule = schedule_of((0.5, 9.0), (3.0, 12.0), (0.0, 1.0))
    assert schedule.times_of((0, 1)) == [4.0, 6.0, 8.0]
    assert schedule.times_of((0, 2)) == []
    assert schedule.times_between(3.9, 6.0) == [4.0, 6.0]
    assert schedule.times_between(9.1, 20.0) == []


@pytest.mark.parametrize("at_end", [False, True])
def test_the_end_of_a_common_walk_is_tethered_on_request(at_end: bool) -> None:
    tethers = tethers_between({"a": (0.0, 5.0), "b": (1.0, 7.0)}, TetherParams(), at_end)
    assert [tether.time_s for tether in tethers] == [2.0, 4.0, *[5.0] * at_end]
    assert tethers_between({"a": (0.0, 1.0), "b": (2.0, 3.0)}, TetherParams(), at_end) == []


def test_devices_without_tethers_have_none() -> None:
    schedule = schedule_of((0.0, 9.0), (0.0, 9.0), interval_s=None)
    assert schedule.times_of((0, 1)) == []
    assert schedule.times_between(0.0, 9.0) == []
    assert schedule.due(0, 9.0, inf) == ([], 0)
    assert schedule_of(None, None).due(3, -inf, inf) == ([], 3)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 9999), st.integers(2, 4), st.sampled_from([0.5, 2.0, 3.1]))
def test_growing_recordings_give_the_tethers_of_whole_ones(seed: int, devices: int, interval_s: float) -> None:
    rng = np.random.default_rng(seed)
    spans_s = {str(d): tuple(np.sort(rng.uniform(-5.0, 15.0, 2))) for d in range(devices)}
    whole = sorted(
        (t.time_s, t.device_a, t.device_b) for t in tethers_between(spans_s, TetherParams(every_s=interval_s))
    )
    schedule, known = schedule_of(*[None] * devices, interval_s=interval_s), set[tuple[float, str, str]]()
    for _ in range(60):
        device = int(rng.integers(devices))
        begin_s, end_s = spans_s[str(device)]
        first_new_s = schedule.extend(device, begin_s, float(rng.uniform(begin_s, end_s)))
        pairs = [(a, b) for a in range(devices) for b in range(a + 1, devices)]
        now = {(t, str(a), str(b)) for a, b in pairs for t in schedule.times_of((a, b))}
        assert known <= now  # tethers never vanish
        assert first_new_s == min((t for t, _, _ in now - known), default=inf)
        known = now
    for device in range(devices):
        schedule.extend(device, *spans_s[str(device)])
    found, number = [], -100
    for before_s in (*np.sort(rng.uniform(-5.0, 15.0, 6)), inf):
        due, number = schedule.due(number, min(before_s, 15.0), before_s)
        found += due
    assert [(str(a), str(b)) for a, b in found] == [(a, b) for _, a, b in whole]


def line(device: str, count: int) -> Timeline:
    steps = [StepOdometry(device, float(k), k - 1.0, 0.7, 0.0, 0.01 * np.eye(3)) for k in range(1, count + 1)]
    return build_timeline(device, 0.0, steps)


def test_a_tether_joins_the_last_nodes_up_to_its_time() -> None:
    tethers = [DeviceTether("a", "b", t, 0.5, 0.02) for t in (2.0, -1.0, 1.5, 9.0)]
    found = node_tethers_between([line("a", 3), line("b", 5)], tethers)
    assert [(one.time_s, one.node_a, one.node_b) for one in found] == [(1.5, 1, 1), (2.0, 2, 2), (9.0, 3, 5)]


@pytest.mark.parametrize(("names", "ends"), [("aa", "aa"), ("ab", "ac"), ("ab", "aa")])
def test_names_that_do_not_fit_are_refused(names: str, ends: str) -> None:
    with pytest.raises(EstimationError, match=r"name of its own|name two of \['a', 'b'\]"):
        node_tethers_between([line(name, 2) for name in names], [DeviceTether(*ends, 1.0, 0.5, 0.02)])
