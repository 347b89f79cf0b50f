"""Every command and every Python block of the README runs, in a folder where `make demo` has run."""

import re
import runpy
import shlex
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from pdr_est.benchmark.suites import SUITES
from pdr_est.benchmark.variant import AXES
from pdr_est.cli import main
from pdr_est.experiment import load_experiment

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^\$ pdr-est (.*)$", README, flags=re.MULTILINE)
EXPERIMENTS = re.findall(r"^```yaml\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)
BLOCKS = re.findall(r"^```python\n(.*?)^```$", README, flags=re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def demo_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the output of the demo, and with the experiment files."""
    folder = tmp_path_factory.mktemp("readme")
    shutil.copytree(Path(__file__).parents[1] / "configs", folder / "configs")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        result = CliRunner().invoke(main, ["demo", "-o", "demo-out"])
    assert result.exit_code == 0, result.output
    return folder


def test_readme_has_commands_and_code() -> None:
    assert len(COMMANDS) >= 2
    assert len(BLOCKS) >= 2


@pytest.mark.parametrize("command", COMMANDS)
def test_command(command: str, demo_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(demo_folder)
    result = CliRunner().invoke(main, shlex.split(command))
    assert result.exit_code == 0, result.output


@pytest.mark.parametrize("block", EXPERIMENTS)
def test_experiment_block(block: str, demo_folder: Path) -> None:
    path = demo_folder / "configs" / "of-the-readme.yaml"
    path.write_text(block, encoding="utf-8")
    assert len(load_experiment(path).variants) > 1


@pytest.mark.parametrize("block", BLOCKS)
def test_python_block(block: str, demo_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(demo_folder)
    exec(compile(block, "README.md", "exec"), {})


def test_benchmark_table_is_that_of_the_recorded_results() -> None:
    script = runpy.run_path(str(Path(__file__).parents[1] / "experiments" / "benchmark_tables.py"))
    assert script["readme_table"]() in README


def test_the_recorded_comparisons_are_of_known_suites_and_settings() -> None:
    script = runpy.run_path(str(Path(__file__).parents[1] / "experiments" / "benchmark_tables.py"))
    assert set(script["COMPARED"]) <= {suite.name for suite in SUITES}
    assert {axis for axes in script["COMPARED"].values() for axis in axes} <= {axis.word for axis in AXES}


def test_every_file_and_target_that_the_readme_names_exists() -> None:
    root = Path(__file__).parents[1]
    makefile = (root / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r"make ([a-z-]+)", README):
        if target != "is":
            assert re.search(rf"^{target}:", makefile, flags=re.MULTILINE), target
    for path in re.findall(r"`((?:pdr_est|configs|experiments)/[\w./-]+)`", README):
        assert (root / path).exists(), path
