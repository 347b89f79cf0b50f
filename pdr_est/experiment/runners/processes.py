"""The work in processes of this computer."""

import multiprocessing
import os
import threading
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass

from pdr_est.experiment.runners.score_walk import without_interrupts
from pdr_est.experiment.runners.walk_job import Work, do, prepare
from pdr_est.experiment.runners.walk_result import Failure, WalkResult, encode
from pdr_est.experiment.walks import Walk

_AHEAD = 2  # walks given to each process: enough that none waits, few enough to stop soon


@dataclass(frozen=True)
class Done:
    """An encoded part. keep: whether it is final; what a dying process leaves is tried again by the next run."""

    walk: Walk
    content: bytes
    keep: bool = True


def run_locally(work: Work, walks: Sequence[Walk], workers: int) -> Iterator[Done]:
    """The parts of walks in the order in which they are done.

    When a process dies, the walks that were under way are done one by one, so that the one to blame is found.
    """
    if workers == 1:
        prepare(work)
        for walk in walks:
            yield Done(walk, do(work, walk))
        return
    waiting = deque(walks)
    while waiting:
        under_way: dict[Future[bytes], Walk] = {}
        try:
            yield from _in_pool(work, waiting, workers, under_way)
        except BrokenProcessPool:
            for walk in under_way.values():
                yield _alone(work, walk)


def lost(walk: Walk, why: str) -> Done:
    """What is told of a walk whose process died."""
    return Done(walk, encode(WalkResult(walk.name, failures=(Failure(walk.name, why, whole=True),))), keep=False)


def _in_pool(work: Work, waiting: deque[Walk], workers: int, under_way: dict[Future[bytes], Walk]) -> Iterator[Done]:
    with _pool(work, min(workers, len(waiting))) as pool:
        try:
            while waiting or under_way:
                with without_interrupts():
                    while waiting and len(under_way) < _AHEAD * workers:
                        under_way[pool.submit(do, work, waiting[0])] = waiting[0]
                        waiting.popleft()
                for future in wait(under_way, return_when=FIRST_COMPLETED).done:
                    content = future.result()
                    yield Done(under_way.pop(future), content)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _alone(work: Work, walk: Walk) -> Done:
    with _pool(work, 1) as pool:
        try:
            return Done(walk, pool.submit(do, work, walk).result())
        except BrokenProcessPool:
            return lost(walk, "the process that worked on it died, for lack of memory perhaps: run it again alone")


def _pool(work: Work, workers: int) -> ProcessPoolExecutor:
    # Spawned and not forked: the same on every platform, and safe with the threads of numpy and GTSAM.
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(workers, mp_context=context, initializer=_begin, initargs=(work,))


def _begin(work: Work) -> None:
    threading.Thread(target=_end_with_parent, daemon=True).start()
    prepare(work)


def _end_with_parent() -> None:
    """A process that waits for work does not notice that nobody is left to give any."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
