"""What a call loads: a help text and a completed word nothing slow, a command only what it uses."""

import os
import subprocess
import sys
from pathlib import Path
from typing import get_args

import pytest

from pdr_est.cli import COMMANDS, choices
from pdr_est.cli.work.convert import FORMATS
from pdr_est.clock_sync import ClockMethod
from pdr_est.config import Config
from pdr_est.estimators import ESTIMATORS
from pdr_est.experiment import SUITES
from pdr_est.experiment.variants.axes import AXES, EVERY
from pdr_est.front_end.heading import HEADINGS
from pdr_est.front_end.step_length import LENGTH_MODELS
from pdr_est.front_end.steps import DETECTORS
from pdr_est.performance import NAME
from pdr_est.preprocessing.turned_device import TURN_NAMES
from pdr_est.report.walk.track_formats import TRACK_FORMATS

PICTURES = {"matplotlib", "jinja2"}
ESTIMATION = {"gtsam", "filterpy"}
NUMERICS = {"scipy", *ESTIMATION}
NEVER = {"sklearn", "pymap3d", "multiprocessing", "rich", *PICTURES}
SLOW = {"numpy", "scipy", "polars", "sklearn", "pydantic", "rich", "yaml", *PICTURES, *ESTIMATION}
CALLS = """
import sys
from click.testing import CliRunner
from pdr_est.cli import main

for names, words in {calls!r}:
    result = CliRunner().invoke(main, words, prog_name="pdr-est")
    assert result.exit_code == 0, result.output
    loaded = names & set(sys.modules)
    assert not loaded, f"pdr-est {{' '.join(words)}} loads {{', '.join(sorted(loaded))}}"
"""


def call_without(*calls: tuple[set[str], list[str]]) -> None:
    """Make some calls in one new process, which must succeed; after each, none of its modules is loaded."""
    code = CALLS.format(calls=calls)
    done = subprocess.run((sys.executable, "-c", code), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_help_loads_nothing_slow() -> None:
    inner = [["config", "show", "--help"], ["config", "schema", "--help"]]
    calls = [["--help"], ["--version"], *([name, "--help"] for name in COMMANDS), *inner]
    call_without(*((SLOW, words) for words in calls))


def completed(words: str) -> tuple[list[str], str]:
    """Complete the last of some words as bash does; also return the slow modules that were loaded."""
    code = f"""
import atexit, sys
atexit.register(lambda: print(*sorted({SLOW!r} & set(sys.modules)), file=sys.stderr))
from pdr_est.cli import main
main(prog_name="pdr-est")
"""
    environment = {
        **os.environ,
        "_PDR_EST_COMPLETE": "bash_complete",
        "COMP_WORDS": f"pdr-est {words}",
        "COMP_CWORD": str(len(words.split(" "))),
    }
    done = subprocess.run((sys.executable, "-c", code), capture_output=True, text=True, check=True, env=environment)
    return [line.partition(",")[2] for line in done.stdout.splitlines()], done.stderr.strip()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("s", ["steps", "smooth"]),
        ("smooth --cl", ["--closed", "--clock", "--clock-offset"]),
        ("smooth --map columns.yaml --from 3 --estimator map", ["map-closed-form", "map-general"]),
        ("benchmark o", ["oxford-steps", "oxiod"]),
    ],
)
def test_a_word_is_completed_without_loading_anything_slow(words: str, expected: list[str]) -> None:
    found, loaded = completed(words)
    assert sorted(found) == sorted(expected)
    assert loaded == ""


def test_the_words_that_options_offer_are_those_of_the_package() -> None:
    assert {
        "--estimator": tuple(ESTIMATORS),
        "--detector": tuple(DETECTORS),
        "--length-model": tuple(LENGTH_MODELS),
        "--heading-method": tuple(HEADINGS),
        "--clock": get_args(ClockMethod),
        "convert --format": tuple(FORMATS),
        "smooth --format": tuple(TRACK_FORMATS),
        "benchmark SUITE": tuple(sorted([NAME, *(suite.name for suite in SUITES)])),
        "benchmark --turn-device": TURN_NAMES,
        "benchmark, every value": EVERY,
    } == {
        "--estimator": choices.ESTIMATORS,
        "--detector": choices.DETECTORS,
        "--length-model": choices.LENGTH_MODELS,
        "--heading-method": choices.HEADING_METHODS,
        "--clock": choices.CLOCK_METHODS,
        "convert --format": choices.RECORDING_FORMATS,
        "smooth --format": choices.TRACK_FORMATS,
        "benchmark SUITE": choices.SUITE_NAMES,
        "benchmark --turn-device": choices.DEVICE_TURNS,
        "benchmark, every value": choices.EVERY_VALUE,
    }


def test_the_settings_that_a_benchmark_compares_are_those_of_the_package() -> None:
    assert {axis.name: (axis.values, axis.value_in(Config())) for axis in AXES} == dict(choices.COMPARED)


def test_finding_steps_and_smoothing_load_no_scipy(good: Path, tmp_path: Path) -> None:
    tracks = {"pdr_est.estimators.fix_checks", "pdr_est.estimators.kalman", "pdr_est.estimators.person"}
    smooth = ["smooth", str(good), "-o", str(tmp_path / "out"), "--quiet"]
    call_without(
        (NEVER | NUMERICS | tracks, ["inspect", str(good)]),
        (NEVER | NUMERICS | tracks, ["steps", str(good)]),
        (NEVER | NUMERICS, [*smooth, "--no-report"]),
        ((NEVER | NUMERICS | {"matplotlib.pyplot"}) - PICTURES, [*smooth, "--overwrite"]),
    )


@pytest.mark.slow
def test_a_command_loads_only_what_it_uses(good: Path, tmp_path: Path) -> None:
    smooth = ["smooth", str(good), "-o", str(tmp_path / "out"), "--overwrite", "--no-report", "--quiet"]
    ekf, fixed_lag = ([*smooth, "--estimator", name] for name in ("ekf", "fixed-lag"))
    call_without((NEVER | {"gtsam"}, ekf), (NEVER, fixed_lag))
