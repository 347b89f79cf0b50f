"""Why the numbers of MMPDR's chain differ from its Tables VIII to X: one part after the other replaced by the truth.

    python experiments/mmpdr_causes.py [--seeds 0 1 2 …]

The walks and the chain of `mmpdr_walks.py`; of rows with several modes also the walks in which the state
machine recognises each of them, as it did in all of the paper's. Steps counted, in percent of those taken: as
they are; without those later than `AFTER_S` behind the last heel strike, while trunk and arm come to rest;
then with the steps that were taken in the transitions in place of those that eq. 8 gives. Position, 100 less
the mean error in percent of the walk: as it is; with the length of each step that brings the walker to where
he is at its time; and with the direction of the path in the middle of each step. Median and 95th percentile
of the heading error over all steps, deg. Last, the number of walks, and of walkers who were replaced because
the state machine mistook their single mode.

Writes experiments/results/mmpdr_causes.json and .txt.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from mmpdr_table10 import reckoned
from mmpdr_walks import PAPER_CHAIN, Row, recognised, replaced, tabulate

from pdr_est.frames import Array, wrap_angle
from pdr_est.simulate import SimulatedWalk
from pdr_est.types.steps import CarryingMode

AFTER_S = 0.2
TITLES = ("steps", "to the end", "+ eq. 8", "position", "lengths", "headings")
HEADINGS = ("median, deg", "95 %, deg")


@dataclass(frozen=True)
class Causes:
    """Of a walk: steps and positions as they are and with parts replaced, percent, (6,), and heading errors, deg."""

    numbers: Array
    heading_deg: Array


@dataclass(frozen=True)
class RowCauses:
    """Causes of the walks of a row, those whose modes are recognised if there are several, and walkers replaced."""

    walks: tuple[Causes, ...]
    recognised: tuple[Causes, ...] | None
    replaced: int


def measured(row: Row, seeds: Sequence[int]) -> RowCauses:
    """Measure the walks of all seeds."""
    walks = row.walks(seeds)
    causes = tuple(numbers_of(walk) for walk in walks)
    right = tuple(one for one, walk in zip(causes, walks, strict=True) if recognised(walk))
    return RowCauses(causes, right if len(row.modes) > 1 else None, replaced(walks))


def numbers_of(walk: SimulatedWalk) -> Causes:
    """Compute the numbers of one walk."""
    device, track = (smoothed := reckoned(walk, PAPER_CHAIN)).devices[0], smoothed.track
    end_s = np.array([step.event.time_s for step in device.steps])
    compensated = np.array([step.event.compensated for step in device.steps])
    in_time = end_s <= walk.steps.time_s[-1] + AFTER_S
    taken_in_transitions = int(np.sum(mode_at(device.level, walk.steps.time_s) == CarryingMode.TRANS))
    counts = len(end_s), in_time.sum(), (in_time & ~compensated).sum() + taken_in_transitions
    begin_s = np.concatenate([track.time_s[:1], end_s[:-1]])
    length_m = np.linalg.norm(np.diff(track.position_m, axis=0), axis=1)
    true_m = walked_m(walk, end_s) - walked_m(walk, begin_s)
    heading_rad = track.heading_rad[1:]
    true_rad = walk.heading_at(0.5 * (begin_s + end_s))
    tracks = ((length_m, heading_rad), (true_m, heading_rad), (length_m, true_rad))
    times_s = np.concatenate([track.time_s[:1], end_s])
    positions = [position_percent(walk, times_s, *one) for one in tracks]
    numbers = np.array([*(100.0 * count / walk.step_count for count in counts), *positions])
    return Causes(numbers, np.degrees(np.abs(wrap_angle(heading_rad - true_rad))))


def mode_at(blocks: Sequence[object], time_s: Array) -> Array:
    """Look up the label of the sample at each time."""
    sampled_s, modes = (np.concatenate([getattr(block, name) for block in blocks]) for name in ("time_s", "mode"))
    labels: Array = modes[np.minimum(np.searchsorted(sampled_s, time_s), len(modes) - 1)]
    return labels


def walked_m(walk: SimulatedWalk, time_s: Array) -> Array:
    """Compute how far the walker has come at each time."""
    return walk.body.at(time_s).on_path.value


def position_percent(walk: SimulatedWalk, time_s: Array, length_m: Array, heading_rad: Array) -> float:
    """Reckon from the known start; return 100 less the mean error at every metre, percent of the walk."""
    steps_m = length_m[:, None] * np.stack([np.cos(heading_rad), np.sin(heading_rad)], axis=1)
    position_m = walk.truth_position_m[0] + np.concatenate([np.zeros((1, 2)), np.cumsum(steps_m, axis=0)])
    passed_s = walk.body.time_at(np.arange(1.0, np.floor(walk.distance_m)))
    at_mark = np.stack([np.interp(passed_s, time_s, axis) for axis in position_m.T], axis=1)
    error_m = np.linalg.norm(at_mark - walk.position_at(passed_s), axis=1)
    return 100.0 * (1.0 - float(error_m.mean()) / walk.distance_m)


def lines_of(table: Mapping[str, RowCauses]) -> dict[str, tuple[list[float], int, int]]:
    """Average each row, and the recognised walks of it: numbers and heading errors, walks, and walkers replaced."""
    groups = {}
    for words, row in table.items():
        groups[words] = (averaged(row.walks), len(row.walks), row.replaced)
        if row.recognised:
            groups[f"{words}; recognised"] = (averaged(row.recognised), len(row.recognised), 0)
    return groups


def averaged(causes: Sequence[Causes]) -> list[float]:
    """Average numbers over walks; take median and 95th percentile of the heading error over all steps."""
    heading_deg = np.concatenate([one.heading_deg for one in causes])
    numbers = np.mean([one.numbers for one in causes], axis=0)
    return [*numbers.tolist(), float(np.median(heading_deg)), float(np.percentile(heading_deg, 95))]


def as_document(table: Mapping[str, RowCauses], seeds: Sequence[int]) -> dict[str, object]:
    """Make the document with the numbers of the text."""
    rows = {
        words: {
            **dict(zip((*TITLES, *HEADINGS), np.round(numbers, 2).tolist(), strict=True)),
            "walks": walks,
            "replaced_walkers": others,
        }
        for words, (numbers, walks, others) in lines_of(table).items()
    }
    return {"seeds": list(seeds), "rows": rows}


def as_text(table: Mapping[str, RowCauses], seeds: Sequence[int]) -> str:
    """Format a line for each row."""
    titles = "".join(f"{title:>12}" for title in (*TITLES, *HEADINGS, "walks", "replaced"))
    lines = [
        f"MMPDR's chain with parts replaced by the truth, percent; {len(seeds)} walkers a row",
        "",
        f"{'':36}{titles}",
    ]
    for words, (numbers, walks, others) in lines_of(table).items():
        lines.append(f"{words:36}" + "".join(f"{value:12.2f}" for value in numbers) + f"{walks:12d}{others:12d}")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    tabulate("mmpdr_causes", __doc__, measured, as_text, as_document)
