"""Headings and positions of MMPDR (Tian et al. 2016), Tables VIII, IX and X and the park of Fig. 15, simulated.

    python experiments/mmpdr_table10.py [--seeds 0 1 2 …]

The walks of `mmpdr_walks.py`, reckoned from the known start by these chains. By dead reckoning: `paper` (modes,
steps, lengths and headings of MMPDR, as in configs/settings/mmpdr.yaml), `mmpdr` (its headings on modes, steps and
lengths of the defaults) and `step-yaw` (the defaults with the plain yaw of each step, for the park: what looks for
straight paths must not bend curved ones). `default` is the default as it is, which smooths the whole walk, and
`filtered` is the extended Kalman filter, as online.

The heading error of a step is the heading of the track less the direction of the path in the middle of the step; the
position error is taken at every metre of the path, when the walker passes it. Of a row: the median over walkers of
the largest and of the median heading error of a walk, the mean position error, and the mean travelled distance in
percent of the walk; of Table X: median, mean and 95th percentile over all steps of all walks, the travelled distance
in percent, and the mean position error in percent of the walk off 100.

For `default` and `filtered` the last column of Table X is the root mean square of the heading error over its standard
deviation.

Writes experiments/results/mmpdr_table10.json and .txt.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from mmpdr_walks import PAPER_CHAIN, POCKET, ROWS, SWING, Row, tabulate

from pdr_est.config import Config, EstimatorParams, StartParams
from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading import HeadingParams
from pdr_est.front_end.heading.mmpdr_aoc import MmpdrHeading, MmpdrHeadingParams, TrainedOffset
from pdr_est.pipeline import SmoothedWalk, smooth_recording
from pdr_est.simulate import SimulatedWalk
from pdr_est.types.steps import CarryingMode, Step

START = Config(estimator=EstimatorParams(name="dead-reckoning"))
CHAINS: dict[str, Config] = {
    "paper": PAPER_CHAIN,
    "mmpdr": replace(START, heading=HeadingParams(method="mmpdr")),
    "default": Config(),
    "step-yaw": replace(START, heading=HeadingParams(method="step-yaw")),
    "filtered": Config(estimator=EstimatorParams(name="ekf")),
}
HONEST = ("default", "filtered")  # chains whose standard deviations are reported


# Of the paper, for each of its walks of a row: largest and median heading error, deg, mean position error, m, and
# travelled distance, m, of 96.33 m.
PAPER: Mapping[str, tuple[tuple[float, float, float, float], ...]] = {
    "indoor HOLDING": ((14.23, 1.96, 0.75, 96.37),),
    "indoor SWING": ((14.8, 4.63, 1.33, 94.76),),
    "indoor POCKET": ((10.58, 3.16, 0.71, 93.31),),
    "indoor, all modes": (
        (17.0, 3.41, 1.34, 96.70),
        (15.98, 5.0, 2.0, 95.07),
        (13.52, 3.58, 0.83, 91.43),
        (11.22, 2.97, 1.01, 92.86),
        (9.91, 1.94, 0.3, 96.03),
    ),
    "indoor HOLDING, POCKET": ((6.43, 0.94, 0.84, 93.33),),
}
PAPER_M = 96.33
SUMMARY = {"single mode": ROWS[:3], "multi-mode": ROWS[3:5]}
PAPER_X = {"single mode": (2.84, 3.88, 10.94, 98.43, 99.03), "multi-mode": (2.88, 4.24, 12.06, 97.83, 98.91)}
PAPER_OFFSETS_DEG = {
    "SWING": (-1.43, -2.87, 2.98, -4.70, -5.96),
    "POCKET": (39.67, -6.88, 43.45, -56.46, 111.78, -62.48),
}


@dataclass(frozen=True)
class Errors:
    """Errors of one walk with one chain: of headings (steps,), also over their standard deviations, of positions at
    each metre, the travelled distance over the true one, and trained offsets.
    """

    heading_deg: Array
    over_sigma: Array
    position_m: Array
    length_m: float
    travelled: float
    offsets: tuple[TrainedOffset, ...]


Table = Mapping[str, dict[str, list[Errors]]]


def measured(row: Row, seeds: Sequence[int]) -> dict[str, list[Errors]]:
    """Measure the errors of the walkers of all seeds, by chain."""
    walks = row.walks(seeds)
    return {name: [errors_of(walk, config) for walk in walks] for name, config in CHAINS.items()}


def errors_of(walk: SimulatedWalk, config: Config) -> Errors:
    """Measure the errors of one chain on a walk."""
    smoothed = reckoned(walk, config)
    track, steps = smoothed.track, smoothed.devices[0].steps
    middle_s = np.array([0.5 * (step.start_s + step.event.time_s) for step in steps])
    off = wrap_angle(track.heading_rad[1:] - walk.heading_at(middle_s))
    marks_m = np.arange(1.0, np.floor(walk.distance_m))
    passed_s = walk.body.time_at(marks_m)
    at_mark = np.stack([np.interp(passed_s, track.time_s, axis) for axis in track.position_m.T], axis=1)
    return Errors(
        heading_deg=np.degrees(np.abs(off)),
        over_sigma=off / np.maximum(track.sigma_heading_rad[1:], 1e-3),
        position_m=np.linalg.norm(at_mark - walk.position_at(passed_s), axis=1),
        length_m=walk.distance_m,
        travelled=float(np.linalg.norm(np.diff(track.position_m, axis=0), axis=1).sum() / walk.distance_m),
        offsets=trained(steps) if config.heading.method == "mmpdr" else (),
    )


def reckoned(walk: SimulatedWalk, config: Config) -> SmoothedWalk:
    """Estimate a walk with one chain, from the known start."""
    return smooth_recording(walk.recording, replace(config, start=start_of(walk)))


def start_of(walk: SimulatedWalk) -> StartParams:
    """Return the start position and heading of the walk, which the walkers of the paper know exactly."""
    x_m, y_m = walk.truth_position_m[0].tolist()
    heading_rad = float(wrap_angle(walk.truth_heading_rad[0]))
    return StartParams(x_m=x_m, y_m=y_m, heading_rad=heading_rad, sigma_heading_rad=0.0)


def trained(steps: Sequence[Step]) -> tuple[TrainedOffset, ...]:
    """Compute the offsets that MMPDR trains on the steps of a walk."""
    heading = MmpdrHeading(MmpdrHeadingParams())
    for step in steps:
        heading.push(step)
    heading.flush()
    return heading.trained_offsets


def of_row(walks: Sequence[Errors]) -> tuple[float, float, float, float, float]:
    """Summarise a row.

    The results are the medians over walks of the largest and of the median heading error, deg, the 95th percentile
    over all steps, the mean position error, m, and the mean travelled distance, percent.
    """
    return (
        float(np.median([walk.heading_deg.max() for walk in walks])),
        float(np.median([np.median(walk.heading_deg) for walk in walks])),
        float(np.percentile(np.concatenate([walk.heading_deg for walk in walks]), 95)),
        float(np.mean([walk.position_m.mean() for walk in walks])),
        100.0 * float(np.mean([walk.travelled for walk in walks])),
    )


def of_table_10(walks: Sequence[Errors]) -> tuple[float, float, float, float, float, float]:
    """Compute the numbers of Table X.

    They are median, mean and 95th percentile of the heading error, deg, the travelled distance, percent, the position
    accuracy, percent, and the root mean square of the heading error over its standard deviation.
    """
    heading_deg = np.concatenate([walk.heading_deg for walk in walks])
    accuracy = 100.0 * (1.0 - np.mean([walk.position_m.mean() / walk.length_m for walk in walks]))
    return (
        float(np.median(heading_deg)),
        float(heading_deg.mean()),
        float(np.percentile(heading_deg, 95)),
        100.0 * float(np.mean([walk.travelled for walk in walks])),
        float(accuracy),
        float(np.sqrt(np.mean(np.concatenate([walk.over_sigma for walk in walks]) ** 2))),
    )


def offsets_deg(walks: Sequence[Errors], mode: CarryingMode) -> list[float]:
    """Return the offsets that were trained for a mode, deg, walk after walk."""
    return [float(np.degrees(offset.offset_rad)) for walk in walks for offset in walk.offsets if offset.mode is mode]


def as_document(table: Table, seeds: Sequence[int]) -> dict[str, object]:
    """Make the document with the numbers of the text."""
    words = ("heading_max_deg", "heading_median_deg", "heading_p95_deg", "position_m", "travelled_percent")
    return {
        "seeds": list(seeds),
        "rows": {
            row: {
                name: dict(zip(words, np.round(of_row(walks), 3).tolist(), strict=True)) for name, walks in by.items()
            }
            for row, by in table.items()
        },
        "heading_over_sigma": {
            words: {
                name: round(of_table_10([walk for row in rows for walk in table[row.words][name]])[5], 3)
                for name in HONEST
            }
            for words, rows in SUMMARY.items()
            if all(row.words in table for row in rows)
        },
        "trained_offsets_deg": {
            mode.name: np.round(offsets_deg(table["indoor, all modes"]["mmpdr"], mode), 1).tolist()
            for mode in (SWING, POCKET)
            if "indoor, all modes" in table
        },
    }


def as_text(table: Table, seeds: Sequence[int]) -> str:
    """Format a line for each kind of walk and chain after the numbers of the paper, then Table X and the offsets."""
    head = f"{'max':>8}{'median':>8}{'95 %':>8}{'pos. m':>8}{'dist. %':>8}"
    lines = [f"MMPDR Tables VIII to X, heading errors in degrees; {len(seeds)} walkers a row", "", f"{'':34}{head}"]
    for row in ROWS:
        if row.words not in table:
            continue
        if row.words in PAPER:
            largest, median, position_m, _ = np.median(PAPER[row.words], axis=0)
            travelled = 100.0 * np.mean([walk[3] for walk in PAPER[row.words]]) / PAPER_M
            numbers = f"{largest:8.2f}{median:8.2f}{'':8}{position_m:8.2f}{travelled:8.2f}"
            lines.append(f"{row.words:24}{'paper':10}{numbers}")
        for name, walks in table[row.words].items():
            label = row.words if name == "paper" and row.words not in PAPER else ""
            lines.append(f"{label:24}{f'= {name}':10}" + "".join(f"{value:8.2f}" for value in of_row(walks)))
    lines += ["", f"{'Table X':34}{'median':>8}{'mean':>8}{'95 %':>8}{'dist. %':>8}{'pos. %':>8}{'/ sigma':>8}"]
    for words, rows in SUMMARY.items():
        if not all(row.words in table for row in rows):
            continue
        lines.append(f"{words:24}{'paper':10}" + "".join(f"{value:8.2f}" for value in PAPER_X[words]))
        for name in CHAINS:
            walks = [walk for row in rows for walk in table[row.words][name]]
            values = of_table_10(walks)[: 6 if name in HONEST else 5]
            lines.append(f"{'':24}{f'= {name}':10}" + "".join(f"{value:8.2f}" for value in values))
    lines += ["", "Trained offsets, deg, walk after walk, chain mmpdr, indoor, all modes"]
    for mode in (SWING, POCKET):
        ours = offsets_deg(table.get("indoor, all modes", {}).get("mmpdr", []), mode)
        lines.append(f"{mode.name:8}paper " + " ".join(f"{value:.1f}" for value in PAPER_OFFSETS_DEG[mode.name]))
        lines.append(f"{'':8}ours  " + " ".join(f"{value:.1f}" for value in ours))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    tabulate("mmpdr_table10", __doc__, measured, as_text, as_document)
