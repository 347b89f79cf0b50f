"""WeAllWalk: two iPhones at once in clothing pockets, corridors with turns, every heel strike annotated.

Each phone is a row. The walks are grouped by the walking aid in the file names: a kind of cane, a dog, or `NA` for
none.
"""

import re
from pathlib import Path

from pdr_est.evaluate.heading_errors import HEADING_METRICS
from pdr_est.evaluate.step_detection import STEP_METRICS
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.annotated_steps import heading_part, step_part
from pdr_est.experiment.scoring.track_scores import MetricPart, score_tracks
from pdr_est.experiment.suite import Suite, TrackScores, WalkFile
from pdr_est.frames import Array
from pdr_est.types.track import Track

_TABLE = re.compile(r"(?P<path>iPhoneSensors_T\d+_ID\d+)_(?:1L|2R)_(?P<aid>\w+)")


def _find(folder: Path) -> list[WalkFile]:
    """List the tables `iPhoneSensors_*.csv`; both phones are one walk with the name of the left phone's table."""
    walks: dict[tuple[Path, str, str], WalkFile] = {}
    for name, path in recordings(folder, "iPhoneSensors_*.csv"):
        match = _TABLE.fullmatch(Path(name).name)
        if match is not None:
            aid = match["aid"]
            walks.setdefault((path.parent, match["path"], aid), WalkFile(name, path, {"aid": aid}, group=aid))
    return list(walks.values())


def _score(walk: AnalysedWalk) -> list[TrackScores]:
    """Score steps and headings of each phone, and of the person who carries both."""

    def parts(name: str, step_s: Array, track: Track) -> list[MetricPart]:
        return [step_part(walk, step_s), heading_part(walk, track.of_device(name))]

    return score_tracks(walk, parts, with_modes=False)


SUITE = Suite(
    name="weallwalk",
    folder="weallwalk",
    metrics=(*STEP_METRICS, *HEADING_METRICS),
    find=_find,
    score=_score,
)
