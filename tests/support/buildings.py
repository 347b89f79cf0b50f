"""People in buildings with several floors, and the air pressure that a phone on them records."""

from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.height import HeightParams
from pdr_est.simulate.sensors.sensor_errors import air_pressure_pa
from pdr_est.types.recording import Signal

_SAMPLE_S = 0.1
_TREAD_M = 0.17


@dataclass(frozen=True)
class Visit:
    """A walk through a building: times (n,), true heights (n,) and floors (n,), and times of the steps (k,)."""

    time_s: Array
    height_m: Array
    floor: Array
    step_time_s: Array


class _Walker:
    """Somebody whose way is put together piece by piece."""

    def __init__(self, rng: np.random.Generator, storey_m: float) -> None:
        self.rng, self.storey_m = rng, storey_m
        self.heights: list[float] = [0.0]
        self.steps: list[float] = []

    @property
    def now_s(self) -> float:
        return len(self.heights) * _SAMPLE_S

    def stay(self, duration_s: float) -> None:
        if self.rng.random() < 0.8:
            self.steps.extend(np.arange(self.now_s, self.now_s + duration_s, 0.55))
        self.heights.extend([self.heights[-1]] * int(duration_s / _SAMPLE_S))

    def climb(self, storeys: int) -> None:
        speed, landing_s = self.rng.uniform(0.24, 0.36), self.rng.choice([0.0, 3.0])
        duration_s = abs(storeys) * self.storey_m / speed
        begin_s = self.now_s
        rise = np.linspace(0.0, storeys * self.storey_m, int(duration_s / _SAMPLE_S))
        middle = len(rise) // 2
        landing = np.full(int(landing_s / _SAMPLE_S), rise[middle])
        self.heights.extend(self.heights[-1] + np.concatenate([rise[:middle], landing, rise[middle:]]))
        self.steps.extend(np.arange(begin_s, self.now_s, _TREAD_M / speed))

    def take_the_lift(self, storeys: int) -> None:
        rise_m, top = storeys * self.storey_m, self.rng.uniform(0.8, 2.0)
        duration_s = abs(rise_m) / top + top  # accelerates and brakes by 1 m/s²
        share = np.linspace(0.0, 1.0, int(duration_s / _SAMPLE_S))
        self.heights.extend(self.heights[-1] + rise_m * (share - np.sin(2.0 * np.pi * share) / (2.0 * np.pi)))


def visit(seed: int, minutes: float, flat: bool = False) -> Visit:
    """Somebody walks and stands on floors, and changes them by stairs and lift, unless it is flat."""
    rng = np.random.default_rng(seed)
    walker = _Walker(rng, rng.uniform(3.0, 4.6))
    walker.stay(rng.uniform(20.0, 90.0))
    while walker.now_s < 60.0 * minutes:
        if not flat:
            up = int(rng.choice([-1, 1]))
            if rng.random() < 0.6:
                walker.climb(up)
            else:
                walker.take_the_lift(up * int(rng.integers(1, 4)))
        walker.stay(rng.uniform(20.0, 200.0))
    height_m = np.array(walker.heights)
    floor = np.rint(height_m / walker.storey_m).astype(int)
    return Visit(_SAMPLE_S * np.arange(len(height_m)), height_m, floor, np.array(walker.steps))


def pressure_of(walk: Visit, seed: int, pressed: bool = False) -> Signal:
    """The pressure with noise, weather of up to 1.5 hPa an hour, doors, and legs that press the pocket."""
    rng = np.random.default_rng([seed, 1])
    count, end_s = len(walk.time_s), float(walk.time_s[-1])
    value = air_pressure_pa(walk.height_m)[:, 0] + rng.normal(0.0, 1.5, count)
    value += np.cumsum(rng.normal(0.0, 0.3 * np.sqrt(_SAMPLE_S), count))
    value += rng.uniform(-150.0, 150.0) * walk.time_s / 3600.0
    for begin_s in rng.uniform(0.0, end_s, rng.poisson(end_s / 300.0)):
        value[walk.time_s > begin_s] += rng.normal(0.0, 4.0)
    for begin_s in rng.uniform(0.0, end_s, rng.poisson(end_s / 60.0) if pressed else 0):
        end = begin_s + rng.uniform(0.5, 4.0)
        value[(walk.time_s > begin_s) & (walk.time_s < end)] += rng.normal(0.0, 8.0)
    return Signal(walk.time_s, value[:, None])


def pressure_as_claimed(walk: Visit, seed: int, parameters: HeightParams | None = None) -> Signal:
    """The pressure with the noise, random walk and jumps that the parameters claim, drawn at random."""
    claimed, rng = parameters or HeightParams(), np.random.default_rng([seed, 2])
    count = len(walk.time_s)
    height_m = walk.height_m + rng.normal(0.0, claimed.sigma_height_m / np.sqrt(_SAMPLE_S), count)
    height_m = height_m + np.cumsum(rng.normal(0.0, claimed.drift_m_per_sqrt_s * np.sqrt(_SAMPLE_S), count))
    jumps = ((claimed.jumps, claimed.sigma_jump_m), (claimed.great_jumps, claimed.sigma_great_jump_m))
    for share, sigma_m in jumps:
        jumping = rng.random(count) < share * _SAMPLE_S
        height_m = height_m + np.cumsum(np.where(jumping, rng.normal(0.0, sigma_m, count), 0.0))
    return Signal(walk.time_s, air_pressure_pa(height_m))
