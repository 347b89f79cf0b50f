"""Figure 3 of PSP (Hong et al. 2013) on simulated walks: paths of one man with the phone in the left pocket.

    python experiments/psp_figure3.py [--seed 11]

The walks are those of psp_table1.py on trajectory I and II, either way round, with the phone in the left pocket,
and reckoned by each of its headings, from the known start, with the increments that its results have. The paper's
paths (c) to (f) are those of one male user; its panels (a) and (b) are the trajectories alone, which are the true
paths here. Figure 3 is not in the text that we have: where the circle of trajectory II lies is ours. Above with the
set-up "paper", below with legs that circle.

Reads experiments/results/psp_table1.json.

Writes experiments/results/psp_figure3.png, .json and .txt.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from psp_table1 import TRAJECTORIES, Method, SetUp, group_of, settings, walks
from recorded import RESULTS, command_line, write

from pdr_est.pipeline import smooth_recording
from pdr_est.simulate import PspTrajectory, Scenario, SimulatedWalk, WalkingPath, simulate_walk
from pdr_est.types.track import Track

SHOWN: tuple[Method, ...] = ("psp", "hde", "gyro", "magnetometer", "auto")
SHOWN_SET_UPS: tuple[SetUp, ...] = ("paper", "circling legs")
WAYS = ("clockwise", "counter-clockwise")
COLOURS = dict(zip(SHOWN, ("tab:red", "tab:blue", "tab:orange", "tab:green", "tab:purple"), strict=True))
ENOUGH_TESTS = 25  # among which each person, pocket and way is found


@dataclass(frozen=True)
class Panel:
    """One walk: set-up and direction as in psp_table1.py, and the track with each heading."""

    trajectory: PspTrajectory
    set_up: SetUp
    way: str
    walk: SimulatedWalk
    tracks: Mapping[Method, Track]

    def return_error_percent(self, method: Method) -> float:
        """Compute the distance from the end of the track to its start, percent of the path."""
        position_m = self.tracks[method].position_m
        return (
            100.0
            * float(np.linalg.norm(position_m[-1] - position_m[0]))
            / WalkingPath(self.walk.scenario.path).length_m
        )


def main() -> None:
    """Simulate, draw and write."""
    seed = command_line(__doc__, {"--seed": 11}).seed
    panels = [
        panel(trajectory, set_up, way, seed)
        for set_up in SHOWN_SET_UPS
        for trajectory in TRAJECTORIES
        for way in WAYS
    ]
    draw(panels).savefig(RESULTS / "psp_figure3.png", dpi=80, metadata={"Software": None})
    write("psp_figure3", as_text(panels), as_document(panels, seed))


def panel(trajectory: PspTrajectory, set_up: SetUp, way: str, seed: int) -> Panel:
    """Estimate the walk of the first man in that direction with each heading."""
    walk = simulate_walk(of_a_man(trajectory, set_up, way, seed))
    chosen = json.loads((RESULTS / "psp_table1.json").read_text(encoding="utf-8"))["increment_radps"]
    tracks = {
        method: smooth_recording(walk.recording, settings(method, chosen.get(method, 0.0))).track for method in SHOWN
    }
    return Panel(trajectory, set_up, way, walk, tracks)


def of_a_man(trajectory: PspTrajectory, set_up: SetUp, way: str, seed: int) -> Scenario:
    """Return the first test in that direction of the first man among the people, left pocket."""
    tests = walks(trajectory, set_up, seed, ENOUGH_TESTS)
    height_m = next(test.gait.height_m for test in tests if test.gait.gender == "male")
    return next(test for test in tests if test.gait.height_m == height_m and group_of(test) == f"left, {way}")


def as_document(panels: Sequence[Panel], seed: int) -> dict[str, object]:
    """Make the document with the numbers of the text."""
    return {
        "seed": seed,
        "return_error_percent": [
            {
                "trajectory": one.trajectory,
                "set_up": one.set_up,
                "way": one.way,
                **{method: round(one.return_error_percent(method), 2) for method in SHOWN},
            }
            for one in panels
        ],
    }


def as_text(panels: Sequence[Panel]) -> str:
    """Format a line for each walk: the error at its end with each heading."""
    head = "".join(f"{method:>14}" for method in SHOWN)
    lines = ["PSP Fig. 3: return position error of the paths, percent of the way", "", f"{'':46}{head}"]
    for one in panels:
        label = f"{one.trajectory}, left pocket, {one.way}, {one.set_up}"
        lines.append(f"{label:46}" + "".join(f"{one.return_error_percent(method):14.2f}" for method in SHOWN))
    return "\n".join(lines) + "\n"


def draw(panels: Sequence[Panel]) -> Figure:
    """Draw a row of panels for each set-up."""
    figure = Figure(figsize=(18.0, 9.0), layout="constrained")
    rows = figure.subplots(2, len(panels) // 2, squeeze=False)
    for axes, one in zip(rows.flat, panels, strict=True):
        axes.plot(*one.walk.truth_position_m.T, "--", color="0.3", linewidth=1.0, label="true path")
        for method, track in one.tracks.items():
            axes.plot(*track.position_m.T, color=COLOURS[method], linewidth=1.3, label=method)
        axes.set(
            title=f"{one.trajectory}, left pocket, {one.way}\n{one.set_up}",
            xlabel="east, m",
            ylabel="north, m",
        )
        axes.set_aspect("equal", adjustable="datalim")
    lines, labels = rows[0, 0].get_legend_handles_labels()
    figure.legend(lines, labels, loc="outside upper center", ncols=len(labels))
    return figure


if __name__ == "__main__":
    main()
