"""Recordings of known person and gait in a data folder.

    DIR/motionsense/{wlk,jog}_N/sub_PERSON.csv     MotionSense, walking and jogging
    DIR/sisfall/PERSON/D0{1,2,3,4}_PERSON_R01.txt  SisFall, walking, jogging and running
    DIR/{walking,jogging,running}/PERSON/*         own recordings: files or folders of any known format

Each part may be missing; files may be gzipped. If there are own recordings, everything in the folder has to belong to
one of these parts, so that no misplaced recording is left out unnoticed.
"""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pdr_est.errors import RecordingError
from pdr_est.evaluate.gait_recognition import KNOWN_BY_NAME
from pdr_est.io.writers.checksums import file_digests
from pdr_est.types.recording import Recording
from pdr_est.types.steps import Gait

OWN = "own"
"""The name of a user's recordings as a data set."""

LAYOUT = "motionsense/, sisfall/, or {walking,jogging,running}/PERSON/RECORDING"

_PUBLIC = ("motionsense", "sisfall")


@dataclass(frozen=True)
class LabelledFile:
    """Recording of one person.

    Attributes
    ----------
    path : Path
        File or folder of the recording.
    data_set : str
        Name of its data set.
    person : str
        Person who walked or ran.
    gait : Gait or None
        Gait by the folder; None when the recording itself names it.
    """

    path: Path
    data_set: str
    person: str
    gait: Gait | None = None

    def gait_of(self, recording: Recording) -> Gait:
        """Return the gait that the folder or the recording names.

        Raises
        ------
        RecordingError
            If neither names it.
        """
        gait = self.gait or KNOWN_BY_NAME.get(recording.truth.activity or "")
        if gait is None:
            raise RecordingError(
                f"{self.path}: activity {recording.truth.activity!r} is none of {', '.join(KNOWN_BY_NAME)}: "
                "keep the folders and file names of the data set"
            )
        return gait


def labelled_files(data: Path) -> list[LabelledFile]:
    """List the recordings in a data folder, in a fixed order.

    Raises
    ------
    RecordingError
        If there is none, or an own recording is misplaced.
    """
    if not data.is_dir():
        raise RecordingError(f"{data}: no such folder: give the folder that holds {LAYOUT}")
    found = [*_motionsense(data / "motionsense"), *_sisfall(data / "sisfall"), *_own(data)]
    if not found:
        raise RecordingError(f"{data}: no recording of a known gait inside: give the folder that holds {LAYOUT}")
    return found


def recordings_digest(data: Path) -> str:
    """Compute the SHA-256 over names and contents of the recordings of `labelled_files`.

    Raises
    ------
    RecordingError
        As `labelled_files`.
    """
    lines = [
        f"{file.path.relative_to(data).as_posix()} {name} {content}\n"
        for file in labelled_files(data)
        for name, content in file_digests(file.path).items()
    ]
    return hashlib.sha256("".join(sorted(lines)).encode("utf-8", "surrogateescape")).hexdigest()


def _motionsense(folder: Path) -> Iterator[LabelledFile]:
    for activity in ("wlk_*", "jog_*"):
        for path in _files(folder, f"{activity}/sub_*.csv"):
            number = _bare(path).removeprefix("sub_")
            yield LabelledFile(path, "motionsense", f"motionsense/{number}")


def _sisfall(folder: Path) -> Iterator[LabelledFile]:
    for path in _files(folder, "*/D0[1-4]_*.txt"):
        yield LabelledFile(path, "sisfall", f"sisfall/{path.parent.name}")


def _own(folder: Path) -> Iterator[LabelledFile]:
    """List own recordings; raise RecordingError for what would be left out: misplaced, unknown or empty."""
    given = [path for path in _visible(folder) if path.is_dir() and path.name not in _PUBLIC]
    if not any(path.name in KNOWN_BY_NAME for path in given):
        return
    for gait_folder in given:
        if gait_folder.name not in KNOWN_BY_NAME:
            raise RecordingError(
                f"{gait_folder}: is none of {', '.join(KNOWN_BY_NAME)}: rename it, or move it elsewhere"
            )
        for person in _filled(gait_folder):
            if not person.is_dir():
                raise RecordingError(f"{person}: has no folder of its person: put it into {gait_folder}/PERSON/")
            for path in _filled(person):
                yield LabelledFile(path, OWN, f"{OWN}/{person.name}", KNOWN_BY_NAME[gait_folder.name])


def _filled(folder: Path) -> list[Path]:
    """List the content of a folder; raise RecordingError when it is empty."""
    found = _visible(folder)
    if not found:
        raise RecordingError(f"{folder}: holds no recording: remove the folder, or put the recordings into it")
    return found


def _visible(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if not path.name.startswith("."))


def _files(folder: Path, pattern: str) -> list[Path]:
    """List files in order of name; one that is there plain and gzipped is taken once."""
    found = {path.with_name(_bare(path)): path for path in (*folder.glob(f"{pattern}.gz"), *folder.glob(pattern))}
    return [found[name] for name in sorted(found)]


def _bare(path: Path) -> str:
    """Remove all extensions from a file name."""
    return path.name.split(".")[0]
