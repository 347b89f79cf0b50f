"""Scoring of walks on a Dask cluster."""

import asyncio
import logging
import warnings
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

from pdr_est.errors import ConfigError, EstimationError
from pdr_est.experiment.runners.processes import FinishedWalk, lost
from pdr_est.experiment.runners.scoring_job import ScoringJob, score_walk
from pdr_est.experiment.walks import Walk

PATIENCE_S = 5.0  # time within which the scheduler must answer


@contextmanager
def connected(address: str) -> Iterator[Any]:
    """Connect to the Dask scheduler at an address, `tcp://HOST:PORT`, and give its client.

    Warns if the scheduler has no workers yet; the walks wait for them.

    Raises
    ------
    ConfigError
        If Dask is not installed or no scheduler answers within `PATIENCE_S`.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise ConfigError("--cluster: needs Dask: install pdr-est[dask]") from error
    try:
        # Asked before there is a client: one that fails to connect takes long to end, and with a traceback.
        with _log_silenced("distributed"):
            kind = _server_kind(address)
    except Exception as error:  # of any kind, for what answers there may be anything
        raise ConfigError(
            f"--cluster {address!r}: no Dask scheduler answers there within {PATIENCE_S:g} s: give the address that "
            "`dask scheduler` prints, such as tcp://HOST:8786"
        ) from error
    if kind != "Scheduler":
        raise ConfigError(f"--cluster {address!r}: is a Dask {kind.lower()}: give the address of its scheduler")
    with Client(address, timeout=4.0 * PATIENCE_S, set_as_default=False) as client:  # type: ignore[no-untyped-call]
        if not client.scheduler_info()["workers"]:
            warnings.warn(f"{address} has no worker yet: walks wait for `dask worker {address}`", stacklevel=2)
        yield client


def _server_kind(address: str) -> str:
    """Ask the server in a thread of its own, because this one may have an event loop, as notebooks do."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, asyncio.wait_for(_identity(address), PATIENCE_S)).result()


async def _identity(address: str) -> str:
    """Return the type of the Dask server at an address, such as "Scheduler"."""
    from distributed.comm.core import connect
    from distributed.security import Security

    safely = Security().get_connection_args("client")  # type: ignore[no-untyped-call]
    comm = await connect(address, timeout=PATIENCE_S, **safely)  # type: ignore[no-untyped-call]
    try:
        await comm.write({"op": "identity", "reply": True})
        return str((await comm.read())["type"])
    finally:
        comm.abort()


def run_on_cluster(job: ScoringJob, walks: Sequence[Walk], client: Any) -> Iterator[FinishedWalk]:
    """Score walks and yield them in the order in which they end.

    The workers need this package and, for recorded walks, the same files under the same names. Dask gives the work of
    a worker that dies to another one.

    Parameters
    ----------
    job : ScoringJob
        Work to do on every walk.
    walks : sequence of Walk
        The walks.
    client : distributed.Client
        Client from `connected`.

    Raises
    ------
    EstimationError
        If the connection is lost.
    """
    from distributed import as_completed

    futures = {client.submit(score_walk, job, walk, pure=False): walk for walk in walks}
    for future in as_completed(list(futures), loop=client.loop):  # type: ignore[no-untyped-call]
        walk = futures.pop(future)
        if future.status == "finished":
            yield FinishedWalk(walk, future.result())
        elif future.status == "cancelled":
            raise EstimationError("--cluster: the connection to the scheduler was lost: run again to continue")
        else:
            yield lost(walk, f"on the cluster: {future.exception()!r}")
        future.release()


@contextmanager
def _log_silenced(name: str) -> Iterator[None]:
    """Switch the log of a library off: the error says what the log would say."""
    logger = logging.getLogger(name)
    before = logger.level
    logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        logger.setLevel(before)
