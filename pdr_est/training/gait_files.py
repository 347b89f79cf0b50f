"""Recordings whose person and gait are known, in a data folder.

    DIR/motionsense/{wlk,jog}_N/sub_PERSON.csv     MotionSense, walking and jogging
    DIR/sisfall/PERSON/D0{1,2,3,4}_PERSON_R01.txt  SisFall, walking, jogging and running
    DIR/{walking,jogging,running}/PERSON/*         own recordings: files or folders of any known format

Each part may be missing; files may be gzipped.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pdr_est.errors import RecordingError
from pdr_est.io.recording import Recording
from pdr_est.records import Gait

OWN = "own"
"""The name of a user's recordings as a data set."""

LAYOUT = "motionsense/, sisfall/, or {walking,jogging,running}/PERSON/RECORDING"

_GAITS = {gait.name.lower(): gait for gait in (Gait.WALKING, Gait.JOGGING, Gait.RUNNING)}


@dataclass(frozen=True)
class LabelledFile:
    """A recording of one person. gait: None when the recording itself tells it."""

    path: Path
    data_set: str
    person: str
    gait: Gait | None = None

    def gait_of(self, recording: Recording) -> Gait:
        """The gait in words of the folder or of the recording. Raises RecordingError when neither tells it."""
        gait = self.gait or _GAITS.get(recording.truth.activity or "")
        if gait is None:
            raise RecordingError(
                f"{self.path}: activity {recording.truth.activity!r} is none of {', '.join(_GAITS)}: "
                "keep the folders and file names of the data set"
            )
        return gait


def labelled_files(data: Path) -> list[LabelledFile]:
    """The recordings in a data folder, in a fixed order. Raises RecordingError when there is none."""
    if not data.is_dir():
        raise RecordingError(f"{data}: no such folder: give the folder that holds {LAYOUT}")
    found = [*_motionsense(data / "motionsense"), *_sisfall(data / "sisfall"), *_own(data)]
    if not found:
        raise RecordingError(f"{data}: no recording of a known gait inside: give the folder that holds {LAYOUT}")
    return found


def _motionsense(folder: Path) -> Iterator[LabelledFile]:
    for activity in ("wlk_*", "jog_*"):
        for path in _files(folder, f"{activity}/sub_*.csv"):
            number = _bare(path).removeprefix("sub_")
            yield LabelledFile(path, "motionsense", f"motionsense/{number}")


def _sisfall(folder: Path) -> Iterator[LabelledFile]:
    for path in _files(folder, "*/D0[1-4]_*.txt"):
        yield LabelledFile(path, "sisfall", f"sisfall/{path.parent.name}")


def _own(folder: Path) -> Iterator[LabelledFile]:
    for name, gait in _GAITS.items():
        for path in sorted((folder / name).glob("*/*")):
            if not path.name.startswith("."):
                yield LabelledFile(path, OWN, f"{OWN}/{path.parent.name}", gait)


def _files(folder: Path, pattern: str) -> list[Path]:
    """Files in order of name; one that is there plain and gzipped is taken once."""
    found = {path.with_name(_bare(path)): path for path in (*folder.glob(f"{pattern}.gz"), *folder.glob(pattern))}
    return [found[name] for name in sorted(found)]


def _bare(path: Path) -> str:
    """Name without extensions."""
    return path.name.split(".")[0]
