"""What is needed to repeat an experiment: code, packages, data and seeds, each with a checksum."""

import hashlib
import json
import platform
import subprocess
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pdr_est import __version__
from pdr_est.config import external_files
from pdr_est.experiment.loader import Experiment
from pdr_est.experiment.suite import WalkFile
from pdr_est.front_end.gait import gait_model
from pdr_est.front_end.gait.model import model_digest
from pdr_est.io.writers.checksums import file_digests
from pdr_est.report.walk.summary import package_versions

Json = dict[str, Any]


def provenance(experiment: Experiment) -> Json:
    """The document. `fingerprint` holds what must agree for two runs to give the same numbers."""
    root = Path(__file__).parents[2]
    code = file_hashes(root, sorted(root.rglob("*.py")))
    models = [gait_model(variant.config.gait) for variant in experiment.variants]
    model_sums = sorted({model_digest(model) for model in models if model is not None})
    own_code = [file_hashes(folder, files) for folder, files in _own_code(experiment)]
    data = data_hashes(experiment)
    packages = package_versions()
    config = experiment.resolved()
    del config["data"]["folder"]  # the same data elsewhere are the same data
    simulated = {walk.name: walk.source for walk in experiment.walks if not isinstance(walk.source, WalkFile)}
    return {
        "experiment": experiment.title,
        "fingerprint": {
            "config": digest(config),
            "data": digest(data),
            "code": digest([code, model_sums, *([own_code] if own_code else [])]),
            "packages": digest(packages),
        },
        "version": __version__,
        "commit": _commit(root),
        "packages": packages,
        "platform": f"{platform.system()} {platform.machine()}",
        "seed": experiment.config.seed,
        "seeds": {name: scenario.seed for name, scenario in simulated.items()},
        "scenarios": {name: digest(asdict(scenario)) for name, scenario in simulated.items()},
        "data": data,
        "gait_models": model_sums,
    }


def _own_code(experiment: Experiment) -> list[tuple[Path, list[Path]]]:
    """List the files of the modules from outside the package that the variants name, each with its folder."""
    files = {file for variant in experiment.variants for file in external_files(variant.config)}
    return [(file.parent, [file]) for file in sorted(files)]


def data_hashes(experiment: Experiment) -> dict[str, str]:
    """SHA-256 of the recordings and of what lies beside them in their folders, such as tables of the truth."""
    paths = {walk.source.path for walk in experiment.walks if isinstance(walk.source, WalkFile)}
    folders = {path.parent for path in paths}
    files = {file for folder in folders for file in folder.iterdir() if file.is_file()}
    files |= {file for path in paths if path.is_dir() for file in path.rglob("*") if file.is_file()}
    return file_hashes(experiment.folder, sorted(files))


def file_hashes(root: Path, files: list[Path]) -> dict[str, str]:
    """SHA-256 of files by their path relative to a folder."""
    return dict(_hashes(root, files))


def digest(document: Any) -> str:
    """SHA-256 of a document as JSON."""
    text = json.dumps(document, sort_keys=True, ensure_ascii=False, default=str)
    return hashlib.sha256(text.encode("utf-8", errors="backslashreplace")).hexdigest()


def _hashes(root: Path, files: list[Path]) -> Iterator[tuple[str, str]]:
    for file in files:
        yield file.relative_to(root).as_posix(), file_digests(file)[file.name]


def _commit(root: Path) -> str | None:
    """The commit of the code, with + when files differ from it; None outside of a repository."""
    try:
        commit = _git(root, "rev-parse", "HEAD")
        return commit + ("+" if _git(root, "status", "--porcelain", "--", ".") else "")
    except (OSError, subprocess.SubprocessError):
        return None


def _git(root: Path, *arguments: str) -> str:
    command = ["git", "-C", str(root), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10.0).stdout.strip()
