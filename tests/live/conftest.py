"""Live walks whose files are closed after a test."""

from collections.abc import Callable, Iterator

import pytest
from live_walks import new_session

from pdr_est.live.session import LiveSession


@pytest.fixture
def new_walk() -> Iterator[Callable[..., LiveSession]]:
    """Make walks as `new_session` does."""
    made: list[LiveSession] = []

    def make(*args: object, **limits: object) -> LiveSession:
        made.append(new_session(*args, **limits))
        return made[-1]

    yield make
    for session in made:
        if session.recording is not None:
            session.recording.close()
