"""Table I of PSP (Hong et al. 2013) on simulated walks: distance of the end of a closed walk from its start.

    python experiments/psp_table1.py [--tests 25] [--seed 0]

Five simulated people carry a phone nearly straight in the left or right front pocket, either way round trajectory I
(204.0 m, straight legs) and II (290.0 m, with a circle walked five times): 25 tests on each (`psp_walks`). Steps and
their lengths are those of the defaults; headings are those of each method, its compensation in the headings; the walk
is dead reckoning from the known start. The gyroscope's bias is not learned at rest, as the paper does not: the
attitude filter would take the swaying of one who stands for it. The return position error is the distance from the
end of the track to its start, where the walker is again; its mean stands beside the paper's, in m and percent.

Twice: with legs as `sample_person` draws them, which circle and twist as much as those of real recordings do
(results/simulated_and_real.txt), and with legs that swing in their plane only. A leg that circles turns the y axis
on and on, on straight paths too, and by degrees a second; PSP's reasoning knows nothing of that, and its phones, by
its own line for the gyroscope on trajectory I, hardly did it.

Beside them stands `auto`, the default of this package: its headings and dominant directions in a factor graph, which
has the whole walk at hand and starts from the same pose, but does not know that the walk is closed.

HDE's increment c, of which the paper gives no value, is the only freedom: the table has INCREMENT_RADPS, the same for
all, and below it what others give.

Writes experiments/results/psp_table1.json and .txt.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from recorded import command_line, write

from pdr_est.config import Config, EstimatorParams, StartParams
from pdr_est.frames import Array
from pdr_est.front_end.heading import HeadingName, HeadingParams
from pdr_est.front_end.heading.hde_controller import HdeParams
from pdr_est.pipeline import smooth_recording
from pdr_est.simulate import (
    PSP_TESTS,
    PocketPhone,
    PspTrajectory,
    Scenario,
    SimulatedWalk,
    WalkingPath,
    psp_walks,
    simulate_walk,
)

METHODS: tuple[HeadingName, ...] = ("psp", "hde", "gyro", "magnetometer")
DEFAULT: HeadingName = "auto"  # smoothed, as it comes
TRAJECTORIES: tuple[PspTrajectory, ...] = ("I", "II")
PAPER_M: dict[PspTrajectory, dict[HeadingName, float]] = {
    "I": {"psp": 1.967, "hde": 2.134, "gyro": 20.547, "magnetometer": 19.410},
    "II": {"psp": 3.868, "hde": 19.922, "gyro": 22.112, "magnetometer": 25.796},
}
LEGS = ("real legs", "planar legs")
INCREMENT_RADPS = 0.007
OTHER_INCREMENTS_RADPS = (0.002, 0.014, 0.03)
CONTROLLERS: tuple[HeadingName, ...] = ("psp", "hde")
GROUPS = tuple(f"{side}, {way}" for side in ("left", "right") for way in ("clockwise", "counter-clockwise"))


@dataclass(frozen=True)
class Returns:
    """Tests on one trajectory with one kind of legs.

    Errors, m, are (n,): `error_m` by method, `others_m` by controller and increment. `group` names the pocket and the
    direction of each test.
    """

    trajectory: PspTrajectory
    legs: str
    length_m: float
    group: tuple[str, ...]
    error_m: dict[HeadingName, Array]
    others_m: dict[tuple[HeadingName, float], Array]

    def mean_m(self, method: HeadingName, group: str | None = None) -> float:
        """Compute the mean return position error, m, of all tests or of a group; NaN without any."""
        chosen = [error for error, own in zip(self.error_m[method], self.group, strict=True) if group in (None, own)]
        return float(np.mean(chosen)) if chosen else float("nan")

    def percent(self, method: HeadingName) -> float:
        """Compute the mean in percent of the walk."""
        return 100.0 * self.mean_m(method) / self.length_m


def main() -> None:
    """Simulate, estimate, print and write the table."""
    arguments = command_line(__doc__, {"--tests": PSP_TESTS, "--seed": 0})
    table = [
        measured(trajectory, legs, arguments.tests, arguments.seed, OTHER_INCREMENTS_RADPS)
        for legs in LEGS
        for trajectory in TRAJECTORIES
    ]
    write("psp_table1", as_text(table), as_document(table, arguments.seed))


def measured(
    trajectory: PspTrajectory, legs: str, tests: int, seed: int, increments: Sequence[float] = ()
) -> Returns:
    """Measure the return position errors of tests, also with other increments of the controllers, rad/s²."""
    scenarios = [with_legs(scenario, legs) for scenario in psp_walks(trajectory, tests, seed)]
    errors = [errors_m(simulate_walk(scenario), increments) for scenario in scenarios]
    return Returns(
        trajectory=trajectory,
        legs=legs,
        length_m=WalkingPath(scenarios[0].path).length_m,
        group=tuple(group_of(scenario) for scenario in scenarios),
        error_m={method: np.array([of[method, INCREMENT_RADPS] for of in errors]) for method in (*METHODS, DEFAULT)},
        others_m={key: np.array([of[key] for of in errors]) for key in errors[0] if key[1] != INCREMENT_RADPS},
    )


def with_legs(scenario: Scenario, legs: str) -> Scenario:
    """Return the same walk with one kind of legs."""
    device = scenario.devices[0]
    if legs == "real legs" or not isinstance(device.carry, PocketPhone):
        return scenario
    planar = replace(device.carry, twist_rad=0.0, spread_rad=0.0)
    return replace(scenario, devices=(replace(device, carry=planar),))


def errors_m(walk: SimulatedWalk, increments: Sequence[float]) -> dict[tuple[HeadingName, float], float]:
    """Measure the return position errors by method and increment."""
    asked = [(method, INCREMENT_RADPS) for method in (*METHODS, DEFAULT)]
    asked += [(method, increment) for method in CONTROLLERS for increment in increments]
    return {key: return_error_m(walk, *key) for key in asked}


def return_error_m(walk: SimulatedWalk, method: HeadingName, increment_radps: float) -> float:
    """Compute the distance from the end of the track to its start, m."""
    track = smooth_recording(walk.recording, settings(method, increment_radps)).track
    return float(np.linalg.norm(track.position_m[-1] - track.position_m[0]))


def settings(method: HeadingName, increment_radps: float = INCREMENT_RADPS) -> Config:
    """Make the settings with a heading, from the known start."""
    start = StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0)
    if method == DEFAULT:
        return Config(start=start)
    return Config(
        heading=HeadingParams(method=method, use="increments", hde=HdeParams(increment_radps=increment_radps)),
        start=start,
        estimator=EstimatorParams(name="dead-reckoning"),
    )


def group_of(scenario: Scenario) -> str:
    """Name the pocket and the direction of a walk."""
    carry = scenario.devices[0].carry
    side = carry.side if isinstance(carry, PocketPhone) else "no pocket"
    return f"{side}, {'counter-clockwise' if WalkingPath(scenario.path).turn_rad.sum() > 0.0 else 'clockwise'}"


def as_document(table: Sequence[Returns], seed: int) -> dict[str, object]:
    """Make the document with the numbers of the text and the error of each test."""
    return {
        "seed": seed,
        "increment_radps": INCREMENT_RADPS,
        "blocks": [
            {
                "trajectory": returns.trajectory,
                "legs": returns.legs,
                "length_m": round(returns.length_m, 3),
                "group": list(returns.group),
                "methods": {
                    method: {
                        "paper_m": PAPER_M[returns.trajectory].get(method),
                        "mean_m": round(returns.mean_m(method), 3),
                        "percent": round(returns.percent(method), 3),
                        "error_m": np.round(errors, 3).tolist(),
                    }
                    for method, errors in returns.error_m.items()
                },
                "mean_m_with_other_increments": {
                    f"{method} {increment:g}": round(float(errors.mean()), 3)
                    for (method, increment), errors in returns.others_m.items()
                },
            }
            for returns in table
        ],
    }


def as_text(table: Sequence[Returns]) -> str:
    """Format a block for each trajectory and kind of legs, with a line for each method."""
    lines = [
        f"PSP Table I: average return position error of simulated walks, increment {INCREMENT_RADPS:g} rad/s a s"
    ]
    for returns in table:
        lines += [
            "",
            f"Trajectory {returns.trajectory}, {returns.length_m:.1f} m, {returns.legs}, {len(returns.group)} tests",
            f"{'':14}{'paper':>16}{'mean':>16}{'median':>8}" + "".join(f"{group:>25}" for group in GROUPS),
            f"{'':14}{'m':>8}{'%':>8}{'m':>8}{'%':>8}{'m':>8}" + f"{'m':>25}" * len(GROUPS),
        ]
        for method, errors in returns.error_m.items():
            paper_m = PAPER_M[returns.trajectory].get(method)
            paper = "" if paper_m is None else f"{paper_m:8.2f}{100.0 * paper_m / returns.length_m:8.2f}"
            lines.append(
                f"{method:14}{paper:16}"
                f"{returns.mean_m(method):8.2f}{returns.percent(method):8.2f}{float(np.median(errors)):8.2f}"
                + "".join(f"{returns.mean_m(method, group):25.2f}" for group in GROUPS)
            )
        for (method, increment), errors in returns.others_m.items():
            percent = 100.0 * errors.mean() / returns.length_m
            lines.append(
                f"{f'{method} {increment:g}':14}{'':16}{errors.mean():8.2f}{percent:8.2f}{np.median(errors):8.2f}"
            )
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
