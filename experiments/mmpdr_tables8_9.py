"""Step counts of MMPDR (Tian et al. 2016), Tables VIII and IX and the park of Fig. 15, on simulated walks.

    python experiments/mmpdr_tables8_9.py [--seeds 0 1 2 …]

Each seed is a walker: the corridor of 96.33 m in each single mode (Table VIII) and changing between the modes (Table
IX), and the park of 348 m in all three modes; see `mmpdr_walks.py`. Counted is by the paper's chain (`mmpdr`), and by
the defaults (`auto`). The ratio is steps counted / steps taken over all walks of a row; the error is the mean
over walks of |counted - taken| / taken, in which too many here does not make up for too few there.

Writes experiments/results/mmpdr_tables8_9.json and .txt. The tables' headings and positions are not in it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from mmpdr_walks import PAPER_CHAIN, ROWS, Row, replaced, tabulate
from numpy.typing import NDArray

from pdr_est.config import Config
from pdr_est.pipeline import analyse_recording

CONFIGS = {"mmpdr": PAPER_CHAIN, "auto": Config()}
METHODS = tuple(CONFIGS)
# Of the paper, for each of its walks of a row: steps counted, steps taken.
PAPER: Mapping[str, tuple[tuple[int, int], ...]] = {
    "indoor HOLDING": ((131, 131),),
    "indoor SWING": ((127, 128),),
    "indoor POCKET": ((126, 128),),
    "indoor, all modes": ((139, 140), (141, 140), (137, 140), (124, 130), (127, 133)),
    "indoor HOLDING, POCKET": ((125, 128),),
    "anywhere, all modes": ((139, 140), (141, 140), (137, 140), (124, 130), (127, 133)),
    "park, all modes": ((447, 458),),
}


@dataclass(frozen=True)
class Counts:
    """Steps taken, (n,), and counted by each method, (n,), in the walks of a row, and the walkers replaced."""

    taken: NDArray[np.int64]
    counted: dict[str, NDArray[np.int64]]
    replaced: int

    def ratio(self, method: str) -> float:
        """Compute steps counted / steps taken, percent."""
        return 100.0 * float(self.counted[method].sum() / self.taken.sum())

    def error(self, method: str) -> float:
        """Compute the mean over walks of the absolute error of the count, percent."""
        return 100.0 * float(np.mean(np.abs(self.counted[method] - self.taken) / self.taken))


def measured(row: Row, seeds: Sequence[int]) -> Counts:
    """Count the steps of the walkers of all seeds."""
    walks = row.walks(seeds)
    return Counts(
        taken=np.array([walk.step_count for walk in walks]),
        counted={
            method: np.array([len(analyse_recording(walk.recording, config)[0].steps) for walk in walks])
            for method, config in CONFIGS.items()
        },
        replaced=replaced(walks),
    )


def paper_ratio(row: Row) -> float:
    """Return steps counted / steps taken in the paper, percent."""
    counted, taken = np.sum(PAPER[row.words], axis=0)
    return 100.0 * float(counted / taken)


def as_document(table: Mapping[str, Counts], seeds: Sequence[int]) -> dict[str, object]:
    """Make the document with the numbers of the text, in percent, and the counts of each walk."""
    rows = {
        row.words: {
            "paper_ratio": round(paper_ratio(row), 2),
            "replaced_walkers": table[row.words].replaced,
            "taken": table[row.words].taken.tolist(),
            **{
                method: {
                    "ratio": round(table[row.words].ratio(method), 2),
                    "error": round(table[row.words].error(method), 2),
                    "counted": table[row.words].counted[method].tolist(),
                }
                for method in METHODS
            },
        }
        for row in ROWS
    }
    return {"seeds": list(seeds), "rows": rows}


def as_text(table: Mapping[str, Counts], seeds: Sequence[int]) -> str:
    """Format a line for each row: the ratio of the paper, then ratio and error of each method."""
    lines = [
        f"MMPDR Tables VIII, IX and the park, percent of the steps taken; {len(seeds)} walkers a row",
        "",
        f"{'':24}{'paper':>8}" + "".join(f"{method:>18}" for method in METHODS),
        f"{'':24}{'ratio':>8}" + f"{'ratio':>10}{'error':>8}" * len(METHODS),
    ]
    for row in ROWS:
        counts = table[row.words]
        line = f"{row.words:24}{paper_ratio(row):8.2f}"
        line += "".join(f"{counts.ratio(method):10.2f}{counts.error(method):8.2f}" for method in METHODS)
        lines.append(line + (f"  {counts.replaced} walkers replaced" if counts.replaced else ""))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    tabulate("mmpdr_tables8_9", __doc__, measured, as_text, as_document)
