"""The fingerprint of the code covers every file of the package, in whatever folder it is."""

import shutil
from pathlib import Path

import pytest
from experiment_files import experiment_file

import pdr_est
from pdr_est.experiment import Experiment, load_experiment
from pdr_est.experiment.results.provenance import code_digests, provenance

PACKAGE = Path(pdr_est.__file__).parent
FOLDERS = sorted({path.parent.relative_to(PACKAGE) for path in PACKAGE.rglob("*.py")})


@pytest.fixture(scope="module")
def experiment(tmp_path_factory: pytest.TempPathFactory) -> Experiment:
    return load_experiment(experiment_file(tmp_path_factory.mktemp("experiment")))


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A copy of the code that may be changed."""
    return Path(shutil.copytree(PACKAGE, tmp_path / "pdr_est", ignore=lambda _, names: _not_code(names)))


def _not_code(names: list[str]) -> list[str]:
    return [name for name in names if name == "__pycache__" or Path(name).suffix not in ("", ".py")]


def code_fingerprint(experiment: Experiment, package: Path) -> str:
    return str(provenance(experiment, package)["fingerprint"]["code"])


def test_the_fingerprint_is_of_the_package_that_runs(experiment: Experiment, package: Path) -> None:
    assert provenance(experiment)["fingerprint"]["code"] == code_fingerprint(experiment, package)


def test_every_file_in_every_folder_counts() -> None:
    assert code_digests(PACKAGE).keys() == {
        path.relative_to(PACKAGE).as_posix() for path in PACKAGE.rglob("*") if path.suffix == ".py"
    }
    assert len(FOLDERS) > 20


@pytest.mark.slow
def test_a_change_in_any_folder_changes_the_fingerprint(experiment: Experiment, package: Path) -> None:
    """One file of each folder is changed in turn, the last one of the folder."""
    seen = {code_fingerprint(experiment, package)}
    for folder in FOLDERS:
        file = max((package / folder).glob("*.py"))
        file.write_text(file.read_text(encoding="utf-8") + "# changed\n", encoding="utf-8")
        fingerprint = code_fingerprint(experiment, package)
        assert fingerprint not in seen, f"{file.relative_to(package)} does not count"
        seen.add(fingerprint)


@pytest.mark.parametrize("change", ["added", "removed", "renamed"])
def test_a_file_that_comes_or_goes_changes_the_fingerprint(
    experiment: Experiment, package: Path, change: str
) -> None:
    before = code_fingerprint(experiment, package)
    file = package / "front_end" / "steps" / "zero_crossing.py"
    if change == "added":
        (file.parent / "new.py").touch()
    elif change == "removed":
        file.unlink()
    else:
        file.rename(file.with_name("zero_crossings.py"))
    assert code_fingerprint(experiment, package) != before
