"""The work on a Dask cluster."""

from collections.abc import Iterator, Sequence

from pdr_est.errors import ConfigError, EstimationError
from pdr_est.experiment.local import Done, lost
from pdr_est.experiment.walks import Walk
from pdr_est.experiment.work import Work, do

PATIENCE_S = 20.0  # until the scheduler must have answered


def run_on_cluster(work: Work, walks: Sequence[Walk], address: str) -> Iterator[Done]:
    """The parts of walks in the order in which they are done. address: of the scheduler, `tcp://HOST:PORT`.

    The workers need this package and, for recorded walks, the same files under the same names. Dask gives the work of
    a worker that dies to another one. Raises ConfigError when Dask is not installed or the scheduler not reached.
    """
    try:
        from distributed import Client, as_completed
    except ImportError as error:
        raise ConfigError("--cluster: needs Dask: install pdr-est[dask]") from error
    try:
        client = Client(address, timeout=PATIENCE_S, set_as_default=False)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        raise ConfigError(f"--cluster {address}: no Dask scheduler answers there: check the address") from error
    with client:
        futures = {client.submit(do, work, walk, pure=False): walk for walk in walks}
        for future in as_completed(list(futures), loop=client.loop):  # type: ignore[no-untyped-call]
            walk = futures.pop(future)
            if future.status == "finished":
                yield Done(walk, future.result())
            elif future.status == "cancelled":
                raise EstimationError(f"--cluster {address}: the connection was lost: run again to continue")
            else:
                yield lost(walk, f"on the cluster: {future.exception()!r}")
            future.release()
