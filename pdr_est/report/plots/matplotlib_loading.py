"""Load matplotlib quickly."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def loading_matplotlib() -> Iterator[None]:
    """Import matplotlib without the docstrings that it composes from the properties of each kind of artist.

    To inspect them takes a third of the time in which matplotlib loads. This is for programs, in which nobody asks
    for help on matplotlib; it does nothing if matplotlib is loaded already.
    """
    if "matplotlib.artist" in sys.modules:
        yield
        return
    import matplotlib.artist

    artist: Any = matplotlib.artist
    describe = artist.kwdoc
    artist.kwdoc = _no_description
    try:
        yield
    finally:
        artist.kwdoc = describe


def _no_description(_artist: object) -> str:
    return ""
