"""Count the false steps of simulated passengers, and show a simulated lift beside a real one.

    python experiments/passengers.py --data DIR

DIR holds the data sets. Writes experiments/results/passengers.json and .txt.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from recorded import command_line, markdown_table, write
from scipy.signal import welch

from pdr_est import Config, read
from pdr_est.frames import Array
from pdr_est.front_end.steps import step_detector
from pdr_est.pipeline.front_end_chain import levelling
from pdr_est.simulate import SimulatedWalk, VehicleParams, riding_walk, simulate_walk
from pdr_est.simulate.presets.riding import Place
from pdr_est.simulate.riding.riding_body import RidingBody
from pdr_est.simulate.riding.vehicles import bus, car, escalator, lift, train
from pdr_est.simulate.riding.vibration import Posture
from pdr_est.types.recording import DeviceRecording

RIDE_S, SEED = 300.0, 4000
ROWS: dict[str, Callable[[], VehicleParams]] = {
    "bus": bus,
    "car": car,
    "train": train,
    "lift": lift,
    "escalator": escalator,
    "bus, road twice as rough": lambda: bus(256e-6),
    "car, road twice as rough": lambda: car(128e-6),
    "train, track twice as rough": lambda: train(128e-6),
}
WAYS: tuple[tuple[Posture, Place], ...] = (
    ("standing", "hand"),
    ("standing", "pocket"),
    ("sitting", "hand"),
    ("sitting", "pocket"),
    ("sitting", "seat"),
)
REAL_LIFT = ("walks/ipin21/zero2four.csv.gz", 94.0, 112.0)  # between two floors, from the pressure


def main() -> None:
    """Count and compare."""
    folder = command_line(__doc__, {"--data": Path}).data
    counted = {name: false_steps(make()) for name, make in ROWS.items()}
    lifts = {"real": real_lift(folder), "simulated": simulated_lift()}
    columns = ("vertical, m/s²", "1 to 3 Hz, m/s²", "false steps a minute", "steps missed beside the ride")
    table = markdown_table(
        ("ride", *columns),
        [[name, *(f"{value:.2f}" for value in row.values())] for name, row in counted.items()],
    )
    names = ("greatest acceleration, m/s²", "greatest braking, m/s²", "speed, m/s", "vibration over 2 Hz, m/s²")
    beside = markdown_table(
        ("lift", *names), [[name, *(f"{value:.2f}" for value in row)] for name, row in lifts.items()]
    )
    write("passengers", f"{table}\n\n{beside}\n", {"rides": counted, "lifts": lifts})


def false_steps(vehicle: VehicleParams) -> dict[str, float]:
    """Measure the vibration of passengers in all ways, and count their steps."""
    rows = []
    for number, (posture, place) in enumerate(WAYS):
        walk = simulate_walk(riding_walk(vehicle, posture, place, ride_s=RIDE_S, seed=SEED + number))
        if not isinstance(walk.body, RidingBody):
            raise TypeError("the walk has no ride")
        (start_s, end_s) = walk.body.ride_spans_s[0]
        time_s, vertical_mps2, steps_s = from_phone(walk.recording.devices[0])
        riding = (time_s > start_s) & (time_s < end_s)
        at_hz, density = welch(vertical_mps2[riding], 50.0, nperseg=512)
        band = (at_hz >= 1.0) & (at_hz <= 3.0)
        false = int(np.count_nonzero((steps_s > start_s) & (steps_s < end_s)))
        rows.append(
            (
                vertical_mps2[riding].std(),
                np.sqrt(density[band].sum() * at_hz[1]),
                60.0 * false / (end_s - start_s),
                missed(walk, steps_s),
            )
        )
    strength, band_mps2, per_minute, lost = np.mean(rows, axis=0).tolist()
    return {"vertical_mps2": strength, "band_mps2": band_mps2, "false_per_minute": per_minute, "missed": lost}


def missed(walk: SimulatedWalk, steps_s: Array) -> int:
    """Count the true steps without a detected one within 0.3 s."""
    nearest_s = np.abs(walk.steps.time_s[:, None] - steps_s).min(axis=1)
    return int(np.count_nonzero(nearest_s > 0.3))


def from_phone(device: DeviceRecording) -> tuple[Array, Array, Array]:
    """Compute times and vertical acceleration of the level samples, and the times of the steps."""
    config = Config()
    _, to_level = levelling(device, device.name, config)
    levels = [level for block in device.blocks() for level in to_level.push(block)] + list(to_level.flush())
    detector = step_detector(config.resample.rate_hz, config.steps)
    steps = [event for level in levels for event in detector.push(level)] + detector.flush()
    columns = (np.concatenate([getattr(level, name) for level in levels]) for name in ("time_s", "vertical_mps2"))
    return (*columns, np.array([event.time_s for event in steps]))


def real_lift(folder: Path) -> list[float]:
    """Describe the lift of the data set ipin21, from the length of the specific force."""
    name, start_s, end_s = REAL_LIFT
    force = read(folder / name).devices[0].specific_force
    if force is None:
        raise ValueError(f"{name} has no accelerometer")
    during = (force.time_s > start_s) & (force.time_s < end_s)
    return described_lift(force.time_s[during], np.linalg.norm(force.values[during], axis=1))


def simulated_lift() -> list[float]:
    """Describe the first run of the simulated lift in the same way."""
    walk = simulate_walk(riding_walk(lift(), ride_s=25.0, seed=SEED))
    force = walk.recording.devices[0].specific_force
    if force is None or not isinstance(walk.body, RidingBody):
        raise TypeError("the walk has no ride, or no accelerometer")
    start_s, end_s = walk.body.ride_spans_s[0]
    during = (force.time_s > start_s - 1.0) & (force.time_s < end_s + 1.0)
    return described_lift(force.time_s[during], np.linalg.norm(force.values[during], axis=1))


def described_lift(time_s: Array, force_mps2: Array) -> list[float]:
    """Find acceleration and braking (means of half a second), speed and vibration of one run upwards."""
    rate_hz = (len(time_s) - 1) / (time_s[-1] - time_s[0])
    vertical = force_mps2 - np.median(force_mps2)  # the accelerometer has a bias
    width = round(0.5 * rate_hz)
    smooth = np.convolve(vertical, np.ones(width) / width, "same")
    speed = np.cumsum(smooth) / rate_hz
    at_hz, density = welch(vertical, rate_hz, nperseg=min(256, len(vertical)))
    vibration = np.sqrt(density[(at_hz > 2.0) & (at_hz < 20.0)].sum() * at_hz[1])
    return [float(smooth.max()), float(-smooth.min()), float(speed.max()), float(vibration)]


if __name__ == "__main__":
    main()
