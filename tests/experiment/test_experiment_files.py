"""Every experiment file in configs/ runs on a few of its walks; those on data sets where the data are."""

from dataclasses import replace
from pathlib import Path

import polars as pl
import pytest
import yaml

from pdr_est.experiment import Experiment, load_experiment, run_experiment
from pdr_est.experiment.suites import suite_named
from pdr_est.experiment.walks import Walk
from pdr_est.simulate import Scenario
from pdr_est.simulate.walker.walking_path import PathParams

FILES = sorted((Path(__file__).parents[2] / "configs").glob("*.yaml"))
CONTENTS = {path.stem: yaml.safe_load(path.read_text(encoding="utf-8")) for path in FILES}
SIMULATED = [path for path in FILES if "simulated" in CONTENTS[path.stem]["data"]]
RECORDED = [path for path in FILES if path not in SIMULATED]


def test_the_promised_files_are_there() -> None:
    promised = {"quick", "ilc20", "oxiod", "weallwalk", "two-phones", "mmpdr", "robust-dr", "uptime", "psp"}
    assert promised <= set(CONTENTS)


@pytest.mark.parametrize("path", FILES, ids=[path.stem for path in FILES])
def test_a_file_says_what_question_it_answers(path: Path) -> None:
    comment = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("# "):
            break
        comment.append(line)
    assert "?" in " ".join(comment)


@pytest.mark.parametrize(
    ("stem", "key", "values"),
    [
        ("robust-dr", "estimator", {"map-closed-form", "map-general", "ekf", "factor-graph"}),
        ("two-phones", "estimator", {"map-closed-form", "map-general", "ekf", "factor-graph"}),
        ("psp", "heading", {"psp", "hde", "gyro", "magnetometer", "auto"}),
        ("mmpdr", "heading", {"mmpdr", "step-yaw", "auto"}),
        ("uptime", "steps", {"uptime-fsm", "local-variance", "zero-crossing", "auto"}),
    ],
)
def test_the_methods_that_a_paper_is_compared_with(stem: str, key: str, values: set[str]) -> None:
    path = next(path for path in FILES if path.stem == stem)
    configs = [variant.config for variant in load_experiment(path, limit=1).variants]
    found = {
        "estimator": {config.estimator.name for config in configs},
        "heading": {config.heading.method for config in configs},
        "steps": {config.steps.detector for config in configs},
    }
    assert values <= found[key]
    if stem in ("robust-dr", "two-phones"):
        assert {config.estimator.map_fusion.feedback for config in configs} == {False, True}


def named(paths: list[Path], slow: tuple[str, ...]) -> pytest.MarkDecorator:
    """A case for each file; those of the names `slow` take seconds."""
    return pytest.mark.parametrize(
        "path",
        [pytest.param(path, id=path.stem, marks=[pytest.mark.slow] if path.stem in slow else []) for path in paths],
    )


@named(SIMULATED, slow=("two-phones", "robust-dr", "scale", "uptime-trips", "mmpdr", "psp", "uptime"))
def test_simulated(path: Path, tmp_path: Path) -> None:
    experiment = load_experiment(path, limit=1)
    shorter = replace(experiment, walks=tuple(shortened(walk) for walk in experiment.walks))
    check(shorter, tmp_path / "out")


@named(RECORDED, slow=("weallwalk", "floor-plan", "oxiod"))
def test_recorded(path: Path, tmp_path: Path, shared_data: Path) -> None:
    if not (shared_data / suite_named(CONTENTS[path.stem]["data"]["suite"]).folder).is_dir():
        pytest.skip("the data set is not there")
    check(load_experiment(path, data=shared_data, limit=1), tmp_path / "out")


def shortened(walk: Walk) -> Walk:
    """The person on 26 m without stops and changes of gait, with a true position every second."""
    scenario = walk.source
    assert isinstance(scenario, Scenario)
    path = PathParams(vertices_m=((0.0, 0.0), (16.0, 0.0), (16.0, 10.0)))
    gait = replace(scenario.gait, pauses=(), stretches=())
    return replace(walk, source=replace(scenario, path=path, gait=gait), truth_every_s=1.0)


def check(experiment: Experiment, out: Path) -> None:
    """Every variant has a track, and every metric that is asked for by name has a value."""
    finished = run_experiment(experiment, out)
    assert finished.failed == 0
    table = pl.read_parquet(out / "results.parquet")
    assert set(table["variant"]) == {variant.name for variant in experiment.variants}
    tracks = set(table["track"])
    assert ("fused" in tracks) == (len(tracks) > 1), "the person has a track of his own"
    asked = table.filter(pl.col("metric").is_in(list(experiment.config.metrics)))
    assert asked["value"].null_count() == 0
    assert table["value"].null_count() < len(table)
    assert (out / "report.html").stat().st_size > 10_000
