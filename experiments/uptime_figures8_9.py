"""Figures 8 and 9 of UPTIME (Alzantot and Youssef 2012): traces and distance error of whole trips.

    python experiments/uptime_figures8_9.py --data DIR [--people 4]

The paper's system, as far as it is published, is its step detector, its six features with its classifier and the
length of Table II for each gait (`uptime`); beside it stand its parts exchanged one by one for those of the default,
and the default alone (`default`). The traces have the yaw of the phone as heading, because the paper leaves headings
to later work.

Simulated: the trips of `pdr_est.simulate.uptime_trip` with phones in the hand and in the pocket. Real: walks of known
length (known-distance, phyphox hallway loop) and outdoor walks with GPS as in figure 8 (phone-gps); the length of a
GPS track is that of its chords of 5 s. The error is that of the distance, in percent, as in the paper. Where the gait
of each step is known, in the simulation, the share of steps is told that are rightly labelled as walking or faster.
Writes experiments/results/uptime_figures8_9.png, .json and .txt, and the table of experiments/paper-details.md.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import get_args

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from recorded import RESULTS, command_line, markdown_table, write, write_table

from pdr_est.config import Config, EstimatorParams, StartParams
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.suites import phone_gps
from pdr_est.front_end.gait import GaitParams
from pdr_est.front_end.heading import HeadingParams
from pdr_est.front_end.step_length import StepLengthParams, WalkerParams
from pdr_est.front_end.steps import StepsParams
from pdr_est.io import read
from pdr_est.io.side_tables.known_distances import read_known_distances
from pdr_est.pipeline import analyse_recording, smooth_recording
from pdr_est.simulate import SimulatedWalk, StepSchedule, UptimeTrip, simulate_walk, uptime_trip
from pdr_est.types.recording import Recording
from pdr_est.types.steps import CarryingMode, Gait, Step

MARK = "<!-- uptime figures 8 and 9 -->"
STEPS, GAIT, LENGTH = (
    StepsParams(detector="uptime-fsm"),
    GaitParams(method="uptime"),
    StepLengthParams(model="gait-table"),
)
CHAINS: Mapping[str, Config] = {
    "uptime": Config(steps=STEPS, gait=GAIT, step_length=LENGTH),
    "uptime, our steps": Config(gait=GAIT, step_length=LENGTH),
    "uptime, our steps and gaits": Config(step_length=LENGTH),
    "default": Config(),
}
PAPER_PERCENT = {"compound": 6.9, "building": 5.9}  # as printed; 33 m of 623 m are 5.3, 4 m of 95 m are 4.2
CHORD_S = 5.0  # shorter ones add the noise of the fixes, longer ones cut the curves of these playing fields
HALLWAY_M = 116.0
MODES = {"in hand": CarryingMode.HOLDING, "in pocket": CarryingMode.POCKET}


@dataclass(frozen=True)
class Trip:
    """Recording of a trip with its length, m, and what is known of the walker's body and steps."""

    recording: Recording
    true_m: float
    walker: WalkerParams = field(default_factory=WalkerParams)
    steps: StepSchedule | None = None


Errors = dict[str, dict[str, list[tuple[float, float]]]]
"""By group of trips and chain, for each trip: relative error of the distance, and share of right gaits (or NaN)."""


def main() -> None:
    """Measure, draw and write."""
    options = command_line(__doc__, {"--data": Path, "--people": 4})
    groups = {**simulated_trips(range(options.people)), **real_trips(options.data)}
    errors = {
        group: {name: [error_of(trip, config) for trip in trips] for name, config in CHAINS.items()}
        for group, trips in groups.items()
    }
    draw(RESULTS / "uptime_figures8_9.png")
    write("uptime_figures8_9", as_text(errors), as_document(errors))
    write_table(MARK, as_markdown(errors))


def simulated_trips(seeds: Sequence[int]) -> dict[str, list[Trip]]:
    """Simulate every trip of some people, by name of the trip and place of the phone."""
    return {
        f"{name}, {place}": [as_trip(simulate_walk(uptime_trip(name, seed, mode))) for seed in seeds]
        for name in get_args(UptimeTrip)
        for place, mode in MODES.items()
    }


def as_trip(walk: SimulatedWalk) -> Trip:
    """Take recording, length and body of a simulated walk."""
    gait = walk.scenario.gait
    return Trip(walk.recording, walk.distance_m, WalkerParams(height_m=gait.height_m, gender=gait.gender), walk.steps)


def real_trips(data: Path) -> dict[str, list[Trip]]:
    """Read the real trips of known length, by data set."""
    known = read_known_distances(next((data / "known-distance").glob("truth.csv*")))
    walked = recordings(data / "known-distance", "*.csv")
    outdoors = [phone_gps.SUITE.prepare(read(path)) for _, path in recordings(data / "phone-gps", "*.csv")]
    return {
        "known-distance, in hand": [
            Trip(read(path), known[name].distance_m) for name, path in walked if name in known
        ],
        "phyphox hallway loop, in hand": [Trip(read(data / "phyphox" / "hallway-loop"), HALLWAY_M)],
        "phone-gps, held": [Trip(one, gps_length_m(one)) for one in outdoors if "swing" not in one.name],
        "phone-gps, swung": [Trip(one, gps_length_m(one)) for one in outdoors if "swing" in one.name],
    }


def gps_length_m(recording: Recording) -> float:
    """Compute the length of a GPS track from its chords, m."""
    positions = recording.truth.positions
    if positions is None:
        raise SystemExit(f"{recording.name}: no GPS track")
    time_s = np.append(np.arange(positions.time_s[0], positions.time_s[-1], CHORD_S), positions.time_s[-1])
    track = np.stack([np.interp(time_s, positions.time_s, axis) for axis in positions.position_m.T], axis=1)
    return float(np.linalg.norm(np.diff(track, axis=0), axis=1).sum())


def error_of(trip: Trip, config: Config) -> tuple[float, float]:
    """Compute the error of the distance of a trip over its length, and the share of right gaits."""
    (device,) = analyse_recording(trip.recording, replace(config, walker=trip.walker))
    error = round(sum(step.length_m for step in device.steps) / trip.true_m - 1.0, 4)
    return error, float("nan") if trip.steps is None else round(right_gaits(trip.steps, device.steps), 4)


def right_gaits(true: StepSchedule, steps: Sequence[Step]) -> float:
    """Compute the share of steps with the right label, walking or faster, by the true step that each lies in."""
    middle_s = np.array([0.5 * (step.start_s + step.event.time_s) for step in steps])
    within = np.minimum(np.searchsorted(true.time_s, middle_s), len(true) - 1)
    faster = np.array([step.gait is not Gait.WALKING for step in steps])
    return float(np.mean((true.gait[within] != Gait.WALKING) == faster))


def percent(errors: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Compute the mean absolute error and the mean error of the distance, percent."""
    relative = [error for error, _ in errors]
    return 100.0 * float(np.mean(np.abs(relative))), 100.0 * float(np.mean(relative))


def gait_words(row: Mapping[str, list[tuple[float, float]]]) -> str:
    """Format the share of right gaits of the first and the last chain, percent."""
    shares = [float(np.mean([share for _, share in row[name]])) for name in ("uptime", "default")]
    return "–" if np.isnan(shares).any() else " / ".join(f"{100.0 * share:.1f}" for share in shares)


def as_document(errors: Errors) -> dict[str, object]:
    """Make the document: the paper's two numbers, and every error in percent."""
    return {
        "paper_percent": PAPER_PERCENT,
        "error_percent": {
            group: {name: [round(100.0 * error, 2) for error, _ in each] for name, each in row.items()}
            for group, row in errors.items()
        },
        "right_gaits_percent": {
            group: {name: [round(100.0 * share, 2) for _, share in row[name]] for name in ("uptime", "default")}
            for group, row in errors.items()
            if not np.isnan(row["default"][0][1])
        },
    }


def as_text(errors: Errors) -> str:
    """Format a line for each group of trips."""
    lines = [
        "Error of the distance of whole trips, percent: mean of the absolute errors, and mean error (UPTIME, figures",
        f"8 and 9; paper: {PAPER_PERCENT['compound']} outdoors, {PAPER_PERCENT['building']} indoors).",
        "",
        f"{'':32}{'trips':>6}" + "".join(f"{name:>30}" for name in CHAINS) + f"{'right gaits':>16}",
    ]
    for group, row in errors.items():
        cells = "".join(f"{'{:.1f} ({:+.1f})'.format(*percent(row[name])):>30}" for name in CHAINS)
        lines.append(f"{group:32}{len(row['default']):6d}{cells}{gait_words(row):>16}")
    return "\n".join(lines) + "\n"


def as_markdown(errors: Errors) -> str:
    """Make the table of the README."""
    rows = [
        (
            group,
            str(len(row["default"])),
            *("{:.1f} ({:+.1f})".format(*percent(row[name])) for name in CHAINS),
            gait_words(row),
        )
        for group, row in errors.items()
    ]
    return markdown_table(("distance error, %", "trips", *(f"`{name}`" for name in CHAINS), "right gaits, %"), rows)


def draw(path: Path) -> None:
    """Draw the trace of one simulated person around the compound and in the building, from the known start."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 5), layout="constrained")
    names: tuple[UptimeTrip, ...] = ("compound", "building")
    for axis, name in zip(axes, names, strict=True):
        walk = simulate_walk(uptime_trip(name))
        axis.plot(*walk.truth_position_m.T, "k--", lw=1.0, label="true")
        for chain, colour in (("uptime", "tab:blue"), ("default", "tab:red")):
            heading_rad = float(walk.truth_heading_rad[0])
            x_m, y_m = walk.truth_position_m[0].tolist()
            start = StartParams(x_m=x_m, y_m=y_m, heading_rad=heading_rad, sigma_heading_rad=0.0)
            own = as_trip(walk)
            reckoning = EstimatorParams(name="dead-reckoning")
            chosen = replace(CHAINS[chain], heading=HeadingParams(method="step-yaw"), estimator=reckoning)
            config = replace(chosen, start=start, walker=own.walker)
            track = smooth_recording(walk.recording, config).track
            axis.plot(*track.position_m.T, color=colour, lw=1.2, label=chain)
        axis.set(title=f"{name}, {walk.distance_m:.0f} m", xlabel="east (m)", ylabel="north (m)", aspect="equal")
    axes[0].legend()
    figure.savefig(path, dpi=80, metadata={"Software": None})
    plt.close(figure)


if __name__ == "__main__":
    main()
