"""Pause the search for unreachable reference cycles during work that makes many records and no cycles."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def collection_paused() -> Iterator[None]:
    """Pause Python's cyclic garbage collection for the duration of a `with` block or of a decorated function.

    The collector looks through all objects of the process, again and again, as the number of records grows. The front
    end makes some dozen records at each step, all of which stay or are freed by their reference counts. Where the
    collection is off already, it stays off.
    """
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
