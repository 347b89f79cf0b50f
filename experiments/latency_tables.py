"""Latency of every stage of the front end, and of whole chains, as the stages declare it.

    python experiments/latency_tables.py

Writes the tables into docs/latency.md.
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
from recorded import write_table

from pdr_est.config import Config, load_config
from pdr_est.front_end.attitude import AccelerometerTilt, DeviceAttitude, VqfAttitude
from pdr_est.front_end.gait import gait_stage
from pdr_est.front_end.heading import HEADINGS, heading_stage, whole_walk_stage
from pdr_est.front_end.mode import mode_stage
from pdr_est.front_end.odometry import Odometry
from pdr_est.front_end.step_length import StepLength
from pdr_est.front_end.steps import DETECTORS, step_detector
from pdr_est.front_end.steps.segmentation import StepSegmentation
from pdr_est.pipeline.front_end_chain import levelling, stepping
from pdr_est.stage import Chain, Stage
from pdr_est.types.recording import DeviceRecording, Signal

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "latency.md"
MARK = "<!-- latency -->"
MODES: tuple[Literal["auto", "mmpdr", "fixed"], ...] = ("auto", "mmpdr", "fixed")


def main() -> None:
    """Write the tables into the page."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    write_table(MARK, latency_tables(), PAGE)


def latency_tables() -> str:
    """Both tables as Markdown."""
    return "\n\n".join([stage_table(), chain_table()])


def stage_table() -> str:
    """A row a stage with the default parameters."""
    config = Config()
    rate_hz = config.resample.rate_hz
    rows: list[tuple[str, str, Stage]] = [
        ("resampling", "", levelling(phone(), "phone", config)[0]),
        ("attitude", "vqf", VqfAttitude(rate_hz, config.attitude)),
        ("attitude", "device", DeviceAttitude()),
        ("attitude", "accelerometer alone", AccelerometerTilt(rate_hz, config.attitude)),
        *(("carrying mode", name, mode_stage(rate_hz, replace(config.mode, method=name))) for name in MODES),
        *(("steps", name, steps_of(config, name)) for name in DETECTORS),
        ("gait", config.gait.method, gait_stage(rate_hz, config.gait)),
        ("step length", "every model", StepLength(rate_hz, config.walker, config.step_length)),
        *(("heading", name, heading_stage(rate_hz, replace(config.heading, method=name))) for name in HEADINGS),
        ("odometry", "", Odometry("phone", config.odometry)),
    ]
    whole_walk = whole_walk_stage(config.heading)
    if whole_walk is not None:
        rows.insert(-1, ("dominant directions", "", whole_walk))
    return as_table(
        ("stage", "choice", "latency_s"), [(stage, choice, in_words(made.latency_s)) for stage, choice, made in rows]
    )


def steps_of(config: Config, detector: str) -> Stage:
    """A detector and what makes steps of its events."""
    chosen = next(name for name in DETECTORS if name == detector)
    found = step_detector(config.resample.rate_hz, replace(config.steps, detector=chosen))
    return StepSegmentation(found, config.steps.segmentation)


def chain_table() -> str:
    """A row a chain, from raw samples to odometry."""
    default = Config()
    chains = {
        "the defaults": default,
        "the defaults with `heading.method: step-yaw`": _with_heading(default),
        "`configs/settings/mmpdr.yaml`": load_config(ROOT / "configs" / "settings" / "mmpdr.yaml"),
    }
    rows = []
    for words, config in chains.items():
        to_level, to_step = levelling(phone(), "phone", config)[1], stepping(config)
        whole = Chain([to_level, to_step, Odometry("phone", config.odometry)])
        rows.append((words, in_words(to_level.latency_s), in_words(to_step.latency_s), in_words(whole.latency_s)))
    return as_table(("chain", "to level samples", "to steps", "sum, s"), rows)


def _with_heading(config: Config) -> Config:
    return replace(config, heading=replace(config.heading, method="step-yaw"))


def phone() -> DeviceRecording:
    """A device with all sensors."""
    time_s = np.arange(2.0)
    return DeviceRecording(
        specific_force=Signal(time_s, np.zeros((2, 3))),
        rotation_rate=Signal(time_s, np.zeros((2, 3))),
        attitude=Signal(time_s, np.tile([1.0, 0.0, 0.0, 0.0], (2, 1))),
    )


def in_words(latency_s: float) -> str:
    """With two digits, or that the end of the recording is waited for."""
    return "the end" if math.isinf(latency_s) else f"{latency_s:.2f}"


def as_table(titles: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """As Markdown."""
    return "\n".join(f"| {' | '.join(row)} |" for row in (titles, ["---"] * len(titles), *rows))


if __name__ == "__main__":
    main()
