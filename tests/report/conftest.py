"""Synthetic finished walks: a loop of about 150 m, with uncertainty that grows and shrinks again at the end."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from pdr_est.pipeline import DeviceWalk, SmoothedWalk
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, Recording, Signal
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, Step, StepEvent
from pdr_est.types.track import Track

STEP_S = 0.52
STEP_M = 0.62
RATE_HZ = 50.0
CORNERS_M = np.array([[0.0, 0.0], [50.0, 0.0], [50.0, 25.0], [22.0, 33.0], [0.0, 25.0], [0.0, 0.0]])

MakeWalk = Callable[..., tuple[SmoothedWalk, Recording]]


def loop(way_m: np.ndarray) -> np.ndarray:
    """Points of the loop at some distances from its start, round and round."""
    legs = np.linalg.norm(np.diff(CORNERS_M, axis=0), axis=1)
    at = np.concatenate([[0.0], np.cumsum(legs)])
    return np.column_stack([np.interp(way_m % at[-1], at, CORNERS_M[:, axis]) for axis in (0, 1)])


def make_track(device: str, steps: int, rng: np.random.Generator) -> Track:
    n = steps + 1
    number = np.arange(n)
    share = number / max(steps, 1)
    position = loop(STEP_M * number) + 0.15 * np.column_stack([np.sin(number / 9), np.cos(number / 7)])
    legs = np.diff(position, axis=0, prepend=position[:1] - [[STEP_M, 0.0]])
    sigma = 0.3 + 3.2 * np.sin(np.pi * share)
    turn = np.arctan2(legs[:, 1], legs[:, 0])
    c, s = np.cos(turn), np.sin(turn)
    rotation = np.stack([np.stack([c, -s], -1), np.stack([s, c], -1)], -2)
    axes = np.stack([(0.45 * sigma) ** 2, sigma**2], -1)
    covariance = np.einsum("nij,nj,nkj->nik", rotation, axes, rotation)
    return Track(
        time_s=3.0 + STEP_S * number,
        moving_from_s=3.0 + STEP_S * (number - 1),
        device=np.repeat(device, n),
        position_m=position,
        heading_rad=turn + 0.03 * rng.standard_normal(n),
        covariance_m2=covariance,
        sigma_heading_rad=0.05 + 0.2 * np.sin(np.pi * share),
        mode=np.full(n, CarryingMode.HOLDING, dtype=np.int8),
        step_length_m=np.where(number > 0, STEP_M + 0.03 * rng.standard_normal(n), 0.0),
        kind="smoothed",
        estimator="factor-graph",
        length_scale=1.034,
        sigma_length_scale=0.012,
    )


def make_level(track: Track, rng: np.random.Generator) -> LevelBlock:
    time = np.arange(0.0, track.time_s[-1] + 3.0, 1.0 / RATE_HZ)
    n = len(time)
    walking = (time > 3.0) & (time < track.time_s[-1] + 0.2)
    phase = 2 * np.pi * (time - 3.0) / STEP_S
    vertical = walking * (2.4 * np.cos(phase) + 0.8 * np.cos(2 * phase + 1.0)) + 0.15 * rng.standard_normal(n)
    flat = np.zeros((n, 3))
    return LevelBlock(
        0, 0, time, flat, flat, vertical, np.zeros(n), flat, np.zeros(n), np.ones(n, dtype=np.int8), np.ones(n)
    )


def make_device(track: Track, rng: np.random.Generator) -> DeviceWalk:
    level = make_level(track, rng)
    nothing = {name: value[:0] for name, value in vars(level).items() if isinstance(value, np.ndarray)}
    empty = replace(level, **nothing)
    steps = [
        Step(
            StepEvent(int(25 * time), float(time), 0, CarryingMode.HOLDING),
            float(time - STEP_S),
            0.0 if number == 0 else float((1.0 + 0.03 * rng.standard_normal()) / STEP_S),
            empty,
            STEP_M,
            0.0,
        )
        for number, time in enumerate(track.time_s[1:])
    ]
    return DeviceWalk(str(track.device[0]), 0.0, (level,), tuple(steps), ())


def join(tracks: list[Track]) -> Track:
    arrays = {
        name: np.concatenate([getattr(track, name) for track in tracks])
        for name, value in vars(tracks[0]).items()
        if isinstance(value, np.ndarray)
    }
    return replace(tracks[0], **arrays)


@pytest.fixture
def make_walk() -> MakeWalk:
    """(SmoothedWalk, Recording) of some devices and steps."""

    def make(steps: int = 250, devices: tuple[str, ...] = ("phone",), with_truth: bool = True) -> tuple:
        rng = np.random.default_rng(5)
        tracks = [make_track(name, steps, rng) for name in devices]
        tracks = [replace(track, position_m=track.position_m + 0.6 * number) for number, track in enumerate(tracks)]
        walks = tuple(make_device(track, rng) for track in tracks)
        way = np.linspace(0.0, STEP_M * steps, 16)
        places = loop(way) + 0.3 * rng.standard_normal((16, 2))
        times = 3.0 + STEP_S * way / STEP_M
        truth = Truth(TruePositions(times, places, 0.7, "waypoints")) if with_truth else Truth()
        fixes = tuple(
            PositionFix(float(time), place, 0.49 * np.eye(2))
            for time, place in zip(times[::5], places[::5], strict=True)
        )
        signals = tuple(
            DeviceRecording(
                name,
                model="Example 7",
                specific_force=Signal(walk.level[0].time_s, np.zeros((len(walk.level[0]), 3))),
                decisions=(
                    "acceleration in m/s^2: median norm 9.81",
                    "signs: Android, the phone lay face up at rest",
                ),
            )
            for name, walk in zip(devices, walks, strict=True)
        )
        walk = SmoothedWalk(
            join(tracks), walks, fixes if with_truth else (), {"attitude": 0.031, "factor-graph": 0.21}
        )
        return walk, Recording("morning loop", "sensor-logger", signals, truth, epoch_s=1_700_000_000.0)

    return make
