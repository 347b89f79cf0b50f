"""The same work on a Dask cluster, also when a worker is killed."""

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from experiment_files import SMALL, experiment_file

from pdr_est.errors import ConfigError
from pdr_est.experiment import load_experiment, run_experiment
from pdr_est.experiment.runners.dask_cluster import connected

distributed = pytest.importorskip("distributed")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("default"),  # what Dask's own threads warn of at their end is not ours
]


@pytest.fixture
def cluster() -> Iterator["distributed.LocalCluster"]:
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as started:
        yield started


def test_a_killed_worker_changes_nothing(tmp_path: Path, cluster: "distributed.LocalCluster") -> None:
    experiment = load_experiment(experiment_file(tmp_path, SMALL.replace("number: 3", "number: 12")))
    killed = []

    def kill_one(done: int, _total: int) -> None:
        if done >= 3 and not killed:
            nanny = next(iter(cluster.workers.values()))
            killed.append(nanny.pid)
            nanny.process.process.kill()

    run_experiment(experiment, tmp_path / "there", cluster=cluster.scheduler_address, on_progress=kill_one)
    run_experiment(experiment, tmp_path / "here")
    assert killed
    for name in ("results.parquet", "failed.csv"):
        assert (tmp_path / "there" / name).read_bytes() == (tmp_path / "here" / name).read_bytes()


def test_a_worker_is_no_scheduler(tmp_path: Path, cluster: "distributed.LocalCluster") -> None:
    (worker, *_) = cluster.scheduler_info["workers"]
    experiment = load_experiment(experiment_file(tmp_path))
    with pytest.raises(ConfigError, match=r"is a Dask worker: give the address of its scheduler"):
        run_experiment(experiment, tmp_path / "out", cluster=worker)
    assert not (tmp_path / "out").exists()


def test_a_scheduler_without_workers_is_told_of() -> None:
    with (
        distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=None) as empty,
        pytest.warns(UserWarning, match="has no worker yet: walks wait for `dask worker"),
        connected(empty.scheduler_address),
    ):
        pass


@pytest.fixture
def silent_server() -> Iterator[str]:
    """The address of somebody who accepts connections and says nothing."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield f"tcp://127.0.0.1:{server.getsockname()[1]}"


@pytest.mark.parametrize(
    "address", ["tcp://127.0.0.1:9", "tcp://127.0.0.1", "no address", "http://127.0.0.1:9", None]
)
def test_an_address_where_nobody_answers_is_refused_and_leaves_nothing(
    tmp_path: Path, address: str | None, silent_server: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pdr_est.experiment.runners.dask_cluster.PATIENCE_S", 1.0)
    experiment = load_experiment(experiment_file(tmp_path))
    given = address or silent_server
    with pytest.raises(ConfigError, match=rf"--cluster '{given}': no Dask scheduler answers .* within 1 s: give the"):
        run_experiment(experiment, tmp_path / "out", cluster=given)
    assert not (tmp_path / "out").exists()
