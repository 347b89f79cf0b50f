"""The work on a Dask cluster."""

import asyncio
import logging
import warnings
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

from pdr_est.errors import ConfigError, EstimationError
from pdr_est.experiment.runners.processes import Done, lost
from pdr_est.experiment.runners.walk_job import Work, do
from pdr_est.experiment.walks import Walk

PATIENCE_S = 5.0  # until the scheduler must have answered


@contextmanager
def connected(address: str) -> Iterator[Any]:
    """A Dask client of the scheduler at an address, `tcp://HOST:PORT`.

    Warns when it has no workers yet, for which the walks wait. Raises ConfigError when Dask is not installed or no
    scheduler answers within `PATIENCE_S`.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise ConfigError("--cluster: needs Dask: install pdr-est[dask]") from error
    try:
        # Asked before there is a client: one that fails to connect takes long to end, and with a traceback.
        with _silent("distributed"):
            kind = _asked(address)
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


def _asked(address: str) -> str:
    """What `_kind` says; in a thread of its own, for this one may have an event loop, as notebooks do."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, asyncio.wait_for(_kind(address), PATIENCE_S)).result()


async def _kind(address: str) -> str:
    """What sort of Dask server answers at an address."""
    from distributed.comm.core import connect
    from distributed.security import Security

    safely = Security().get_connection_args("client")  # type: ignore[no-untyped-call]
    comm = await connect(address, timeout=PATIENCE_S, **safely)  # type: ignore[no-untyped-call]
    try:
        await comm.write({"op": "identity", "reply": True})
        return str((await comm.read())["type"])
    finally:
        comm.abort()


def run_on_cluster(work: Work, walks: Sequence[Walk], client: Any) -> Iterator[Done]:
    """The parts of walks in the order in which they are done. client: from `connected`.

    The workers need this package and, for recorded walks, the same files under the same names. Dask gives the work of
    a worker that dies to another one. Raises EstimationError when the connection is lost.
    """
    from distributed import as_completed

    futures = {client.submit(do, work, walk, pure=False): walk for walk in walks}
    for future in as_completed(list(futures), loop=client.loop):  # type: ignore[no-untyped-call]
        walk = futures.pop(future)
        if future.status == "finished":
            yield Done(walk, future.result())
        elif future.status == "cancelled":
            raise EstimationError("--cluster: the connection to the scheduler was lost: run again to continue")
        else:
            yield lost(walk, f"on the cluster: {future.exception()!r}")
        future.release()


@contextmanager
def _silent(name: str) -> Iterator[None]:
    """A library's log is switched off: what it would say of a failure is said by the error."""
    logger = logging.getLogger(name)
    before = logger.level
    logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        logger.setLevel(before)
