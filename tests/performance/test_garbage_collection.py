"""The garbage collection is paused while the front end runs, and never stays off."""

import gc
from collections.abc import Iterator

import pytest

from pdr_est.pipeline.garbage_collection import collection_paused


@pytest.fixture(autouse=True)
def _collecting() -> Iterator[None]:
    yield
    gc.enable()


def test_it_pauses_and_goes_on() -> None:
    with collection_paused():
        assert not gc.isenabled()
    assert gc.isenabled()


def test_it_goes_on_after_an_error() -> None:
    with pytest.raises(KeyError), collection_paused():
        raise KeyError
    assert gc.isenabled()


def test_who_switched_it_off_keeps_it_off() -> None:
    gc.disable()
    with collection_paused():
        pass
    assert not gc.isenabled()


def test_as_a_decorator_it_pauses_at_every_call() -> None:
    states: list[bool] = []

    @collection_paused()
    def work() -> None:
        states.append(gc.isenabled())

    work()
    work()
    assert states == [False, False]
    assert gc.isenabled()
