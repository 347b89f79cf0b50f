"""Distance error along a trip, fixed against variable step length: figure 7 of UPTIME (Alzantot and Youssef 2012).

    python experiments/uptime_figure7.py --data DIR

The first trip is that of the paper, simulated: 470 m in different gaits with the phone in the hand, with stops
(`uptime_trip`). The others are joined from walks of different speeds: one of a simulated person, the walks of the
public set known-distance, and those of stride-length. Nobody runs in these, because no public set with running tells
the distance. The steps are the same for every length model. The true distance is known in the simulation at every
second, in known-distance at the end of each walk, and in stride-length at the end of each measured stride; there,
only the strides that the benchmark scores are part of the trip.

`static` is the fixed length (a share of the height), `gait-table` UPTIME's length for each gait, `auto` ours. Each is
shown as it is, and scaled so that the trip's first walk (up to the first stop) is right, which takes the person's
usual length out.

Writes experiments/results/uptime_figure7.png, .json and .txt, and the table of experiments/paper-details.md.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray
from recorded import RESULTS, command_line, markdown_table, write, write_table

from pdr_est.config import Config
from pdr_est.evaluate.stride_lengths import lengths_by_time, scored_strides, step_shares
from pdr_est.experiment.recording_files import recordings
from pdr_est.front_end.step_length import LengthModel, StepLength, StepLengthParams, WalkerParams
from pdr_est.io import read
from pdr_est.io.side_tables.known_distances import read_known_distances
from pdr_est.pipeline import analyse_recording
from pdr_est.simulate import (
    DeviceParams,
    PathParams,
    Scenario,
    SimulatedWalk,
    sample_person,
    simulate_walk,
    uptime_trip,
)
from pdr_est.types.ground_truth import TrueStrides
from pdr_est.types.recording import Recording

Array = NDArray[np.float64]

MARK = "<!-- uptime figure 7 -->"
MODELS: tuple[LengthModel, ...] = ("static", "gait-table", "auto")
COLOURS = {"static": "#b3462b", "gait-table": "#c9962f", "auto": "#1f6f8b"}
PACES = (1.0, 0.7, 1.22, 0.85, 1.1)  # of the usual cadence, in the order of the simulated trip
WALK_M = 94.0  # times five makes the paper's 470 m


@dataclass(frozen=True)
class Walk:
    """True distances (n,) between places, m, and those of each model."""

    true_m: Array
    model_m: Mapping[LengthModel, Array]


@dataclass(frozen=True)
class Errors:
    """Errors (n,) of the distance of a model, m, along the true distance so far (n,), m."""

    along_m: Array
    error_m: Array

    def numbers(self) -> dict[str, float]:
        """Compute distance, error at the end, mean and largest absolute error, rounded."""
        size = np.abs(self.error_m)
        found = {
            "distance_m": self.along_m[-1],
            "final_m": self.error_m[-1],
            "final_percent": 100.0 * self.error_m[-1] / self.along_m[-1],
            "mean_m": size.mean(),
            "largest_m": size.max(),
        }
        return {name: round(float(value), 2) for name, value in found.items()}


def main() -> None:
    """Measure, print, draw and write."""
    options = command_line(__doc__, {"--data": Path, "--seed": 0})
    trips = {
        "gaits": gaits_trip(options.seed),
        "simulated": simulated_trip(options.seed),
        "known-distance": known_distance_trip(options.data / "known-distance"),
        "stride-length": stride_length_trip(options.data / "stride-length"),
    }
    draw(trips, RESULTS / "uptime_figure7.png")
    write("uptime_figure7", as_text(trips), as_document(trips))
    write_table(MARK, as_markdown(as_document(trips)))


def gaits_trip(seed: int) -> list[Walk]:
    """Simulate the trip of the paper, in different gaits, as one recording that is cut at its stops."""
    walk = simulate_walk(uptime_trip("gaits", seed))
    whole = measured_by_second(walk)
    stop_m = [pause.at_m for pause in walk.scenario.gait.pauses]
    at = np.searchsorted(np.cumsum(whole.true_m), stop_m)
    parts = {name: np.split(lengths, at) for name, lengths in whole.model_m.items()}
    return [
        Walk(true_m, {name: parts[name][number] for name in MODELS})
        for number, true_m in enumerate(np.split(whole.true_m, at))
    ]


def simulated_trip(seed: int, paces: Sequence[float] = PACES) -> list[Walk]:
    """Simulate the walks of one person along a straight path, each at another pace."""
    rng = np.random.default_rng([seed, 7])
    person = sample_person(rng)
    walks = []
    for pace in paces:
        scenario = Scenario(
            path=PathParams(vertices_m=((0.0, 0.0), (WALK_M, 0.0))),
            gait=replace(person.gait, cadence_hz=pace * person.gait.cadence_hz),
            body=person.body,
            devices=(DeviceParams(carry=person.held),),
            seed=int(rng.integers(2**31)),
        )
        walks.append(measured_by_second(simulate_walk(scenario)))
    return walks


def measured_by_second(walk: SimulatedWalk) -> Walk:
    """Compute the distances of each second of a simulated walk."""
    time_s = np.append(np.arange(walk.truth_time_s[0], walk.truth_time_s[-1], 1.0), walk.truth_time_s[-1])
    true_m = np.linalg.norm(np.diff(walk.position_at(time_s), axis=0), axis=1)
    gait = walk.scenario.gait
    body = WalkerParams(height_m=gait.height_m, gender=gait.gender)
    return measured(walk.recording, TrueStrides(time_s[:-1], time_s[1:], true_m), body)


def known_distance_trip(folder: Path) -> list[Walk]:
    """Measure the walks of the set, each from its beginning to its end."""
    known = read_known_distances(next(folder.glob("truth.csv*")))
    always = np.array([-np.inf]), np.array([np.inf])
    return [
        measured(read(path), TrueStrides(*always, np.array([known[name].distance_m])))
        for name, path in recordings(folder, "*.csv")
        if name in known
    ]


def stride_length_trip(folder: Path) -> list[Walk]:
    """Measure the scored strides of every walk of the set, in order of name."""
    walks = []
    for _, path in recordings(folder, "PDR_Raw_*.txt"):
        recording = read(path)
        if recording.truth.strides is not None:
            walks.append(measured(recording, scored_strides(recording.truth.strides)))
    return walks


def measured(recording: Recording, truth: TrueStrides, walker: WalkerParams | None = None) -> Walk:
    """Compute the distances of each model beside those of known length in a walk."""
    config = Config()
    (device,) = analyse_recording(recording, config)
    start_s = np.array([step.start_s for step in device.steps])
    end_s = np.array([step.event.time_s for step in device.steps])
    share = step_shares(start_s, end_s, truth)
    model_m = {}
    for model in MODELS:
        stage = StepLength(config.resample.rate_hz, walker or WalkerParams(), StepLengthParams(model=model))
        lengths_m = np.array([found.length_m for step in device.steps for found in stage.push(step)])
        model_m[model] = lengths_by_time(share, lengths_m)
    return Walk(truth.length_m, model_m)


def errors(trip: Sequence[Walk], model: LengthModel, scaled: bool) -> Errors:
    """Compute the errors along the trip by a model, as it is or scaled to the length of the first walk."""
    first = trip[0]
    scale = float(first.true_m.sum() / first.model_m[model].sum()) if scaled else 1.0
    along_m = np.cumsum(np.concatenate([walk.true_m for walk in trip]))
    return Errors(along_m, scale * np.cumsum(np.concatenate([walk.model_m[model] for walk in trip])) - along_m)


def as_document(trips: Mapping[str, Sequence[Walk]]) -> dict[str, dict[str, dict[str, dict[str, float]]]]:
    """Make the document: trip, then "as_it_is" or "scaled", then model."""
    return {
        name: {
            way: {model: errors(trip, model, scaled).numbers() for model in MODELS}
            for way, scaled in (("as_it_is", False), ("scaled", True))
        }
        for name, trip in trips.items()
    }


def as_text(trips: Mapping[str, Sequence[Walk]]) -> str:
    """Format a line for each trip, scaling and model."""
    lines = [
        "Error of the distance walked so far, fixed and variable step length (UPTIME, figure 7)",
        "scaled: so that the first walk of the trip is right",
        "",
        f"{'trip':16}{'way':10}{'model':12}{'m':>8}{'at the end m':>14}{'%':>8}{'mean m':>9}{'largest m':>11}",
    ]
    for name, ways in as_document(trips).items():
        for way, models in ways.items():
            for model, found in models.items():
                lines.append(
                    f"{name:16}{way.replace('_', ' '):10}{model:12}{found['distance_m']:8.1f}"
                    f"{found['final_m']:+14.2f}{found['final_percent']:+8.1f}{found['mean_m']:9.2f}"
                    f"{found['largest_m']:11.2f}"
                )
    return "\n".join(lines) + "\n"


def as_markdown(document: Mapping[str, Mapping[str, Mapping[str, Mapping[str, float]]]]) -> str:
    """Make the table of the README: error at the end of each trip, and mean error along it."""
    rows = []
    for name, ways in document.items():
        cells = [
            f"{number['final_percent']:+.1f} ({number['mean_m']:.1f})"
            for way in ways.values()
            for number in way.values()
        ]
        rows.append((name, f"{ways['scaled']['auto']['distance_m']:.0f}", *cells))
    heads = [f"{way}`{model}`" for way in ("", "scaled: ") for model in MODELS]
    return markdown_table(("trip", "m", *heads), rows)


def draw(trips: Mapping[str, Sequence[Walk]], path: Path) -> None:
    """Draw a row for each trip; left as it is, right scaled to the first walk."""
    figure, axes = plt.subplots(len(trips), 2, figsize=(10, 3 * len(trips)), squeeze=False, layout="constrained")
    for row, (name, trip) in zip(axes, trips.items(), strict=True):
        for axis, scaled in zip(row, (False, True), strict=True):
            for model in MODELS:
                found = errors(trip, model, scaled)
                along_m, error_m = np.append(0.0, found.along_m), np.append(0.0, found.error_m)
                axis.plot(along_m, error_m, label=model, color=COLOURS[model])
            for end_m in np.cumsum([walk.true_m.sum() for walk in trip]):
                axis.axvline(end_m, color="#dddddd", linewidth=0.8, zorder=0)
            axis.axhline(0.0, color="#888888", linewidth=0.8)
            axis.set_title(f"{name}, {'scaled to the first walk' if scaled else 'as it is'}", fontsize=10)
            axis.set_xlabel("walked (m)")
            axis.set_ylabel("error of distance (m)")
    axes[0, 0].legend()
    figure.savefig(path, dpi=80)
    plt.close(figure)


if __name__ == "__main__":
    main()
