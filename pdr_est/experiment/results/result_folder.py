"""The folder of an experiment's results: begun, continued or refused."""

import json
from pathlib import Path
from typing import Any

from pdr_est.errors import OutputError
from pdr_est.experiment.runners.walk_result import SUFFIX

PROVENANCE, CONFIG, RESULTS, TIMINGS = "provenance.json", "config.yaml", "results.parquet", "timings.parquet"
FAILED, REPORT, COMPARED_CSV, COMPARED_TEXT = "failed.csv", "report.html", "compare.csv", "compare.md"
PARTS = "parts"
_FILES = (CONFIG, RESULTS, TIMINGS, FAILED, REPORT, COMPARED_CSV, COMPARED_TEXT, PROVENANCE)


def begin(folder: Path, document: dict[str, Any], config: str, overwrite: bool) -> Path:
    """Make the folder ready and give the one of its parts; document: the provenance of this run.

    Parts without provenance are of a run of which nothing is known, and are removed. Raises OutputError when the
    folder holds something else: files of other origin, or the results of another configuration, other data or other
    code, which are removed if they may be overwritten.
    """
    earlier = _earlier(folder)
    if earlier is not None and earlier.get("fingerprint") != document["fingerprint"]:
        if not overwrite:
            raise OutputError(
                f"{folder}: holds results of {_difference(earlier, document)}: allow overwriting (--overwrite) or "
                "choose another folder"
            )
        earlier = None
    if earlier is None or overwrite:
        _clear(folder)
    try:
        (folder / PARTS).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{folder}: cannot be made ({error.strerror}): choose another folder") from error
    if earlier is None or overwrite:
        write(folder / CONFIG, config)
        write(folder / PROVENANCE, json.dumps(document, indent=2, ensure_ascii=False) + "\n")
    return folder / PARTS


def write(path: Path, text: str) -> None:
    """Write a file so that it is there whole or not at all."""
    half = path.with_name(f".{path.name}.half")
    half.write_text(text, encoding="utf-8", errors="backslashreplace")
    half.replace(path)


def _earlier(folder: Path) -> dict[str, Any] | None:
    """The provenance of the run whose results are in the folder; None when there is nothing."""
    if not folder.exists():
        return None
    if not folder.is_dir():
        raise OutputError(f"{folder}: is a file, not a folder: choose another one")
    try:
        document = json.loads((folder / PROVENANCE).read_text(encoding="utf-8"))
        if isinstance(document, dict):
            return document
    except (OSError, ValueError):
        pass
    _refuse_foreign(folder)
    return None


def _refuse_foreign(folder: Path) -> None:
    """What is not from a run that was killed in its first moment stays untouched."""
    inside = list((folder / PARTS).iterdir()) if (folder / PARTS).is_dir() else []
    names = [path.name for path in folder.iterdir() if path.name not in (PARTS, CONFIG)]
    names += [f"{PARTS}/{path.name}" for path in inside if not path.name.endswith(SUFFIX)]
    foreign = sorted(name for name in names if not name.endswith(".half"))
    if foreign:
        raise OutputError(f"{folder}: holds files of other origin ({foreign[0]}): choose a new or an empty folder")


def _clear(folder: Path) -> None:
    """Remove the results, the provenance last: a run that is killed meanwhile leaves no part without its origin."""
    parts = [*(folder / PARTS).glob(f"*{SUFFIX}"), *(folder / PARTS).glob("*.half")]
    for path in [*parts, *(folder / name for name in _FILES)]:
        path.unlink(missing_ok=True)


def _difference(earlier: dict[str, Any], document: dict[str, Any]) -> str:
    """What another fingerprint means, in words."""
    words = {
        "config": "another configuration",
        "data": "other data",
        "code": "another version of the code",
        "packages": "other versions of packages",
    }
    before = earlier.get("fingerprint")
    known = before if isinstance(before, dict) else {}
    different = [text for name, text in words.items() if known.get(name) != document["fingerprint"][name]]
    return ", ".join(different)
