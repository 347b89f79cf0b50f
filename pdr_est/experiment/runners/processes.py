"""Scoring of walks in processes of this computer."""

import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass

from pdr_est.experiment.results.walk_result import WalkResult
from pdr_est.experiment.runners.scoring_job import ScoringJob, preload, score_walk
from pdr_est.experiment.walks import Walk

_QUEUED = 2  # walks given to each process: enough that none waits, few enough to stop soon


@dataclass(frozen=True)
class FinishedWalk:
    """A walk whose work has ended.

    Attributes
    ----------
    walk : Walk
        The walk.
    result : WalkResult
        Its result.
    final : bool
        False if the process died, so that the next run shall try again.
    """

    walk: Walk
    result: WalkResult
    final: bool = True


def run_in_processes(job: ScoringJob, walks: Sequence[Walk], workers: int) -> Iterator[FinishedWalk]:
    """Score walks and yield them in the order in which they end; one worker is this process.

    When a process dies, the walks that were under way are scored one by one, so that the one to blame is found.
    """
    if workers == 1:
        preload(job)
        for walk in walks:
            yield FinishedWalk(walk, score_walk(job, walk))
        return
    waiting = deque(walks)
    while waiting:
        under_way: dict[Future[WalkResult], Walk] = {}
        try:
            yield from _run_in_pool(job, waiting, workers, under_way)
        except BrokenProcessPool:
            for walk in under_way.values():
                yield _run_alone(job, walk)


def lost(walk: Walk, reason: str) -> FinishedWalk:
    """Make the result of a walk whose process died."""
    return FinishedWalk(walk, WalkResult.failed(walk.name, reason), final=False)


def _run_in_pool(
    job: ScoringJob, waiting: deque[Walk], workers: int, under_way: dict[Future[WalkResult], Walk]
) -> Iterator[FinishedWalk]:
    with _pool(job, min(workers, len(waiting))) as pool:
        try:
            while waiting or under_way:
                with _interrupts_ignored():
                    while waiting and len(under_way) < _QUEUED * workers:
                        under_way[pool.submit(score_walk, job, waiting[0])] = waiting[0]
                        waiting.popleft()
                for future in wait(under_way, return_when=FIRST_COMPLETED).done:
                    result = future.result()
                    yield FinishedWalk(under_way.pop(future), result)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _run_alone(job: ScoringJob, walk: Walk) -> FinishedWalk:
    with _pool(job, 1) as pool:
        try:
            return FinishedWalk(walk, pool.submit(score_walk, job, walk).result())
        except BrokenProcessPool:
            return lost(walk, "the process that worked on it died, for lack of memory perhaps: run it again alone")


def _pool(job: ScoringJob, workers: int) -> ProcessPoolExecutor:
    # Spawned and not forked: the same on every platform, and safe with the threads of numpy and GTSAM.
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(workers, mp_context=context, initializer=_start_worker, initargs=(job,))


def _start_worker(job: ScoringJob) -> None:
    threading.Thread(target=_end_with_parent, daemon=True).start()
    preload(job)


def _end_with_parent() -> None:
    """End this process with its parent; a process that waits for work would not notice the end of the parent."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """Make processes that start within ignore Ctrl-C, which reaches all of them: only this one ends the work."""
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread may set signal handlers
        return
    usual = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
