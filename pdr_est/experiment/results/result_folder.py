"""Folder of an experiment's results: new, continued or refused."""

import json
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from pdr_est.errors import OutputError
from pdr_est.experiment.results.walk_result import SUFFIX
from pdr_est.output.atomic_output import MANIFEST
from pdr_est.output.own_files import OwnFiles
from pdr_est.output.staging import is_staging_name, remove_leftovers
from pdr_est.output.write_errors import output_errors

PROVENANCE, CONFIG, RESULTS, TIMINGS = "provenance.json", "config.yaml", "results.parquet", "timings.parquet"
FAILED, REPORT, COMPARED_CSV, COMPARED_TEXT = "failed.csv", "report.html", "compare.csv", "compare.md"
PARTS = "parts"
_FILES = (CONFIG, RESULTS, TIMINGS, FAILED, REPORT, COMPARED_CSV, COMPARED_TEXT, PROVENANCE)
_RESULT_FILE = re.compile(rf".*-[0-9a-f]{{10}}{re.escape(SUFFIX)}")  # of a walk


def open_result_folder(
    folder: Path, provenance: dict[str, Any], config: str, overwrite: bool, inputs: Sequence[Path] = ()
) -> Path:
    """Prepare the folder of the results and return the folder of the walks' results inside it.

    Results of walks without provenance have an unknown origin and are removed.

    Parameters
    ----------
    folder : Path
        Folder of the results; it is made if it does not exist.
    provenance : dict
        Provenance of this run.
    config : str
        Resolved experiment file.
    overwrite : bool
        True if results of another configuration, other data or other code may be removed; then nothing is reused.
    inputs : sequence of Path
        Files that are read, which are never replaced or removed.

    Raises
    ------
    OutputError
        If the folder contains files of other origin, or other results that must not be overwritten.
    """
    own = OwnFiles(folder, inputs)
    earlier = _earlier(folder)
    if earlier is not None and earlier.get("fingerprint") != provenance["fingerprint"]:
        if not overwrite:
            raise OutputError(
                f"{folder}: holds results of {_difference(earlier, provenance)}: allow overwriting (--overwrite) or "
                "choose another folder"
            )
        earlier = None
    if earlier is None or overwrite:
        _clear(own, folder)
    with output_errors(folder):
        (folder / PARTS).mkdir(parents=True, exist_ok=True)
    for place in (folder / PARTS, folder):
        remove_leftovers(place)
    if earlier is None or overwrite:
        own.write(CONFIG, config)
        own.write(PROVENANCE, json.dumps(provenance, indent=2, ensure_ascii=False) + "\n")
    return folder / PARTS


def compared_files(folders: Iterable[Path]) -> list[Path]:
    """List the files of some results that a comparison must not replace: all but those of earlier comparisons."""
    names = [name for name in _FILES if name not in (COMPARED_CSV, COMPARED_TEXT)]
    return [folder / name for folder in folders for name in names]


def _earlier(folder: Path) -> dict[str, Any] | None:
    """Read the provenance of the results in the folder; None if there are none."""
    if not folder.exists():
        return None
    if not folder.is_dir():
        raise OutputError(f"{folder}: is a file, not a folder: choose another one")
    if PROVENANCE not in OwnFiles(folder):
        _refuse_foreign(folder)
        return None
    try:
        document = json.loads((folder / PROVENANCE).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return document if isinstance(document, dict) else None


def _refuse_foreign(folder: Path) -> None:
    """Raise OutputError if the folder contains anything but what runs have written, also killed ones."""
    own = OwnFiles(folder)
    inside = list((folder / PARTS).iterdir()) if (folder / PARTS).is_dir() else []
    paths = [path for path in folder.iterdir() if path.name not in (PARTS, MANIFEST) and path.name not in own]
    paths += [path for path in inside if not _RESULT_FILE.fullmatch(path.name)]
    foreign = sorted(path.relative_to(folder).as_posix() for path in paths if not is_staging_name(path.name))
    if foreign:
        raise OutputError(f"{folder}: holds files of other origin ({foreign[0]}): choose a new or an empty folder")


def _clear(own: OwnFiles, folder: Path) -> None:
    """Remove the results, the provenance last, so that a killed run leaves no result without its origin."""
    for path in (folder / PARTS).glob(f"*{SUFFIX}"):
        if _RESULT_FILE.fullmatch(path.name):
            path.unlink(missing_ok=True)
    own.remove(_FILES)


def _difference(earlier: dict[str, Any], provenance: dict[str, Any]) -> str:
    """Say what differs between two fingerprints."""
    words = {
        "config": "another configuration",
        "data": "other data",
        "code": "another version of the code",
        "packages": "other versions of packages",
    }
    before = earlier.get("fingerprint")
    known = before if isinstance(before, dict) else {}
    different = [text for name, text in words.items() if known.get(name) != provenance["fingerprint"][name]]
    return ", ".join(different)
