"""Load modules without searching them for garbage."""

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def loading_modules() -> Iterator[None]:
    """Switch the garbage collector off while modules are imported, and have it leave alone what they contain.

    Modules make very many objects and nearly no garbage. To search them again and again takes a fifth of the time of
    a short command, and pauses of some milliseconds in the middle of a long one.
    """
    enabled, before = gc.isenabled(), len(sys.modules)
    gc.disable()
    try:
        yield
    finally:
        if len(sys.modules) > before:
            gc.freeze()
        if enabled:
            gc.enable()
