"""Table I of PSP (Hong et al. 2013) on simulated walks: distance of the end of a closed walk from its start.

    python experiments/psp_table1.py [--populations 2] [--training 8] [--seed 11]

Five simulated people carry a phone nearly straight in the left or right front pocket, either way round trajectory I
(204.0 m, straight parts only) and II (290.0 m, with a circle walked five times): 25 tests on each (`psp_walks`), and
as many of other people for every further population. Steps and their lengths are those of the defaults; headings
are those of each method, its compensation in the headings; the walk is dead reckoning. The gyroscope's bias is not
learned at rest, as the paper does not: the attitude filter would take the swaying of one who stands for it. The
return position error is the distance from the end of the track to its start, where the walker is again.

Four set-ups, each differing from the first in one thing:

* paper: legs and gyroscope with which the bare gyroscope errs as the paper's does (see `psp_walks`).
* small drift: the bias of the phone's gyroscope is a quarter of that.
* planar legs: legs of `sample_person` that swing in a plane, and a phone that leans by 5 degrees.
* circling legs: all of these legs' motion, which turns the y axis on and on, on straight paths too.

Three readings of eq. 5 (see `TieParams`): `psp` averages the magnitudes of all compensations, `psp-without-zeros` of
those alone that eq. 4 has not set to 0, `psp-signed` the compensations as they are.

HDE's increment c, of which the paper gives no value, is chosen for `hde` and each reading by itself: the one with the
least error, trajectories I and II together, of the set-up "paper" with the seeds from TRAINING_SEED on. No test with
these seeds is in the table.

Beside them stands `auto`, the default of this package: its headings and dominant directions in a factor graph, which
has the whole walk at hand and starts from the same pose, but does not know that the walk is closed.

Writes experiments/results/psp_table1.json and .txt.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from recorded import command_line, write

from pdr_est.config import Config, EstimatorParams, StartParams
from pdr_est.frames import Array
from pdr_est.front_end.heading import HeadingName, HeadingParams, heading_stage
from pdr_est.front_end.heading.hde_controller import HdeParams
from pdr_est.front_end.heading.tie_controller import TieParams
from pdr_est.pipeline import analyse_recording, smooth_recording
from pdr_est.simulate import (
    PSP_GYROSCOPE_BIAS_RADPS,
    PSP_TESTS,
    PocketPhone,
    PspTrajectory,
    Scenario,
    SimulatedWalk,
    WalkingPath,
    psp_walks,
    simulate_walk,
)
from pdr_est.stage import run_through
from pdr_est.types.steps import Step

Method = Literal["psp", "psp-without-zeros", "psp-signed", "hde", "gyro", "magnetometer", "auto"]
SetUp = Literal["paper", "small drift", "planar legs", "circling legs"]
CONTROLLERS: tuple[Method, ...] = ("psp", "psp-without-zeros", "psp-signed", "hde")
RECKONED: tuple[Method, ...] = (*CONTROLLERS, "gyro", "magnetometer")
DEFAULT: Method = "auto"  # smoothed, as it comes
METHODS: tuple[Method, ...] = (*RECKONED, DEFAULT)
SET_UPS: tuple[SetUp, ...] = ("paper", "small drift", "planar legs", "circling legs")
TRAJECTORIES: tuple[PspTrajectory, ...] = ("I", "II")
PAPER_M: dict[PspTrajectory, dict[Method, float]] = {
    "I": {"psp": 1.967, "hde": 2.134, "gyro": 20.547, "magnetometer": 19.410},
    "II": {"psp": 3.868, "hde": 19.922, "gyro": 22.112, "magnetometer": 25.796},
}
INCREMENTS_RADPS = (0.002, 0.003, 0.004, 0.005, 0.006, 0.008, 0.01, 0.014)
TRAINING_SEED = 101
GROUPS = tuple(f"{side}, {way}" for side in ("left", "right") for way in ("clockwise", "counter-clockwise"))


@dataclass(frozen=True)
class Returns:
    """Tests on one trajectory with one set-up.

    Errors, m, are (n,), by method. `group` names the pocket and the direction of each test.
    """

    trajectory: PspTrajectory
    set_up: SetUp
    length_m: float
    group: tuple[str, ...]
    error_m: dict[Method, Array]

    def mean_m(self, method: Method, group: str | None = None) -> float:
        """Compute the mean return position error, m, of all tests or of a group; NaN without any."""
        chosen = [error for error, own in zip(self.error_m[method], self.group, strict=True) if group in (None, own)]
        return float(np.mean(chosen)) if chosen else float("nan")

    def percent(self, method: Method) -> float:
        """Compute the mean in percent of the walk."""
        return 100.0 * self.mean_m(method) / self.length_m

    def median_percent(self, method: Method) -> float:
        """Compute the median in percent of the walk."""
        return 100.0 * float(np.median(self.error_m[method])) / self.length_m


def main() -> None:
    """Choose the increments, simulate, estimate, print and write the table."""
    arguments = command_line(__doc__, {"--populations": 2, "--training": 8, "--seed": 11})
    training = {
        trajectory: [
            walk for seed in range(arguments.training) for walk in walks(trajectory, "paper", _trained(seed))
        ]
        for trajectory in TRAJECTORIES
    }
    trained = training_percent(training)
    chosen = {method: min(of, key=lambda one: sum(of[one])) for method, of in trained.items()}
    seeds = range(arguments.seed, arguments.seed + arguments.populations)
    table = [measured(trajectory, set_up, seeds, chosen) for set_up in SET_UPS for trajectory in TRAJECTORIES]
    write("psp_table1", as_text(table, trained, chosen), as_document(table, trained, chosen, arguments.seed))


def _trained(number: int) -> int:
    return TRAINING_SEED + number


def walks(trajectory: PspTrajectory, set_up: SetUp, seed: int, tests: int = PSP_TESTS) -> tuple[Scenario, ...]:
    """Make the tests of one population."""
    if set_up == "planar legs":
        return psp_walks(trajectory, tests, seed, "planar")
    if set_up == "circling legs":
        return psp_walks(trajectory, tests, seed, "circling")
    share = 0.25 if set_up == "small drift" else 1.0
    return psp_walks(trajectory, tests, seed, "paper", share * PSP_GYROSCOPE_BIAS_RADPS)


def training_percent(
    training: Mapping[PspTrajectory, Sequence[Scenario]],
) -> dict[Method, dict[float, tuple[float, ...]]]:
    """Compute the mean errors by controller and increment, percent of the way, a number for each trajectory."""
    found: dict[tuple[Method, float], list[float]] = {}
    for scenarios in training.values():
        steps = [steps_of(simulate_walk(scenario)) for scenario in scenarios]
        length_m = WalkingPath(scenarios[0].path).length_m
        for method in CONTROLLERS:
            for increment in INCREMENTS_RADPS:
                errors_m = [reckoned_error_m(of, heading(method, increment)) for of in steps]
                found.setdefault((method, increment), []).append(100.0 * float(np.mean(errors_m)) / length_m)
    return {
        method: {increment: tuple(found[method, increment]) for increment in INCREMENTS_RADPS}
        for method in CONTROLLERS
    }


def measured(
    trajectory: PspTrajectory,
    set_up: SetUp,
    seeds: Sequence[int],
    increments: Mapping[Method, float],
    tests: int = PSP_TESTS,
) -> Returns:
    """Measure the return position errors of the tests of some populations, with these increments, rad/s²."""
    scenarios = [scenario for seed in seeds for scenario in walks(trajectory, set_up, seed, tests)]
    errors = [errors_m(simulate_walk(scenario), increments) for scenario in scenarios]
    return Returns(
        trajectory=trajectory,
        set_up=set_up,
        length_m=WalkingPath(scenarios[0].path).length_m,
        group=tuple(group_of(scenario) for scenario in scenarios),
        error_m={method: np.array([of[method] for of in errors]) for method in METHODS},
    )


def errors_m(walk: SimulatedWalk, increments: Mapping[Method, float]) -> dict[Method, float]:
    """Measure the return position errors by method."""
    steps = steps_of(walk)
    found = {method: reckoned_error_m(steps, heading(method, increments.get(method, 0.0))) for method in RECKONED}
    track = smooth_recording(walk.recording, settings(DEFAULT)).track
    return {**found, DEFAULT: float(np.linalg.norm(track.position_m[-1] - track.position_m[0]))}


def steps_of(walk: SimulatedWalk) -> tuple[Step, ...]:
    """Find the steps of a walk with their lengths, and with the field that the compass needs."""
    (device,) = analyse_recording(walk.recording, settings("magnetometer"))
    return device.steps


def reckoned_error_m(steps: Sequence[Step], method: HeadingParams) -> float:
    """Compute the distance from the end of the reckoned track to its start, m, whatever direction it starts in."""
    headed = run_through(heading_stage(Config().resample.rate_hz, method), steps)
    return float(abs(sum(step.length_m * np.exp(1j * step.heading_rad) for step in headed)))


def heading(method: Method, increment_radps: float = 0.01) -> HeadingParams:
    """Make the settings of a heading, with the correction in the heading of each step."""
    names: dict[Method, HeadingName] = {"hde": "hde", "gyro": "gyro", "magnetometer": "magnetometer", "auto": "auto"}
    if method == DEFAULT:
        return HeadingParams()
    readings: dict[Method, TieParams] = {
        "psp": TieParams(average="magnitude"),
        "psp-without-zeros": TieParams(average="corrections"),
        "psp-signed": TieParams(average="signed"),
    }
    return HeadingParams(
        method=names.get(method, "psp"),
        use="increments",
        hde=HdeParams(increment_radps=increment_radps if increment_radps else 0.01),
        tie=readings.get(method, TieParams()),
    )


def settings(method: Method, increment_radps: float = 0.0) -> Config:
    """Make the settings with a heading, from the known start."""
    start = StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0)
    if method == DEFAULT:
        return Config(start=start)
    reckoning = EstimatorParams(name="dead-reckoning")
    return Config(heading=heading(method, increment_radps), start=start, estimator=reckoning)


def group_of(scenario: Scenario) -> str:
    """Name the pocket and the direction of a walk."""
    carry = scenario.devices[0].carry
    side = carry.side if isinstance(carry, PocketPhone) else "no pocket"
    return f"{side}, {'counter-clockwise' if WalkingPath(scenario.path).turn_rad.sum() > 0.0 else 'clockwise'}"


def as_document(
    table: Sequence[Returns],
    trained: Mapping[Method, Mapping[float, Sequence[float]]],
    chosen: Mapping[Method, float],
    seed: int,
) -> dict[str, object]:
    """Make the document with the numbers of the text and the error of each test."""
    return {
        "seed": seed,
        "training_percent": {
            method: {f"{increment:g}": np.round(of[increment], 3).tolist() for increment in of}
            for method, of in trained.items()
        },
        "increment_radps": dict(chosen),
        "blocks": [
            {
                "trajectory": returns.trajectory,
                "set_up": returns.set_up,
                "length_m": round(returns.length_m, 3),
                "group": list(returns.group),
                "methods": {
                    method: {
                        "paper_m": PAPER_M[returns.trajectory].get(method),
                        "mean_m": round(returns.mean_m(method), 3),
                        "percent": round(returns.percent(method), 3),
                        "median_percent": round(returns.median_percent(method), 3),
                        "error_m": np.round(errors, 3).tolist(),
                    }
                    for method, errors in returns.error_m.items()
                },
            }
            for returns in table
        ],
    }


def as_text(
    table: Sequence[Returns],
    trained: Mapping[Method, Mapping[float, Sequence[float]]],
    chosen: Mapping[Method, float],
) -> str:
    """Format a block for each set-up and trajectory, with a line for each method; then the choice of increments."""
    lines = ["PSP Table I: return position error of simulated walks"]
    for returns in table:
        size = f"{returns.length_m:.1f} m, {returns.set_up}, {len(returns.group)} tests"
        lines += [
            "",
            f"Trajectory {returns.trajectory}, {size}",
            f"{'':18}{'paper':>16}{'mean':>16}{'median':>16}" + "".join(f"{group:>25}" for group in GROUPS),
            f"{'':18}" + f"{'m':>8}{'%':>8}" * 3 + f"{'m':>25}" * len(GROUPS),
        ]
        for method, errors in returns.error_m.items():
            paper_m = PAPER_M[returns.trajectory].get(method)
            paper = "" if paper_m is None else f"{paper_m:8.2f}{100.0 * paper_m / returns.length_m:8.2f}"
            lines.append(
                f"{method:18}{paper:16}{returns.mean_m(method):8.2f}{returns.percent(method):8.2f}"
                f"{float(np.median(errors)):8.2f}{returns.median_percent(method):8.2f}"
                + "".join(f"{returns.mean_m(method, group):25.2f}" for group in GROUPS)
            )
    lines += ["", "Choice of c, rad/s a s: mean error on I / II in percent, other people and walks than above", ""]
    lines.append(f"{'':18}" + "".join(f"{increment:>15g}" for increment in INCREMENTS_RADPS) + f"{'chosen':>10}")
    for method, of in trained.items():
        cells = [" / ".join(f"{one:.2f}" for one in of[increment]) for increment in of]
        lines.append(f"{method:18}" + "".join(f"{cell:>15}" for cell in cells) + f"{chosen[method]:>10g}")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
