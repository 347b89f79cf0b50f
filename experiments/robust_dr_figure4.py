"""Figures 4 to 8 of Robust DR (Jin et al., WCNC 2011) on simulated trials: tracking errors before and after fusion.

    python experiments/robust_dr_figure4.py [--seed 0] [--trials 0]

Ten trials of `robust_dr_trials`: a phone in either trousers pocket, 90 m through a laboratory. The error of a track
is the mean distance from the walker at the 22 passes of waypoints; "before" is each phone's own dead reckoning. All
start from the known pose, know height and gender, and are tied with the paper's 2R = 0.15 m. Two kinds of headings:

* compass: as published, the magnetometer, disturbed by iron. The gyroscope only tells what is level; the paper's
  phones had none. The paper integrates the horizontal acceleration for the direction in the phone's own frame; here a
  step's direction is that in which the phone points, less where it pointed at the first step.
* gyro: this package's default. Only the smoother, factor-graph, also has the directions that the whole walk tells.

The steps, their lengths and the clocks (found from the walk) are those of the defaults. Figures 5 to 8 are those of
the trials with the greatest and the median reduction by the closed form, with compass headings. The clock's error is
that of the right phone, whose clock is then taken as it is.

--trials N adds the share of N further trials, with other seeds, in which each estimator beats the closed form.

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

from pdr_est.clock_sync import ClockMethod
from pdr_est.config import Config, DevicesParams, StartParams
from pdr_est.estimators import EstimatorName
from pdr_est.estimators.common.tethers import TetherParams
from pdr_est.frames import Array
from pdr_est.front_end.heading import HeadingName, HeadingParams
from pdr_est.front_end.step_length import WalkerParams
from pdr_est.pipeline import analyse_recording, estimate_tracks
from pdr_est.simulate import Scenario, SimulatedWalk, robust_dr_trials, simulate_walk, waypoint_passes
from pdr_est.types.track import Track

Chain = Literal["compass", "gyro"]
CHAINS: dict[Chain, HeadingName] = {"compass": "magnetometer", "gyro": "auto"}
BEFORE: EstimatorName = "dead-reckoning"
FUSIONS: tuple[EstimatorName, ...] = ("map-closed-form", "map-general", "ekf", "factor-graph")
PHONES = ("left", "right")
REACH_M = 0.15  # 2 R, section V-A
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
    arguments = command_line(__doc__, {"--seed": 0, "--trials": 0})
    scenarios = robust_dr_trials(arguments.seed)
    table = measured(scenarios)
    clocks = of_clock_errors(scenarios)
    further = measured(robust_dr_trials(OTHER_SEED + arguments.seed, arguments.trials)) if arguments.trials else None
    plot(table["compass"], RESULTS / "robust_dr_figure4.png")
    text = as_text(table, clocks, further)
    write("robust_dr_figure4", text, as_document(table, clocks, further, arguments.seed))


def measured(scenarios: Sequence[Scenario]) -> dict[Chain, list[Trial]]:
    """Run the trials with both kinds of headings."""
    table: dict[Chain, list[Trial]] = {chain: [] for chain in CHAINS}
    for scenario in scenarios:
        walk = simulate_walk(scenario)
        for chain, trials in table.items():
            trials.append(fused(walk, settings(walk, chain)))
    return table


def settings(walk: SimulatedWalk, chain: Chain, clock: ClockMethod = "walk") -> Config:
    """Make all settings except for the estimator; `clock` is that of the section `devices`."""
    x_m, y_m = walk.position_at(np.zeros(1))[0].tolist()
    gait = walk.scenario.gait
    return Config(
        heading=HeadingParams(method=CHAINS[chain]),
        walker=WalkerParams(height_m=gait.height_m, gender=gait.gender),
        start=StartParams(x_m=x_m, y_m=y_m, heading_rad=float(walk.heading_at(np.zeros(1))[0])),
        devices=DevicesParams(clock=clock, tether=TetherParams(max_distance_m=REACH_M)),
    )


def fused(walk: SimulatedWalk, config: Config, estimators: Sequence[EstimatorName] = (BEFORE, *FUSIONS)) -> Trial:
    """Estimate a walk with some estimators."""
    devices = analyse_recording(walk.recording, config)
    tracks = {name: estimate_tracks(devices, config.with_estimator(name)) for name in estimators}
    return Trial(walk.scenario.name, *waypoint_passes(walk), tracks)


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
    table: dict[Chain, list[Trial]],
    clocks: dict[float, dict[EstimatorName, float]],
    further: dict[Chain, list[Trial]] | None,
    seed: int,
) -> dict[str, object]:
    """Make the document with the numbers of the text; errors are of the left and of the right phone."""
    return {
        "seed": seed,
        "reach_m": REACH_M,
        "headings": {
            chain: {
                "trials": [
                    {name: np.round(trial.mean_m(name), 3).tolist() for name in trial.tracks} for trial in trials
                ],
                "fusions": {name: summary(trials, name) for name in FUSIONS},
            }
            for chain, trials in table.items()
        },
        "mean_m_by_clock_error_s": {
            f"{error_s:g}": {name: round(value, 3) for name, value in of.items()} for error_s, of in clocks.items()
        },
        "further_trials": {
            chain: {name: summary(trials, name) for name in FUSIONS} for chain, trials in further.items()
        }
        if further is not None
        else None,
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


def as_text(
    table: dict[Chain, list[Trial]],
    clocks: dict[float, dict[EstimatorName, float]],
    further: dict[Chain, list[Trial]] | None,
) -> str:
    """Format a block for each kind of headings, with the errors of both phones in each trial; then the clocks."""
    lines = ["Robust DR figure 4: mean error at 22 passes of waypoints, m, left / right phone; simulated trials"]
    for chain, trials in table.items():
        lines += ["", f"{chain} headings", f"{'trial':8}" + "".join(f"{name:>18}" for name in (BEFORE, *FUSIONS))]
        for number, trial in enumerate(trials, 1):
            cells = ["{:.2f} / {:.2f}".format(*trial.mean_m(name)) for name in (BEFORE, *FUSIONS)]
            lines.append(f"{number:<8}" + "".join(f"{cell:>18}" for cell in cells))
        lines += ["", "change of the error by fusion, percent, left / right phone"]
        for number, trial in enumerate(trials, 1):
            changes = [trial.reductions(name) for name in FUSIONS]
            cells = [f"{-left:+.0f} / {-right:+.0f}" for left, right in changes]
            lines.append(f"{number:<8}{'':18}" + "".join(f"{cell:>18}" for cell in cells))
        lines += ["", *_summaries(trials)]
    lines += [
        "",
        f"Mean error after fusion, m, by the error of the right phone's clock, {len(table['gyro'])} trials, gyro",
    ]
    lines.append(f"{'s':8}" + "".join(f"{name:>18}" for name in FUSIONS))
    lines += [f"{error_s:<8g}" + "".join(f"{of[name]:18.2f}" for name in FUSIONS) for error_s, of in clocks.items()]
    for chain, trials in (further or {}).items():
        lines += ["", f"{len(trials)} further trials, {chain} headings", *_summaries(trials)]
    return "\n".join(lines) + "\n"


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
