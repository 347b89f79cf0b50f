"""Made-up people for the gait model: features of steps around a point of each gait, and whole recordings.

Each person walks, jogs and runs a little differently.
"""

from pathlib import Path

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.front_end.gait.training_data import LabelledSteps
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.types.recording import DeviceRecording, Recording, Signal
from pdr_est.types.steps import Gait

RATE_HZ, DURATION_S = 50.0, 20.0
GAITS = {"walking": (1.8, 3.0), "jogging": (2.5, 9.0), "running": (2.8, 13.0)}  # steps a second, m/s^2

CENTRES = {
    Gait.WALKING: (1.2, 1.3, -0.6, 1.2, -7.0, 0.48),
    Gait.JOGGING: (2.3, 2.2, -0.9, 1.6, -14.0, 0.47),
    Gait.RUNNING: (2.5, 2.4, -1.0, 2.0, -17.0, 0.45),
}


def walks_of(people: int, steps: int = 60, joggers_only: int = 0, seed: int = 0) -> list[LabelledSteps]:
    """Walking, jogging and running of some people, walking and jogging of some more."""
    rng = np.random.default_rng(seed)
    walks = []
    for number in range(people + joggers_only):
        offset = 0.05 * rng.standard_normal(6)
        gaits = list(CENTRES) if number < people else [Gait.WALKING, Gait.JOGGING]
        for gait in gaits:
            spread = rng.standard_normal((steps, 6)) * (0.12, 0.12, 0.05, 0.15, 1.0, 0.02)
            features = np.round(np.array(CENTRES[gait]) + offset + spread, 6)
            begins = np.arange(steps) % 20 == 0
            data_set = "both" if number < people else "jogging"
            walks.append(LabelledSteps(f"{data_set}/{number}", data_set, gait, features, begins))
    return walks


def bouncing(rate_hz: float, height_mps2: float, seed: int) -> Recording:
    """An accelerometer that goes up and down, for twenty seconds."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(0.0, DURATION_S, 1.0 / RATE_HZ)
    force = 0.5 * rng.standard_normal((len(time_s), 3))
    force[:, 2] += STANDARD_GRAVITY_MPS2 + height_mps2 * np.sin(2.0 * np.pi * rate_hz * time_s)
    return Recording("made up", "plain", (DeviceRecording(specific_force=Signal(time_s, force)),))


def three_people(folder: Path) -> Path:
    """Write recordings of three people into a folder as `pdr-est train-gait` reads it."""
    for number, person in enumerate(("anna", "ben", "chris")):
        for gait, (rate_hz, height_mps2) in GAITS.items():
            (folder / gait / person).mkdir(parents=True)
            recording = bouncing(rate_hz + 0.05 * number, height_mps2 + 0.2 * number, number)
            write_plain_csv(recording, folder / gait / person / "around the block.csv")
    return folder
