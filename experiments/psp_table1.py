"""Table I of PSP (Hong et al. 2013) on simulated walks: how far from the start a closed walk ends.

    python experiments/psp_table1.py [--tests 25] [--seed 0]

Five simulated people carry a phone nearly straight in the left or right front pocket, either way round trajectory I
(204.0 m, straight legs) and II (290.0 m, with a circle walked five times): 25 tests on each (`psp_walks`). Steps and
their lengths are those of the defaults; headings are those of each method, its compensation in the headings; the walk
is dead reckoning from the known start. The return position error is the distance from the end of the track to its
start, which is where the walker is; its mean over the tests stands beside the paper's, in m and in percent of the
walk. The increment of HDE, of which the paper gives no value, is the configuration's.

Writes experiments/results/psp_table1.json and .txt.
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path as File

import numpy as np

from pdr_est.config import Config, EstimatorParams, StartParams
from pdr_est.frames import Array
from pdr_est.front_end.heading import HeadingName, HeadingParams
from pdr_est.pipeline import smooth
from pdr_est.simulate import (
    PSP_TESTS,
    Path,
    PocketPhone,
    Scenario,
    SimulatedWalk,
    Trajectory,
    psp_walks,
    simulate_walk,
)

RESULTS = File(__file__).parent / "results"
METHODS: tuple[HeadingName, ...] = ("psp", "hde", "gyro", "magnetometer")
TRAJECTORIES: tuple[Trajectory, ...] = ("I", "II")
PAPER_M: dict[Trajectory, dict[HeadingName, float]] = {
    "I": {"psp": 1.967, "hde": 2.134, "gyro": 20.547, "magnetometer": 19.410},
    "II": {"psp": 3.868, "hde": 19.922, "gyro": 22.112, "magnetometer": 25.796},
}
GROUPS = tuple(f"{side}, {way}" for side in ("left", "right") for way in ("clockwise", "counter-clockwise"))


@dataclass(frozen=True)
class Returns:
    """The tests on one trajectory. length_m: of the walk; group: (n) one of GROUPS; error_m: (n,) by method."""

    length_m: float
    group: tuple[str, ...]
    error_m: dict[HeadingName, Array]

    def mean_m(self, method: HeadingName, group: str | None = None) -> float:
        """Mean return position error, m, of all tests or of those of a group; NaN without any."""
        chosen = [error for error, own in zip(self.error_m[method], self.group, strict=True) if group in (None, own)]
        return float(np.mean(chosen)) if chosen else float("nan")

    def percent(self, method: HeadingName) -> float:
        """The mean in percent of the walk."""
        return 100.0 * self.mean_m(method) / self.length_m


def main() -> None:
    """Simulate, reckon, print and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tests", type=int, default=PSP_TESTS)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    table = {
        trajectory: measured(psp_walks(trajectory, arguments.tests, arguments.seed)) for trajectory in TRAJECTORIES
    }
    text = as_text(table)
    document = json.dumps(as_document(table, arguments.seed), indent=2)
    (RESULTS / "psp_table1.json").write_text(document + "\n", encoding="utf-8")
    (RESULTS / "psp_table1.txt").write_text(text, encoding="utf-8")
    print(text, end="")


def measured(scenarios: Sequence[Scenario], methods: Sequence[HeadingName] = METHODS) -> Returns:
    """Return position errors on the walks of one trajectory."""
    error_m: dict[HeadingName, list[float]] = {method: [] for method in methods}
    for scenario in scenarios:
        walk = simulate_walk(scenario)
        for method in methods:
            error_m[method].append(return_error_m(walk, method))
    return Returns(
        length_m=Path(scenarios[0].path).length_m,
        group=tuple(group_of(scenario) for scenario in scenarios),
        error_m={method: np.array(errors) for method, errors in error_m.items()},
    )


def return_error_m(walk: SimulatedWalk, method: HeadingName) -> float:
    """From the end of the track to its start, m."""
    config = Config(
        heading=HeadingParams(method=method, use="increments"),
        start=StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0),
        estimator=EstimatorParams(name="dead-reckoning"),
    )
    track = smooth(walk.recording, config).track
    return float(np.linalg.norm(track.position_m[-1] - track.position_m[0]))


def group_of(scenario: Scenario) -> str:
    """Pocket and direction of a walk."""
    carry = scenario.devices[0].carry
    side = carry.side if isinstance(carry, PocketPhone) else "no pocket"
    return f"{side}, {'counter-clockwise' if Path(scenario.path).turn_rad.sum() > 0.0 else 'clockwise'}"


def as_document(table: dict[Trajectory, Returns], seed: int) -> dict[str, object]:
    """The numbers of the text, and the error of each test."""
    return {
        "seed": seed,
        "trajectories": {
            trajectory: {
                "length_m": round(returns.length_m, 3),
                "group": list(returns.group),
                "methods": {
                    method: {
                        "paper_m": PAPER_M[trajectory][method],
                        "mean_m": round(returns.mean_m(method), 3),
                        "percent": round(returns.percent(method), 3),
                        "error_m": np.round(errors, 3).tolist(),
                    }
                    for method, errors in returns.error_m.items()
                },
            }
            for trajectory, returns in table.items()
        },
    }


def as_text(table: dict[Trajectory, Returns]) -> str:
    """A block a trajectory, a line a method: the paper's mean and ours, then ours by pocket and direction."""
    lines = ["PSP Table I, average return position error of simulated walks"]
    for trajectory, returns in table.items():
        methods = tuple(returns.error_m)
        lines += [
            "",
            f"Trajectory {trajectory}, {returns.length_m:.1f} m, {len(returns.group)} tests",
            f"{'':16}{'paper':>16}{'ours':>16}{'median':>10}" + "".join(f"{group:>26}" for group in GROUPS),
            f"{'':16}{'m':>8}{'%':>8}" + f"{'m':>8}{'%':>8}{'m':>10}" + f"{'m':>26}" * len(GROUPS),
        ]
        for method in methods:
            paper_m = PAPER_M[trajectory][method]
            lines.append(
                f"{method:16}{paper_m:8.2f}{100.0 * paper_m / returns.length_m:8.2f}"
                f"{returns.mean_m(method):8.2f}{returns.percent(method):8.2f}"
                f"{float(np.median(returns.error_m[method])):10.2f}"
                + "".join(f"{returns.mean_m(method, group):26.2f}" for group in GROUPS)
            )
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
