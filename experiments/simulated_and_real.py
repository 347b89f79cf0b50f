"""Draw simulated phones beside real ones in the same mode: signals, spectra, direction of gravity.

    python experiments/simulated_and_real.py --data DIR

DIR holds the data sets. The table has, besides, what limbs do to MMPDR's detector: the harmonics of a swinging arm's
forward acceleration, the share of a turn that a gyroscope in a pocket sees, and the steps that the detector counts,
with the mode given, over those of the default detector. A real swinging phone lies in the hand in any way; its count
is of the axis that would be y as in MMPDR, Fig. 1(c).

Writes experiments/results/simulated_and_real.png and a table of the same, .txt.
"""

import io
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import matplotlib.pyplot as plt
import numpy as np
from limb_statistics import arm_harmonics, kept_turn, swing_axes
from PIL import Image
from recorded import RESULTS, command_line, table_beside_real
from scipy.signal import welch

from pdr_est import read
from pdr_est.config import Config
from pdr_est.frames import Array
from pdr_est.front_end.attitude import AttitudeParams, VqfAttitude
from pdr_est.front_end.heading.level_frame import to_level
from pdr_est.front_end.mode import ModeParams
from pdr_est.front_end.steps import StepsParams
from pdr_est.pipeline import analyse_recording
from pdr_est.simulate import DeviceParams, PathParams, Scenario, sample_person, simulate_walk
from pdr_est.types.recording import DeviceRecording, Recording, Signal
from pdr_est.types.sensors import ImuBlock, LevelBlock

RATE_HZ = 100.0
PEOPLE = 16
SHOWN_S = 5.0
MODES = {
    "holding": ("phyphox/hallway-loop", "ilc20/site1/F1/5dd9e7[bc]*.txt*", "known-distance/[A-G].csv*"),
    "swing": ("phone-gps/*swing*",),
    "pocket": (
        "motionsense/wlk_7/sub_*.csv*",
        "oxiod/large-scale/floor1/syn/imu[456].csv*",
        "sensor-logger/inpocket*",
    ),
}
MODES_BY_NAME: dict[str, Literal["HOLDING", "SWING", "POCKET"]] = {
    "holding": "HOLDING",
    "swing": "SWING",
    "pocket": "POCKET",
}
COLOURS = {"real": "tab:gray", "simulated": "tab:red"}


@dataclass(frozen=True)
class Walk:
    """Steady walking of one recording at RATE_HZ.

    vertical_mps2: (n,) upwards without gravity; rotation_radps: (n, 3); tilt_deg: (n,) angle of gravity from its
    mean direction; cadence_hz: steps a second. up: (3,) the mean direction, device axes.
    swing_turn_degps: what the swing alone turns the device about `up`, less what the walker turns, absolute.
    arm: what `arm_harmonics` measures. kept_turn: what `kept_turn` measures. mmpdr_count: steps that MMPDR's detector
    counts in the whole recording over those of the default.
    """

    name: str
    vertical_mps2: Array
    rotation_radps: Array
    tilt_deg: Array
    up: Array
    cadence_hz: float
    swing_turn_degps: float
    arm: tuple[float, float, float]
    kept_turn: float
    mmpdr_count: float


def main() -> None:
    """Compare all modes."""
    folder = command_line(__doc__, {"--data": Path}).data
    kinds = {mode: {"real": real_walks(folder, mode), "simulated": simulated_walks(mode)} for mode in MODES}
    figure, axes = plt.subplots(len(MODES), 4, figsize=(16, 9), layout="constrained")
    for row, (mode, walks) in zip(axes, kinds.items(), strict=True):
        draw(row, mode, walks)
    picture = io.BytesIO()
    figure.savefig(picture, dpi=68)
    Image.open(picture).convert("RGB").quantize(48).save(RESULTS / "simulated_and_real.png", optimize=True)
    (RESULTS / "simulated_and_real.txt").write_text(table(kinds), encoding="utf-8")


def real_walks(folder: Path, mode: str) -> list[Walk]:
    """Read the real recordings of a mode with at least 10 s of walking."""
    paths = sorted(path for pattern in MODES[mode] for path in folder.glob(pattern))
    walks = [steady_walk(path.name, read(path), mode) for path in paths]
    return [walk for walk in walks if walk is not None]


def simulated_walks(mode: str) -> list[Walk]:
    """Simulate one walk of each of some random people."""
    walks = []
    for seed in range(PEOPLE):
        person = sample_person(np.random.default_rng(seed))
        carry = {"holding": person.held, "swing": person.swing, "pocket": person.pocket}[mode]
        straight = PathParams(vertices_m=((0.0, 0.0), (80.0, 0.0)))
        device = DeviceParams(carry=carry)
        scenario = Scenario(path=straight, gait=person.gait, body=person.body, devices=(device,), seed=seed)
        walk = steady_walk(f"person {seed}", simulate_walk(scenario).recording, mode)
        if walk is not None:
            walks.append(walk)
    return walks


def longest_steady_part(device: DeviceRecording) -> tuple[ImuBlock, LevelBlock, slice] | None:
    """Return the samples of a device, the same levelled, and the part of steady walking; None below 10 s of it."""
    force, rate = device.specific_force, device.rotation_rate
    if force is None or rate is None:
        return None
    time_s = np.arange(max(force.time_s[0], rate.time_s[0]), min(force.time_s[-1], rate.time_s[-1]), 1.0 / RATE_HZ)
    block = ImuBlock(0, 0, time_s, sampled(force, time_s), sampled(rate, time_s))
    level = VqfAttitude(RATE_HZ, AttitudeParams()).push(block)[0]
    part = longest_walking(block.specific_force_mps2)
    return None if part.stop - part.start < 10.0 * RATE_HZ else (block, level, part)


def steady_walk(name: str, recording: Recording, mode: str) -> Walk | None:
    """Return the longest segment of walking of a recording without its ends; None below 10 s."""
    found = longest_steady_part(recording.devices[0])
    if found is None:
        return None
    block, level, part = found
    up = level.up[part]
    mean_up = up.mean(axis=0) / np.linalg.norm(up.mean(axis=0))
    vertical, rotation = level.vertical_mps2[part], block.rotation_rate_radps[part]
    yaw = np.unwrap(level.yaw_rad[part])
    walker_radps = (yaw[-1] - yaw[0]) / (len(yaw) - 1) * RATE_HZ * (up @ mean_up).mean()
    frequency, power = spectrum(vertical)
    axes = swing_axes(up, level.acceleration_mps2[part], RATE_HZ) if mode == "swing" else np.eye(3)
    band = (frequency > 1.2) & (frequency < 2.6)
    return Walk(
        name=name,
        vertical_mps2=vertical,
        rotation_radps=rotation,
        tilt_deg=np.degrees(np.arccos(np.clip(up @ mean_up, -1.0, 1.0))),
        up=mean_up,
        cadence_hz=float(frequency[band][np.argmax(power[band])]),
        swing_turn_degps=float(np.degrees(np.abs((level.rotation_rate_radps[part] @ mean_up).mean() - walker_radps))),
        arm=arm_harmonics(np.column_stack([to_level(level.acceleration_mps2[part], up, yaw), vertical]), RATE_HZ),
        kept_turn=kept_turn(up, level.acceleration_mps2[part], RATE_HZ),
        mmpdr_count=mmpdr_count(recording, mode, axes),
    )


def mmpdr_count(recording: Recording, mode: str, axes: Array) -> float:
    """Count steps by MMPDR's detector, in the known mode and in other axes, over those of the default detector."""
    device = recording.devices[0]
    turned = replace(
        device,
        specific_force=in_axes(device.specific_force, axes),
        rotation_rate=in_axes(device.rotation_rate, axes),
        attitude=None,
    )
    carried = MODES_BY_NAME[mode]
    paper = replace(Config(), mode=ModeParams(method="fixed", fixed=carried), steps=StepsParams(detector="mmpdr"))
    counted, usual = (
        len(analyse_recording(replace(recording, devices=(turned,)), config)[0].steps) for config in (paper, Config())
    )
    return counted / max(usual, 1)


def in_axes(signal: Signal | None, axes: Array) -> Signal | None:
    """Turn a signal into axes whose unit vectors are the rows of a matrix."""
    return None if signal is None else Signal(signal.time_s, signal.values @ axes.T)


def sampled(signal: Signal, time_s: Array) -> Array:
    """Interpolate a three-axis signal linearly at other times."""
    return np.stack([np.interp(time_s, signal.time_s, axis) for axis in signal.values.T], axis=1)


def longest_walking(force_mps2: Array) -> slice:
    """Find where the RMS of the magnitude over 2 s is above 0.8 m/s²; 3 s and 1 s at the ends are cut off."""
    moving = np.linalg.norm(force_mps2, axis=1) - np.linalg.norm(force_mps2, axis=1).mean()
    window = np.ones(int(2.0 * RATE_HZ)) / int(2.0 * RATE_HZ)
    walking = np.convolve(moving**2, window, "same") > 0.8**2
    edges = np.flatnonzero(np.diff(np.concatenate([[False], walking, [False]]).astype(int)))
    if not len(edges):
        return slice(0, 0)
    starts, ends = edges[::2], edges[1::2]
    longest = int(np.argmax(ends - starts))
    return slice(int(starts[longest] + 3.0 * RATE_HZ), max(int(ends[longest] - RATE_HZ), int(starts[longest] + 300)))


def spectrum(signal: Array) -> tuple[Array, Array]:
    """Compute frequencies and power density, summed over the axes."""
    frequency, power = welch(signal, fs=RATE_HZ, nperseg=1000, axis=0, detrend="constant")
    return frequency, power if power.ndim == 1 else power.sum(axis=1)


def magnitude(vectors: Array) -> Array:
    """Compute the lengths (n,) of vectors (n, 3)."""
    lengths: Array = np.linalg.norm(vectors, axis=1)
    return lengths


def draw(axes: Array, mode: str, kinds: dict[str, list[Walk]]) -> None:
    """Draw one row: vertical acceleration, its spectrum, that of the rotation rate, tilt of gravity."""
    signal, vertical, rotation, tilt = axes
    for kind, walks in kinds.items():
        typical = sorted(walks, key=lambda walk: float(walk.vertical_mps2.std()))[len(walks) // 2]
        shown = typical.vertical_mps2[: int(SHOWN_S * RATE_HZ)]
        signal.plot(np.arange(len(shown)) / RATE_HZ, shown, color=COLOURS[kind], lw=1.0, label=kind)
        for axis, values in ((vertical, "vertical_mps2"), (rotation, "rotation_radps")):
            spectra = [spectrum(getattr(walk, values)) for walk in walks]
            strides = np.linspace(0.3, 14.0, 400)
            curves = [
                np.interp(strides, frequency / (0.5 * walk.cadence_hz), power)
                for walk, (frequency, power) in zip(walks, spectra, strict=True)
            ]
            low, middle, high = np.percentile(curves, [10, 50, 90], axis=0)
            axis.fill_between(strides, low, high, color=COLOURS[kind], alpha=0.25, lw=0)
            axis.semilogy(strides, middle, color=COLOURS[kind], lw=1.2, label=kind)
            axis.set_xlabel("frequency / stride frequency")
        for walk in walks:
            shares = np.linspace(0.0, 1.0, 100)
            tilt.plot(np.quantile(walk.tilt_deg, shares), shares, color=COLOURS[kind], lw=0.7)
    signal.set(title=f"{mode}: vertical acceleration, m/s²", xlabel="time, s")
    vertical.set(title="its spectrum, (m/s²)²/Hz", ylim=(1e-3, None))
    rotation.set(title="rotation rate, (rad/s)²/Hz", ylim=(1e-5, None))
    tilt.set(title="gravity off its mean direction", xlabel="at most, degrees", ylabel="share of time")
    signal.legend(loc="upper right")


def table(kinds: dict[str, dict[str, list[Walk]]]) -> str:
    """Tabulate medians over the walks of each mode, with the 10th and 90th percentile."""
    measures = {
        "cadence, Hz": lambda walk: walk.cadence_hz,
        "vertical, 1st percentile, m/s2": lambda walk: np.percentile(walk.vertical_mps2, 1),
        "vertical, 99th percentile, m/s2": lambda walk: np.percentile(walk.vertical_mps2, 99),
        "rotation, rms, rad/s": lambda walk: np.sqrt((walk.rotation_radps**2).sum(axis=1).mean()),
        "rotation, 99th percentile, rad/s": lambda walk: np.percentile(
            np.linalg.norm(walk.rotation_radps, axis=1), 99
        ),
        "gravity off its mean, 95th percentile, deg": lambda walk: np.percentile(walk.tilt_deg, 95),
        "turn about the mean vertical by swing, deg/s": lambda walk: walk.swing_turn_degps,
        "forward once a stride, m/s2": lambda walk: walk.arm[0],
        "forward twice over once a stride": lambda walk: walk.arm[1],
        "vertical twice a stride, m/s2": lambda walk: walk.arm[2],
        "share of a turn about the mean vertical": lambda walk: walk.kept_turn,
        "MMPDR's steps over those of `auto`": lambda walk: walk.mmpdr_count,
        "gravity on x, share": lambda walk: abs(walk.up[0]),
        "gravity on y, share": lambda walk: abs(walk.up[1]),
        "gravity on z, share": lambda walk: abs(walk.up[2]),
    }
    return table_beside_real(kinds, measures, "walks")


if __name__ == "__main__":
    main()
