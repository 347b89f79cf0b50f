"""States of a tracker are data: damaged, foreign and hostile ones are refused, and nothing in them is executed."""

import json
import os
import pickle
import zlib
from collections import OrderedDict, defaultdict, deque
from contextlib import suppress
from functools import cache
from hashlib import sha256
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from two_phones import KNOWN_START, recorded, slices, tracker_of

from pdr_est.errors import EstimationError
from pdr_est.online import Tracker
from pdr_est.online.saved_state import pack, unpack
from pdr_est.types.steps import CarryingMode


@cache
def saved() -> bytes:
    """Return the state of a tracker in the middle of a walk."""
    recording = recorded(1, short=True)
    tracker = tracker_of(recording, KNOWN_START)
    for name, block in slices(recording, [np.arange(1.0, 7.0)]):
        tracker.push(name, block)
    return tracker.state()


def parts_of_state() -> tuple[bytes, dict[str, Any], list[Any]]:
    """Return mark, header and table of objects of a state."""
    mark, _, header, body = saved().split(b"\n", 3)
    return mark, json.loads(header), json.loads(zlib.decompress(body))


def state_of(header: Any, table: Any) -> bytes:
    """Write a state that differs from a real one in its header or table, with the right checksum."""
    content = json.dumps(header).encode() + b"\n" + zlib.compress(json.dumps(table).encode())
    return b"\n".join([parts_of_state()[0], sha256(content).hexdigest().encode(), content])


def with_table(change: Any) -> bytes:
    _, header, table = parts_of_state()
    changed = change(table)
    return state_of({**header, "bytes": len(json.dumps(changed))}, changed)


def with_header(**changed: Any) -> bytes:
    _, header, table = parts_of_state()
    return state_of({**header, "bytes": len(json.dumps(table)), **changed}, table)


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_every_damage_is_refused(data: st.DataObject) -> None:
    state = bytearray(saved())
    at = data.draw(st.integers(0, len(state) - 1))
    kind = data.draw(st.sampled_from(["change", "cut", "insert", "remove", "double"]))
    if kind == "change":
        state[at] ^= data.draw(st.integers(1, 255))
    elif kind == "cut":
        del state[at:]
    elif kind == "insert":
        state[at:at] = data.draw(st.binary(min_size=1, max_size=9))
    elif kind == "remove":
        del state[at : at + data.draw(st.integers(1, 9))]
    else:
        state += bytes(state)
    if bytes(state) == saved():
        return
    with pytest.raises(EstimationError, match=r"give all bytes that Tracker\.state"):
        Tracker.restore(bytes(state))


def test_versions_and_sizes_are_checked() -> None:
    for changed in ({"format": 2}, {"pdr_est": "0.0.1"}):
        with pytest.raises(EstimationError, match="the state was saved by pdr_est"):
            Tracker.restore(with_header(**changed))
    for size in (-1, 0, 1 << 40, "many", True):
        with pytest.raises(EstimationError, match=r"the state (claims|does not have)"):
            Tracker.restore(with_header(bytes=size))
    for header in ([], {}, None):
        with pytest.raises(EstimationError, match="the header of the state is damaged"):
            Tracker.restore(state_of(header, []))
    with pytest.raises(EstimationError, match="does not have the"):
        Tracker.restore(with_header(bytes=100))


def test_a_name_that_is_no_text_comes_back() -> None:
    name = os.fsdecode(b"walk\xff \xc3\xa4")
    assert unpack(pack({"name": name}), dict) == {"name": name}


def test_a_pickle_is_refused_and_not_run(tmp_path: Any) -> None:
    class Harmful:
        def __reduce__(self) -> tuple[Any, ...]:
            return os.mkdir, (str(tmp_path / "made"),)

    for state in (pickle.dumps(Harmful()), saved()[:20] + pickle.dumps(Harmful())):
        with pytest.raises(EstimationError, match="the state"):
            Tracker.restore(state)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "row",
    [
        ["object", "os:PathLike", [], []],
        ["object", "subprocess:Popen", [], []],
        ["restored", "pathlib:Path", None],
        ["object", "pdr_est.__main__:anything", [], []],
        ["object", "pdr_est.online.tracker:pack", [], []],
        ["object", "pdr_est.online.tracker:WalkEstimator", [], []],
        ["object", "pdr_est.nowhere:Tracker", [], []],
        ["enum", "pdr_est.online.tracker:Tracker", "state"],
        ["named", "pdr_est.online.tracker:Tracker", []],
        ["array", "|O", "C", [1], "AAAAAAAAAAA="],
        ["array", "<f8", "C", [1 << 60], ""],
        ["defaultdict", "print", []],
        ["tuple", [[0]]],
        ["list", [[10**9]]],
        ["list", 7],
        ["nothing"],
        [],
        None,
    ],
)
def test_objects_that_cannot_be_are_refused(row: Any) -> None:
    with pytest.raises(EstimationError, match="the state"):
        Tracker.restore(with_table(lambda _: [row]))


@pytest.mark.parametrize("root", [["list", []], ["object", "pdr_est.online.update:Update", [], []]])
def test_a_state_of_something_else_is_refused(root: Any) -> None:
    with pytest.raises(EstimationError, match="the state is that of a"):
        Tracker.restore(with_table(lambda _: [root]))


@settings(max_examples=20, deadline=None)
@given(st.data())
def test_a_table_that_was_changed_raises_nothing_but_refusals(data: st.DataObject) -> None:
    def change(table: list[Any]) -> list[Any]:
        row = data.draw(st.integers(0, len(table) - 1))
        table[row] = data.draw(st.sampled_from([table[0], table[-1], [], ["list", [[0]]], ["tuple", []], None]))
        return table

    with suppress(EstimationError):
        Tracker.restore(with_table(change))


def test_what_is_no_data_cannot_be_saved() -> None:
    for value in (print, lambda: 0, open, type("Local", (), {})(), np.array([None]), memoryview(b"1")):
        with pytest.raises(EstimationError, match=r"the state cannot be saved: it holds an? .* is no data"):
            pack([value])


PLAIN = (
    st.binary(max_size=5)
    | st.complex_numbers()
    | st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=5)
)
ARRAYS = st.builds(
    lambda shape, dtype, order: np.asarray(np.arange(np.prod(shape)).reshape(shape), dtype, order=order),
    st.lists(st.integers(0, 3), max_size=3).map(tuple),
    st.sampled_from([float, np.int32, bool, np.uint8, complex, np.float32]),
    st.sampled_from(["C", "F"]),
)
LEAVES = PLAIN | ARRAYS | st.floats().map(np.float64) | st.sampled_from(CarryingMode) | st.just(slice(1, None, 2))
KEYS = (
    st.text(max_size=3)
    | st.integers()
    | st.tuples(st.integers(), st.text(max_size=2))
    | st.sampled_from(CarryingMode)
)


def collections_of(inner: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    lists = st.lists(inner, max_size=4)
    return (
        lists
        | lists.map(tuple)
        | lists.map(lambda values: deque(values, 7))
        | st.dictionaries(KEYS, inner, max_size=4)
        | st.dictionaries(KEYS, inner, max_size=4).map(OrderedDict)
        | st.dictionaries(KEYS, inner, max_size=4).map(lambda content: defaultdict(list, content))
        | st.sets(KEYS, max_size=4)
        | st.frozensets(KEYS, max_size=4)
    )


def alike(one: Any, two: Any) -> bool:
    """Tell whether two values are the same in type and content, NaN being the same as NaN."""
    if type(one) is not type(two):
        return False
    if isinstance(one, np.ndarray):
        layout = [(each.dtype, each.shape, each.flags.f_contiguous, each.tobytes()) for each in (one, two)]
        return layout[0] == layout[1]
    if isinstance(one, dict):
        return list(one) == list(two) and all(alike(one[key], two[key]) for key in one)
    if isinstance(one, list | tuple | deque):
        return len(one) == len(two) and all(map(alike, one, two))
    return bool(one == two) or repr(one) == repr(two)


@pytest.mark.parametrize("examples", [40, pytest.param(200, marks=pytest.mark.slow)])
def test_data_come_back_exactly(examples: int) -> None:
    @settings(max_examples=examples, deadline=None)
    @given(st.recursive(LEAVES, collections_of, max_leaves=12))
    def comes_back(value: Any) -> None:
        (again,) = unpack(pack([value]), list)
        assert alike(again, value)
        assert getattr(again, "maxlen", None) == getattr(value, "maxlen", None)
        assert getattr(again, "default_factory", None) is getattr(value, "default_factory", None)

    comes_back()


def test_what_is_shared_is_shared_again_and_circles_close() -> None:
    shared, circle = [1.0], {}
    circle["self"] = circle
    one, two, again = unpack(pack((shared, (shared, 2), circle)), tuple)
    assert one is two[0]
    assert again["self"] is again
