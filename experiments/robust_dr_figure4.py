"""Figures 4 to 8 of Robust DR (Jin et al., WCNC 2011) on simulated trials: tracking errors before and after fusion.

    python experiments/robust_dr_figure4.py [--seed 0] [--trials 100]

Ten trials of `robust_dr_trials`: a phone in either trousers pocket, 90 m through a laboratory. The error of a track
is the mean distance from the walker at the 22 passes of waypoints; "before" is each phone's own dead reckoning. All
start from the known pose, know height and gender, and are tied with the paper's 2R = 0.15 m. Four chains:

* published: section III throughout. The attitude is that of a phone without gyroscope, by accelerometer and
  magnetometer; steps by relative thresholds; lengths by eq. 3, its K calibrated on another walk of the person, 30 m
  straight on; headings by integrating the horizontal acceleration over 1.4 s, against north.
* published, pointing: the same but for the headings: those of the compass.
* pointing: steps and lengths of this package, and the headings of the compass. The gyroscope only tells what is
  level. A step's direction is that in which the phone points, less where it pointed at the first step.
* gyro: this package's default. Only the smoother, factor-graph, also has the directions that the whole walk tells.

The chains with a compass run a second time on trials whose compasses are disturbed in opposite senses, as the paper's
phones seem to have been; `robust_dr_trials` says how these errors are drawn.

The clocks are given: the paper's phones exchanged messages for them. Figures 5 to 8 are those of the trials with the
greatest and the median reduction by the closed form, with the chain "pointing". The clock's error is that of the
right phone, whose clock is then taken as it is.

--trials N adds N further trials with other seeds.

Writes experiments/results/robust_dr_figure4.json, .txt and .png.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from recorded import RESULTS, command_line, write

from pdr_est.clock_sync import ClockMethod, GivenClock
from pdr_est.config import Config, DevicesParams, StartParams
from pdr_est.estimators import EstimatorName
from pdr_est.estimators.common.tethers import TetherParams
from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.attitude import AttitudeParams
from pdr_est.front_end.heading import HeadingName, HeadingParams
from pdr_est.front_end.mode import ModeParams
from pdr_est.front_end.step_length import StepLengthParams, WalkerParams
from pdr_est.front_end.steps import StepsParams
from pdr_est.pipeline import analyse_recording, estimate_tracks
from pdr_est.simulate import (
    PathParams,
    Scenario,
    SimulatedWalk,
    robust_dr_trials,
    simulate_walk,
    waypoint_passes,
    with_compass_orientation,
)
from pdr_est.types.analysis import DeviceWalk
from pdr_est.types.measurements import StepOdometry
from pdr_est.types.track import Track

Chain = Literal["published", "published, pointing", "pointing", "gyro"]
CHAINS: dict[Chain, HeadingName] = {
    "published": "acceleration-integration",
    "published, pointing": "magnetometer",
    "pointing": "magnetometer",
    "gyro": "auto",
}
PUBLISHED: tuple[Chain, ...] = ("published", "published, pointing")
WITH_COMPASS: tuple[Chain, ...] = (*PUBLISHED, "pointing")
BEFORE: EstimatorName = "dead-reckoning"
FUSIONS: tuple[EstimatorName, ...] = ("map-closed-form", "map-general", "ekf", "factor-graph")
PHONES = ("left", "right")
REACH_M = 0.15  # 2 R, section V-A
CALIBRATION_M = 30.0  # of the walk that shows K
CLOCK_ERRORS_S = (0.0, 0.1, 0.5, 1.0, 2.0)
OTHER_SEED = 1000  # of the further trials
PAPER_BEST_PERCENT = 73.7  # reduction in its trial 6


@dataclass(frozen=True)
class Trial:
    """One trial with one kind of headings: times (22,) and true positions (22, 2) of the passes, and the tracks."""

    name: str
    time_s: Array
    true_m: Array
    tracks: dict[EstimatorName, Track]

    def errors_m(self, estimator: EstimatorName, phone: str) -> Array:
        """Compute the distances (22,) from the walker at the passes, m."""
        place_m, _ = self.tracks[estimator].of_device(phone).at(self.time_s)
        apart: Array = np.linalg.norm(place_m - self.true_m, axis=1)
        return apart

    def mean_m(self, estimator: EstimatorName) -> tuple[float, float]:
        """Compute the mean error of each phone, m."""
        left, right = (float(self.errors_m(estimator, phone).mean()) for phone in PHONES)
        return left, right

    def reductions(self, estimator: EstimatorName) -> tuple[float, float]:
        """Compute by how many percent fusion reduces the error of each phone; negative where it increases it."""
        pairs = zip(self.mean_m(BEFORE), self.mean_m(estimator), strict=True)
        left, right = (100.0 * (1.0 - after / before) for before, after in pairs)
        return left, right

    def both_better(self, estimator: EstimatorName) -> bool:
        """Check the first scenario of the paper, that both phones are better than before; in the second it is one."""
        return min(self.reductions(estimator)) > 0.0

    def beats(self, estimator: EstimatorName, other: EstimatorName = "map-closed-form") -> bool:
        """Check if the mean error of both phones is smaller."""
        return sum(self.mean_m(estimator)) < sum(self.mean_m(other))


def main() -> None:
    """Simulate, fuse, print and write everything."""
    arguments = command_line(__doc__, {"--seed": 0, "--trials": 100})
    seed, further = arguments.seed, arguments.trials
    scenarios = robust_dr_trials(seed)
    plain = measured(scenarios)
    tables: dict[str, dict[Chain, list[Trial]]] = {
        "trials": plain,
        "opposed compasses": measured(robust_dr_trials(seed, opposed_compasses=True), WITH_COMPASS),
    }
    if further:
        tables["further trials"] = measured(robust_dr_trials(OTHER_SEED + seed, further))
        tables["further, opposed compasses"] = measured(
            robust_dr_trials(OTHER_SEED + seed, further, opposed_compasses=True), WITH_COMPASS
        )
    clocks = of_clock_errors(scenarios)
    plot(plain["pointing"], RESULTS / "robust_dr_figure4.png")
    write("robust_dr_figure4", as_text(tables, clocks), as_document(tables, clocks, seed))


def measured(scenarios: Sequence[Scenario], chains: Sequence[Chain] = tuple(CHAINS)) -> dict[Chain, list[Trial]]:
    """Run the trials with some chains."""
    table: dict[Chain, list[Trial]] = {chain: [] for chain in chains}
    for scenario in scenarios:
        walk = simulate_walk(scenario)
        for chain, trials in table.items():
            trials.append(fused(walk, settings(walk, chain)))
    return table


def settings(walk: SimulatedWalk, chain: Chain, clock: ClockMethod = "given") -> Config:
    """Make all settings except for the estimator; `clock` is that of the section `devices`."""
    x_m, y_m = walk.position_at(np.zeros(1))[0].tolist()
    gait = walk.scenario.gait
    clocks = (
        GivenClock(
            device=device.name,
            offset_s=device.sensors.clock_offset_s,
            skew_ppm=1e6 * device.sensors.clock_skew,
        )
        for device in walk.scenario.devices
    )
    common = Config(
        heading=HeadingParams(method=CHAINS[chain]),
        walker=WalkerParams(height_m=gait.height_m, gender=gait.gender),
        start=StartParams(x_m=x_m, y_m=y_m, heading_rad=float(walk.heading_at(np.zeros(1))[0])),
        devices=DevicesParams(
            clock=clock,
            clocks=tuple(clocks) if clock == "given" else (),
            tether=TetherParams(max_distance_m=REACH_M),
        ),
    )
    if chain not in PUBLISHED:
        return common
    published = replace(
        common,
        attitude=AttitudeParams(source="device"),
        mode=ModeParams(method="fixed", fixed="POCKET"),
        steps=StepsParams(detector="relative-threshold"),
        step_length=StepLengthParams(model="weinberg"),
    )
    scale = calibrated_scale(walk.scenario, published)
    return replace(published, walker=replace(published.walker, length_scale=scale))


def calibrated_scale(scenario: Scenario, config: Config) -> float:
    """Compute the factor of K that makes a straight walk of the same person as long as it is, mean of both phones."""
    straight = replace(scenario, path=PathParams(vertices_m=((0.0, 0.0), (CALIBRATION_M, 0.0))), irons=())
    walk = simulate_walk(replace(straight, seed=scenario.seed + 1))
    devices = analyse_recording(with_compass_orientation(walk.recording), config)
    return float(np.mean([CALIBRATION_M / sum(step.length_m for step in device.steps) for device in devices]))


def fused(walk: SimulatedWalk, config: Config, estimators: Sequence[EstimatorName] = (BEFORE, *FUSIONS)) -> Trial:
    """Estimate a walk with some estimators."""
    if config.attitude.source == "device":
        devices = analyse_recording(with_compass_orientation(walk.recording), config)
        devices = tuple(against_north(device, walk, config) for device in devices)
    else:
        devices = analyse_recording(walk.recording, config)
    tracks = {name: estimate_tracks(devices, config.with_estimator(name)) for name in estimators}
    return Trial(walk.scenario.name, *waypoint_passes(walk), tracks)


def against_north(device: DeviceWalk, walk: SimulatedWalk, config: Config) -> DeviceWalk:
    """Let integrated headings count from north, as published; those of a pointing phone count from the start."""
    first, *others = device.odometry
    start_rad = config.start.heading_rad
    if (
        config.heading.method != "acceleration-integration"
        or not isinstance(first, StepOdometry)
        or start_rad is None
    ):
        return device
    heading_rad = device.steps[0].heading_rad - walk.scenario.earth.declination_rad
    turned = replace(first, heading_change_rad=float(wrap_angle(heading_rad - start_rad)))
    return replace(device, odometry=(turned, *others), whole_walk_odometry=(turned, *others))


def of_clock_errors(
    scenarios: Sequence[Scenario], errors_s: Sequence[float] = CLOCK_ERRORS_S
) -> dict[float, dict[EstimatorName, float]]:
    """Compute the mean error after fusion, m, for errors of the right phone's clock, with gyroscope headings."""
    found = {}
    for error_s in errors_s:
        trials = []
        for scenario in scenarios:
            left, right = scenario.devices
            off = replace(right, sensors=replace(right.sensors, clock_offset_s=error_s, clock_skew=0.0))
            walk = simulate_walk(replace(scenario, devices=(left, off)))
            trials.append(fused(walk, settings(walk, "gyro", clock="none"), FUSIONS))
        found[error_s] = {name: float(np.mean([trial.mean_m(name) for trial in trials])) for name in FUSIONS}
    return found


def as_document(
    tables: dict[str, dict[Chain, list[Trial]]], clocks: dict[float, dict[EstimatorName, float]], seed: int
) -> dict[str, object]:
    """Make the document with the numbers of the text; errors are of the left and of the right phone."""
    return {
        "seed": seed,
        "reach_m": REACH_M,
        "sets": {
            words: {
                chain: {
                    "trials": [
                        {name: np.round(trial.mean_m(name), 3).tolist() for name in trial.tracks} for trial in trials
                    ],
                    "fusions": {name: summary(trials, name) for name in FUSIONS},
                }
                for chain, trials in table.items()
            }
            for words, table in tables.items()
        },
        "mean_m_by_clock_error_s": {
            f"{error_s:g}": {name: round(value, 3) for name, value in of.items()} for error_s, of in clocks.items()
        },
    }


def summary(trials: Sequence[Trial], name: EstimatorName) -> dict[str, float]:
    """Summarise trials: mean errors, m, mean and greatest reduction, percent, and counts of trials."""
    reductions = np.array([trial.reductions(name) for trial in trials])
    before_m = np.mean([trial.mean_m(BEFORE) for trial in trials])
    after_m = np.mean([trial.mean_m(name) for trial in trials])
    return {
        "trials": len(trials),
        "before_m": round(float(before_m), 3),
        "after_m": round(float(after_m), 3),
        "reduction_of_means": round(100.0 * float(1.0 - after_m / before_m), 1),
        "mean_reduction": round(float(reductions.mean()), 1),
        "greatest_reduction": round(float(reductions.max()), 1),
        "both_better": sum(trial.both_better(name) for trial in trials),
        "beats_closed_form": sum(trial.beats(name) for trial in trials),
    }


def as_text(tables: dict[str, dict[Chain, list[Trial]]], clocks: dict[float, dict[EstimatorName, float]]) -> str:
    """Format a block for each set of trials and chain; of small sets the errors of both phones in each trial, too."""
    lines = ["Robust DR figure 4: mean error at 22 passes of waypoints, m, left / right phone; simulated trials"]
    for words, table in tables.items():
        for chain, trials in table.items():
            lines += ["", f"{len(trials)} {words}, chain {chain}"]
            lines += _each(trials) if len(trials) <= _SHOWN_TRIALS else []
            lines += _summaries(trials)
    lines += ["", "Mean error after fusion, m, by the error of the right phone's clock, chain gyro"]
    lines.append(f"{'s':8}" + "".join(f"{name:>18}" for name in FUSIONS))
    lines += [f"{error_s:<8g}" + "".join(f"{of[name]:18.2f}" for name in FUSIONS) for error_s, of in clocks.items()]
    return "\n".join(lines) + "\n"


_SHOWN_TRIALS = 10


def _each(trials: Sequence[Trial]) -> list[str]:
    lines = [f"{'trial':8}" + "".join(f"{name:>18}" for name in (BEFORE, *FUSIONS))]
    for number, trial in enumerate(trials, 1):
        cells = ["{:.2f} / {:.2f}".format(*trial.mean_m(name)) for name in (BEFORE, *FUSIONS)]
        lines.append(f"{number:<8}" + "".join(f"{cell:>18}" for cell in cells))
    lines += ["", "change of the error by fusion, percent, left / right phone"]
    for number, trial in enumerate(trials, 1):
        changes = [trial.reductions(name) for name in FUSIONS]
        cells = [f"{-left:+.0f} / {-right:+.0f}" for left, right in changes]
        lines.append(f"{number:<8}{'':18}" + "".join(f"{cell:>18}" for cell in cells))
    return [*lines, ""]


def _summaries(trials: Sequence[Trial]) -> list[str]:
    rows = {name: summary(trials, name) for name in FUSIONS}
    words = {
        "before_m": "mean error before, m",
        "after_m": "mean error after, m",
        "reduction_of_means": "reduction of that, percent",
        "mean_reduction": "mean reduction of a phone, percent",
        "greatest_reduction": f"greatest one (paper {PAPER_BEST_PERCENT})",
        "both_better": "trials in which both are better",
        "beats_closed_form": "trials better than closed form",
    }
    head = f"{'':36}" + "".join(f"{name:>18}" for name in FUSIONS)
    return [head, *(f"{text:36}" + "".join(f"{rows[n][key]:18g}" for n in FUSIONS) for key, text in words.items())]


def best_and_middle(trials: Sequence[Trial]) -> tuple[int, int]:
    """Return the numbers of the trials with the greatest and the median reduction by the closed form."""
    order = np.argsort([np.mean(trial.reductions("map-closed-form")) for trial in trials])
    return int(order[-1]), int(order[len(order) // 2])


def plot(trials: Sequence[Trial], path: Path) -> None:
    """Draw figures 5 to 8: for each trial its errors over time and the tracks of both phones before and after."""
    figure = Figure(figsize=(15.0, 9.0), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, 3)
    for row, number in zip(axes, best_and_middle(trials), strict=True):
        trial = trials[number]
        for phone, colour in zip(PHONES, ("tab:blue", "tab:red"), strict=True):
            for name, style in ((BEFORE, ":"), ("map-closed-form", "--"), ("factor-graph", "-")):
                errors_m = trial.errors_m(name, phone)
                row[0].plot(trial.time_s, errors_m, style, color=colour, label=f"{phone}, {name}")
        row[0].set(title=f"trial {number + 1}", xlabel="time, s", ylabel="error at the waypoints, m")
        row[0].legend(fontsize=7)
        for axis, phone in zip(row[1:], PHONES, strict=True):
            axis.plot(*trial.true_m.T, "o", color="0.6", label="waypoints")
            for name, style in ((BEFORE, ":"), ("map-closed-form", "--"), ("factor-graph", "-")):
                axis.plot(*trial.tracks[name].of_device(phone).position_m.T, style, label=name)
            axis.set(title=f"trial {number + 1}, {phone} phone", xlabel="east, m", ylabel="north, m", aspect="equal")
            axis.legend(fontsize=7)
    figure.savefig(path, dpi=80)


if __name__ == "__main__":
    main()
