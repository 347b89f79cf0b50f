"""Provenance of an experiment: checksums of the code, the packages and the data, and the seeds."""

import hashlib
import json
import platform
import subprocess
from collections.abc import Iterable
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path
from typing import Any

from pdr_est import __version__
from pdr_est.config import external_files
from pdr_est.experiment.loader import Experiment
from pdr_est.experiment.suite import WalkFile
from pdr_est.experiment.variants.axes import TRACK_FILES
from pdr_est.front_end.gait import gait_model
from pdr_est.front_end.gait.model import model_digest
from pdr_est.io.writers.checksums import file_digests
from pdr_est.report.walk.summary import package_versions

PACKAGE_FOLDER = Path(str(files("pdr_est")))


def provenance(experiment: Experiment, package: Path = PACKAGE_FOLDER) -> dict[str, Any]:
    """Describe everything that is needed to repeat an experiment.

    Parameters
    ----------
    experiment : Experiment
        The experiment.
    package : Path
        Folder of the code.

    Returns
    -------
    dict
        The document; `fingerprint` contains what must agree for two runs to give the same numbers.
    """
    models = [gait_model(variant.config.gait) for variant in experiment.variants]
    model_digests = sorted({model_digest(model) for model in models if model is not None})
    data = data_digests(experiment)
    tracks = track_digests(experiment)
    own_code = _own_code(experiment)
    packages = package_versions()
    config = experiment.resolved()
    del config["data"]["folder"]  # the same data in another folder are the same data
    config["variants"] = {
        name: settings if TRACK_FILES not in settings else TRACK_FILES
        for name, settings in config["variants"].items()
    }
    simulated = {walk.name: walk.source for walk in experiment.walks if not isinstance(walk.source, WalkFile)}
    return {
        "experiment": experiment.title,
        "fingerprint": {
            "config": json_digest(config),
            "data": json_digest([data, tracks] if tracks else data),
            "code": json_digest([code_digests(package), model_digests, *([own_code] if own_code else [])]),
            "packages": json_digest(packages),
        },
        "version": __version__,
        "commit": _commit(package),
        "packages": packages,
        "platform": f"{platform.system()} {platform.machine()}",
        "seed": experiment.config.seed,
        "seeds": {name: scenario.seed for name, scenario in simulated.items()},
        "scenarios": {name: json_digest(asdict(scenario)) for name, scenario in simulated.items()},
        "data": data,
        **({"tracks": tracks} if tracks else {}),
        "gait_models": model_digests,
    }


def _own_code(experiment: Experiment) -> list[dict[str, str]]:
    """Compute the SHA-256 of each module from outside the package that the variants name."""
    modules = {file for variant in experiment.variants for file in external_files(variant.config)}
    return [_digests(file.parent, [file]) for file in sorted(modules)]


def code_digests(package: Path) -> dict[str, str]:
    """Compute the SHA-256 of every Python file of a package, in all its folders, by relative path."""
    return _digests(package, package.rglob("*.py"))


def data_digests(experiment: Experiment) -> dict[str, str]:
    """Compute the SHA-256 of the recordings and of all files beside them, such as tables of the ground truth."""
    paths = {walk.source.path for walk in experiment.walks if isinstance(walk.source, WalkFile)}
    found = {file for folder in {path.parent for path in paths} for file in folder.iterdir()}
    found |= {file for path in paths if path.is_dir() for file in path.rglob("*")}
    return _digests(experiment.folder, (file for file in found if file.is_file()))


def track_digests(experiment: Experiment) -> dict[str, dict[str, str | None]]:
    """Compute the SHA-256 of each track file of other programs, by variant and walk; None where it is missing."""
    return {
        variant.name: {walk.name: _digest_of(variant.track_file(walk.name)) for walk in experiment.walks}
        for variant in experiment.variants
        if variant.track_files is not None
    }


def _digest_of(path: Path) -> str | None:
    return file_digests(path)[path.name] if path.is_file() else None


def json_digest(document: Any) -> str:
    """Compute the SHA-256 of a document written as JSON."""
    text = json.dumps(document, sort_keys=True, ensure_ascii=False, default=str)
    return hashlib.sha256(text.encode("utf-8", errors="backslashreplace")).hexdigest()


def _digests(root: Path, paths: Iterable[Path]) -> dict[str, str]:
    return {path.relative_to(root).as_posix(): file_digests(path)[path.name] for path in sorted(paths)}


def _commit(folder: Path) -> str | None:
    """Return the commit of the code, followed by + if files differ from it; None outside of a repository."""
    try:
        commit = _git(folder, "rev-parse", "HEAD")
        return commit + ("+" if _git(folder, "status", "--porcelain", "--", ".") else "")
    except (OSError, subprocess.SubprocessError):
        return None


def _git(folder: Path, *arguments: str) -> str:
    command = ["git", "-C", str(folder), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10.0).stdout.strip()
