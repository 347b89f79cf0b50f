"""Figure 6 of UPTIME (Alzantot and Youssef 2012): error of the step count by place of the phone and by step size.

    python experiments/uptime_figure6.py --data DIR [--people 4]

Bars for the three detectors of the paper, its baselines as it had them (untuned, see uptime_table3.py), and `auto`.
Real: the Oxford step-counting recordings by place of the phone, whose step sizes are not known. Simulated: people who
walk slowly, as usual and quickly, jog and run, with the phone in the hand and in the pocket; their step sizes are
known. Writes experiments/results/uptime_figure6.png, .json and .txt, and the table of experiments/paper-details.md.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from recorded import RESULTS, command_line, markdown_table, write, write_table
from uptime_table3 import DETECTORS, PLACES, benchmark, measured

from pdr_est.config import Config
from pdr_est.evaluate.step_detection import count_error
from pdr_est.front_end.gait import GaitParams
from pdr_est.pipeline import analyse_recording
from pdr_est.simulate import (
    DeviceParams,
    GaitStretch,
    PacedStretch,
    PathParams,
    RunningStretch,
    Scenario,
    SimulatedPerson,
    SimulatedWalk,
    sample_person,
    simulate_walk,
)
from pdr_est.types.recording import Recording

MARK = "<!-- uptime figure 6 -->"
SHOWN = ("uptime-fsm", "local-variance, untuned", "zero-crossing, untuned", "auto")
COLOURS = ("#1f6f8b", "#b3462b", "#c9962f", "#777777")
WALK_M = 80.0
SIZES: Mapping[str, Callable[[SimulatedPerson], GaitStretch]] = {
    "walking slowly": lambda person: paced(0.75 * person.gait.cadence_hz),
    "walking": lambda person: paced(person.gait.cadence_hz),
    "walking quickly": lambda person: paced(1.2 * person.gait.cadence_hz),
    "jogging": lambda _: RunningStretch(kind="jogging", from_m=0.0, to_m=WALK_M, speed_mps=2.6),
    "running": lambda _: RunningStretch(kind="running", from_m=0.0, to_m=WALK_M, speed_mps=4.4),
}

Errors = dict[str, dict[str, float]]
"""Mean error of the count in percent by group and detector; `step_m` is the mean step size, NaN where unknown."""


def main() -> None:
    """Count, draw and write."""
    options = command_line(__doc__, {"--data": Path, "--people": 4})
    errors = {**real_errors(options.data), **simulated_errors(range(options.people))}
    draw(errors, RESULTS / "uptime_figure6.png")
    document = {
        group: {name: None if np.isnan(number) else number for name, number in row.items()}
        for group, row in errors.items()
    }
    write("uptime_figure6", as_text(errors), document)
    write_table(MARK, as_markdown(errors))


def paced(cadence_hz: float) -> PacedStretch:
    """Walk the whole way at a pace."""
    return PacedStretch(from_m=0.0, to_m=WALK_M, cadence_hz=cadence_hz)


def real_errors(data: Path) -> Errors:
    """Take the errors of the Oxford recordings from Table III, by place of the phone."""
    table = measured(benchmark(data))
    return {
        f"real, {place.words}": {
            "step_m": float("nan"),
            **{name: round(table[place.words][name], 2) for name in SHOWN},
        }
        for place in PLACES[:2]
    }


def simulated_errors(seeds: Sequence[int]) -> Errors:
    """Count the steps of simulated people, by place of the phone and size of the steps."""
    found: Errors = {}
    for place in ("in hand", "in pocket"):
        for size in SIZES:
            walks = [simulated(seed, place, size) for seed in seeds]
            step_m = float(np.mean([walk.distance_m / walk.step_count for walk in walks]))
            errors = mean_errors([walk.recording for walk in walks])
            found[f"simulated, {place}, {size}"] = {"step_m": round(step_m, 2), **errors}
    return found


def simulated(seed: int, place: str, size: str) -> SimulatedWalk:
    """Simulate a straight walk of a random person."""
    person = sample_person(np.random.default_rng([seed, 6]))
    carry = person.held if place == "in hand" else person.pocket
    return simulate_walk(
        Scenario(
            path=PathParams(vertices_m=((0.0, 0.0), (WALK_M, 0.0))),
            gait=replace(person.gait, stretches=(SIZES[size](person),)),
            body=person.body,
            devices=(DeviceParams(carry=carry),),
            seed=seed,
        )
    )


def mean_errors(recordings: Sequence[Recording]) -> dict[str, float]:
    """Compute the mean error of the count in percent, by detector."""
    return {
        name: round(float(np.mean([count_error_percent(recording, name) for recording in recordings])), 2)
        for name in SHOWN
    }


def count_error_percent(recording: Recording, detector: str) -> float:
    """Compute the error of the number of steps of one recording, percent."""
    config = replace(Config(), steps=DETECTORS[detector], gait=GaitParams(method="none"))
    (device,) = analyse_recording(recording, config)
    return 100.0 * count_error(len(device.steps), recording.truth.step_count or 0)


def as_text(errors: Errors) -> str:
    """Format a line for each group."""
    lines = [
        "Mean error of the number of steps, in percent, by place of the phone and step size (UPTIME, figure 6)",
        "",
        f"{'':38}{'step m':>8}" + "".join(f"{name:>26}" for name in SHOWN),
    ]
    for group, row in errors.items():
        step = "-" if np.isnan(row["step_m"]) else f"{row['step_m']:.2f}"
        lines.append(f"{group:38}{step:>8}" + "".join(f"{row[name]:26.1f}" for name in SHOWN))
    return "\n".join(lines) + "\n"


def as_markdown(errors: Errors) -> str:
    """Make the table of the README."""
    heads = (f"`{name.partition(',')[0]}`{' untuned' if ',' in name else ''}" for name in SHOWN)
    rows = []
    for group, row in errors.items():
        step = "–" if np.isnan(row["step_m"]) else f"{row['step_m']:.2f}"
        rows.append((group, step, *(f"{row[name]:.1f}" for name in SHOWN)))
    return markdown_table(("%", "step m", *heads), rows)


def draw(errors: Errors, path: Path) -> None:
    """Draw a group of bars for each place and step size."""
    figure, axis = plt.subplots(figsize=(11, 4.5), layout="constrained")
    width = 0.8 / len(SHOWN)
    for number, (name, colour) in enumerate(zip(SHOWN, COLOURS, strict=True)):
        heights = [row[name] for row in errors.values()]
        axis.bar(np.arange(len(errors)) + (number - 1.5) * width, heights, width, color=colour, label=name)
    axis.set_xticks(range(len(errors)), [group.replace(", ", "\n") for group in errors], fontsize=8)
    axis.set_ylabel("error of the number of steps (%)")
    axis.legend()
    figure.savefig(path, dpi=80, metadata={"Software": None})
    plt.close(figure)


if __name__ == "__main__":
    main()
