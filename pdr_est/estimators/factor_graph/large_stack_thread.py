"""Run work that recurses deeply, such as GTSAM's elimination of a long walk, with a large stack."""

import threading
from collections.abc import Callable
from typing import TypeVar

LARGE_STACK_POSES = 5_000  # from how many poses on GTSAM's elimination needs it
_STACK_BYTES = 512 * 1024 * 1024

T = TypeVar("T")


def with_large_stack(work: Callable[[], T]) -> T:
    """Run `work` in a thread with a stack of 512 MB and return its result; what it raises is raised here."""
    outcome: list[T] = []
    failure: list[BaseException] = []

    def run() -> None:
        try:
            outcome.append(work())
        except BaseException as error:
            failure.append(error)

    previous = threading.stack_size(_STACK_BYTES)
    try:
        thread = threading.Thread(target=run)
        thread.start()
    finally:
        threading.stack_size(previous)
    thread.join()
    if failure:
        raise failure[0]
    return outcome[0]
