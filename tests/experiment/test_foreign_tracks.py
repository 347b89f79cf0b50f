"""Tracks of other programs in the tables of an experiment."""

import csv
import json
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from experiment_files import experiment_file

from pdr_est import pipeline
from pdr_est.config import Config, config_with
from pdr_est.errors import ConfigError, OutputError
from pdr_est.experiment import Experiment, load_experiment, run_experiment
from pdr_est.io.writers.trajectories import write_tum
from pdr_est.types.track import Track

TEXT = """\
data:
  simulated: {number: 2, people: 2, duration_s: 45.0}
settings:
  estimator.name: dead-reckoning
variants:
  ours:
  peer: {track_files: "peer/{walk}.tum"}
fixes: {protocol: heldout}
seed: 7
"""


def reckoned(experiment: Experiment, number: int) -> Track:
    """The track of dead reckoning of one walk, from the sensors alone."""
    recording = experiment.walks[number].recording(experiment.suite)
    walks = pipeline.analyse_recording(recording, experiment.variants[0].config)
    return pipeline.estimate_tracks(walks, experiment.variants[0].config, ())


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An experiment in which the peer has our own track of one walk, turned and moved, and none of the other."""
    made = tmp_path_factory.mktemp("peers")
    experiment = load_experiment(experiment_file(made, TEXT))
    (made / "peer").mkdir()
    track = reckoned(experiment, 0)
    turned = np.column_stack([-track.position_m[:, 1], track.position_m[:, 0]]) + np.array([100.0, 0.0])
    write_tum(Track(**{**vars(track), "position_m": turned}), made / "peer" / f"{experiment.walks[0].name}.tum")
    run_experiment(experiment, made / "out")
    return made


def values(folder: Path, metric: str) -> dict[tuple[str, str], float | None]:
    rows = pl.read_parquet(folder / "out" / "results.parquet").filter(pl.col("metric") == metric)
    return {(row["walk"], row["variant"]): row["value"] for row in rows.iter_rows(named=True)}


def test_a_peer_stands_in_the_same_tables(folder: Path) -> None:
    for metric in ("error_open_m", "ate_rigid_m", "final_drift", "length_ratio"):
        found = values(folder, metric)
        assert found["walk_0001", "peer"] == pytest.approx(found["walk_0001", "ours"], abs=2e-3)
        assert found["walk_0002", "ours"] is not None
        assert ("walk_0002", "peer") not in found


def test_a_peer_is_aligned_with_the_fixes_and_marked(folder: Path) -> None:
    found = values(folder, "error_heldout_m")
    assert found["walk_0001", "peer"] is not None
    assert found["walk_0001", "peer"] < found["walk_0001", "ours"] + 1.0
    page = (folder / "out" / "report.html").read_text(encoding="utf-8")
    assert "peer *" in page


def test_no_covariance_no_coverage_and_the_reason(folder: Path) -> None:
    assert values(folder, "coverage95").get(("walk_0001", "peer")) is None
    assert values(folder, "coverage95")["walk_0001", "ours"] is not None
    with (folder / "out" / "failed.csv").open(encoding="utf-8") as stream:
        reasons = {row["walk"]: row["reason"] for row in csv.DictReader(stream)}
    assert reasons["walk_0001"].startswith("peer: coverage95, nees_mean: the track has no covariance")
    assert "walk_0002.tum: no such file" in reasons["walk_0002"]


def test_steps_of_a_file_are_not_counted(folder: Path) -> None:
    assert values(folder, "count_error").get(("walk_0001", "peer")) is None
    page = (folder / "out" / "report.html").read_text(encoding="utf-8")
    steps = page[page.index("steps detected") :]
    assert "peer" not in steps[: steps.index("</table>")]


def test_another_track_needs_another_run(folder: Path, tmp_path: Path) -> None:
    provenance = json.loads((folder / "out" / "provenance.json").read_text(encoding="utf-8"))
    assert provenance["tracks"]["peer"]["walk_0002"] is None
    file = folder / "peer" / "walk_0001.tum"
    assert len(provenance["tracks"]["peer"]["walk_0001"]) == 64
    experiment = load_experiment(folder / "small.yaml")
    before = file.read_text(encoding="utf-8")
    file.write_text(before + "9999 0 0 0 0 0 0 1\n", encoding="utf-8")
    try:
        with pytest.raises(OutputError, match="data"):
            run_experiment(experiment, folder / "out")
    finally:
        file.write_text(before, encoding="utf-8")
    assert run_experiment(experiment, folder / "out").resumed >= 1


def test_the_resolved_file_is_an_experiment(folder: Path) -> None:
    again = load_experiment(folder / "out" / "config.yaml")
    assert [variant.name for variant in again.variants] == ["ours", "peer"]
    assert again.variants[1].track_file("a/b") == folder / "peer" / "a" / "b.tum"
    assert again.variants[0].config == config_with(Config(), {"estimator.name": "dead-reckoning"}, "test")


@pytest.mark.parametrize(
    ("peer", "words"),
    [
        ("{track_files: peer.tum}", "line 7: track_files = 'peer.tum': is no pattern with {walk} or {name}"),
        ("{track_files: 3}", "is no pattern"),
        ("{track_files: '{walk}.tum', steps.detector: auto}", "the setting steps.detector does not apply"),
    ],
)
def test_bad_patterns(tmp_path: Path, peer: str, words: str) -> None:
    text = TEXT.replace('{track_files: "peer/{walk}.tum"}', peer)
    with pytest.raises(ConfigError) as caught:
        load_experiment(experiment_file(tmp_path, text))
    assert words in str(caught.value)


def test_a_sweep_does_not_repeat_a_peer(tmp_path: Path) -> None:
    text = TEXT + "sweep: {estimator.name: [dead-reckoning, ekf]}\n"
    names = [variant.name for variant in load_experiment(experiment_file(tmp_path, text)).variants]
    assert names == ["ours dead-reckoning", "ours ekf", "peer"]
