"""Draw simulated runners and stair climbers beside real ones: signals, spectra, direction of gravity.

    python experiments/simulated_gaits.py --data DIR

DIR holds `motionsense` (phone in the front trouser pocket: jogging, stairs) and `sisfall` (box at the belt: slow and
quick jogging). Writes experiments/results/simulated_gaits.png and a table of the same, .txt.
"""

import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from PIL import Image
from recorded import RESULTS, command_line, table_beside_real
from simulated_and_real import COLOURS, RATE_HZ, longest_steady_part, spectrum

from pdr_est import read
from pdr_est.frames import Array
from pdr_est.simulate import (
    DeviceParams,
    GaitStretch,
    HeldPhone,
    PathParams,
    RunningStretch,
    Scenario,
    StairStretch,
    sample_person,
    simulate_walk,
)
from pdr_est.types.recording import DeviceRecording

PEOPLE = 12
SHOWN_S = 4.0
GAITS = {
    "jogging, pocket": ("motionsense/jog_9/sub_*.csv*",),
    "slow jog, belt": ("sisfall/*/D03_*.txt*",),
    "quick jog, belt": ("sisfall/*/D04_*.txt*",),
    "stairs up, pocket": ("motionsense/ups_3/sub_*.csv*",),
    "stairs down, pocket": ("motionsense/dws_1/sub_*.csv*",),
}
RUN_MPS = {  # nobody knows how fast they ran: ours
    "jogging, pocket": (2.4, 3.6),
    "slow jog, belt": (1.8, 2.6),
    "quick jog, belt": (2.6, 4.0),
}
CADENCE_HZ = {gait: (2.0, 3.6) if gait in RUN_MPS else (1.2, 2.6) for gait in GAITS}
BELT = HeldPhone(  # a box that a belt holds upright on the trunk, a little loose
    tilt_rad=1.45,
    forward_m=0.12,
    up_m=0.0,
    rock_pitch_rad=0.07,
    rock_yaw_rad=0.16,
    rock_roll_rad=0.08,
    unrest_mps2=2.0,
    unrest_radps=0.45,
)


@dataclass(frozen=True)
class Gait:
    """Steady part of one recording at RATE_HZ.

    vertical_mps2: (n,) upwards without gravity; rotation_radps: (n,) rate of rotation; tilt_deg: (n,) gravity
    off its mean direction; cadence_hz: steps a second.
    """

    vertical_mps2: Array
    rotation_radps: Array
    tilt_deg: Array
    cadence_hz: float


def main() -> None:
    """Compare all gaits."""
    folder = command_line(__doc__, {"--data": Path}).data
    kinds = {gait: {"real": real_gaits(folder, gait), "simulated": simulated_gaits(gait)} for gait in GAITS}
    figure, axes = plt.subplots(len(kinds), 3, figsize=(13, 2.8 * len(kinds)), layout="constrained")
    for row, (gait, walks) in zip(axes, kinds.items(), strict=True):
        draw(row, gait, walks)
    picture = io.BytesIO()
    figure.savefig(picture, dpi=62)
    Image.open(picture).convert("RGB").quantize(32).save(RESULTS / "simulated_gaits.png", optimize=True)
    text = as_text(kinds)
    (RESULTS / "simulated_gaits.txt").write_text(text, encoding="utf-8")
    print(text, end="")


def real_gaits(folder: Path, gait: str) -> list[Gait]:
    """Read the real recordings of people who run or take stairs."""
    paths = sorted(path for pattern in GAITS[gait] for path in folder.glob(pattern))
    found = [steady_part(read(path).devices[0], CADENCE_HZ[gait]) for path in paths]
    return [part for part in found if part is not None]


def simulated_gaits(gait: str, seeds: Sequence[int] = range(PEOPLE)) -> list[Gait]:
    """Simulate a run, or a long flight of stairs, of each of some random people."""
    found = []
    for seed in seeds:
        rng = np.random.default_rng([seed, 1])
        person = sample_person(rng)
        stretch: GaitStretch
        if gait in RUN_MPS:
            stretch = RunningStretch(kind="jogging", from_m=0.0, to_m=120.0, speed_mps=rng.uniform(*RUN_MPS[gait]))
        else:
            direction: Literal["up", "down"] = "up" if "up" in gait else "down"
            stretch = StairStretch(from_m=0.0, to_m=15.0, direction=direction)
        scenario = Scenario(
            path=PathParams(vertices_m=((0.0, 0.0), (stretch.to_m, 0.0))),
            gait=replace(person.gait, stretches=(stretch,)),
            body=person.body,
            devices=(DeviceParams(carry=BELT if "belt" in gait else person.pocket),),
            seed=seed,
        )
        found.append(steady_part(simulate_walk(scenario).recording.devices[0], CADENCE_HZ[gait]))
    return [part for part in found if part is not None]


def steady_part(device: DeviceRecording, cadence_hz: tuple[float, float]) -> Gait | None:
    """Return the longest part with movement, without its ends; None below 10 s.

    The cadence is looked for between the given steps a second.
    """
    found = longest_steady_part(device)
    if found is None:
        return None
    block, level, part = found
    up = level.up[part]
    mean_up = up.mean(axis=0) / np.linalg.norm(up.mean(axis=0))
    frequency, power = spectrum(level.vertical_mps2[part])
    band = (frequency > cadence_hz[0]) & (frequency < cadence_hz[1])
    return Gait(
        vertical_mps2=level.vertical_mps2[part],
        rotation_radps=np.linalg.norm(block.rotation_rate_radps[part], axis=1),
        tilt_deg=np.degrees(np.arccos(np.clip(up @ mean_up, -1.0, 1.0))),
        cadence_hz=float(frequency[band][np.argmax(power[band])]),
    )


def stride_over_step(walk: Gait) -> float:
    """Compute the power of the vertical acceleration at half the cadence over that at the cadence."""
    frequency, power = spectrum(walk.vertical_mps2)
    stride, step = (power[np.abs(frequency - share * walk.cadence_hz) < 0.25].sum() for share in (0.5, 1.0))
    return float(stride / step)


MEASURES: Mapping[str, Callable[[Gait], float]] = {
    "cadence, Hz": lambda walk: walk.cadence_hz,
    "vertical, 1st percentile, m/s2": lambda walk: float(np.percentile(walk.vertical_mps2, 1)),
    "vertical, 99th percentile, m/s2": lambda walk: float(np.percentile(walk.vertical_mps2, 99)),
    "vertical, power of the stride over the step's": stride_over_step,
    "rotation, rms, rad/s": lambda walk: float(np.sqrt((walk.rotation_radps**2).mean())),
    "rotation, 99th percentile, rad/s": lambda walk: float(np.percentile(walk.rotation_radps, 99)),
    "gravity off its mean, 95th percentile, deg": lambda walk: float(np.percentile(walk.tilt_deg, 95)),
}


def as_text(kinds: Mapping[str, Mapping[str, Sequence[Gait]]]) -> str:
    """Tabulate medians over the people of each gait, with the 10th and 90th percentile."""
    return table_beside_real(kinds, MEASURES, "people")


def draw(axes: Array, gait: str, kinds: Mapping[str, Sequence[Gait]]) -> None:
    """Draw one row: vertical acceleration, its spectrum, tilt of gravity."""
    signal, vertical, tilt = axes
    strides, shares = np.linspace(0.3, 14.0, 400), np.linspace(0.0, 1.0, 100)
    for kind, walks in kinds.items():
        typical = sorted(walks, key=lambda walk: float(walk.vertical_mps2.std()))[len(walks) // 2]
        middle = len(typical.vertical_mps2) // 2
        shown = typical.vertical_mps2[middle : middle + int(SHOWN_S * RATE_HZ)]
        signal.plot(np.arange(len(shown)) / RATE_HZ, shown, color=COLOURS[kind], lw=1.0, label=kind)
        curves = []
        for walk in walks:
            frequency, power = spectrum(walk.vertical_mps2)
            curves.append(np.interp(strides, frequency / (0.5 * walk.cadence_hz), power))
            tilt.plot(np.quantile(walk.tilt_deg, shares), shares, color=COLOURS[kind], lw=0.7)
        low, usual, high = np.percentile(curves, [10, 50, 90], axis=0)
        vertical.fill_between(strides, low, high, color=COLOURS[kind], alpha=0.25, lw=0)
        vertical.semilogy(strides, usual, color=COLOURS[kind], lw=1.2)
    signal.set(title=f"{gait}: vertical acceleration, m/s²", xlabel="time, s")
    vertical.set(title="its spectrum, (m/s²)²/Hz", xlabel="frequency / stride frequency", ylim=(1e-3, None))
    tilt.set(title="gravity off its mean direction", xlabel="at most, degrees", ylabel="share of time")
    signal.legend(loc="upper right")


if __name__ == "__main__":
    main()
