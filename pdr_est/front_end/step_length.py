"""Length of a step: the models that MMPDR (Tian et al. 2016) uses and compares, eqs. 2, 3, 4 and 9, and a better one.

`range-power` is eq. 3 with a free exponent. Across phones and people the range of the vertical acceleration varies
far more than the step length, so a smaller exponent than 1/4 carries over better from one data set to the next.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Annotated, Literal

import numpy as np
from annotated_types import Ge, Gt, Le

from pdr_est.frames import Array
from pdr_est.params import Positive, params
from pdr_est.records import Step

Gender = Literal["male", "female"]
LengthModel = Literal["static", "weinberg", "scarlett", "mmpdr", "range-power"]

STATIC_K1 = {"male": 0.415, "female": 0.413}  # eq. 2
MMPDR_K = {"male": 0.3139, "female": 0.2975}  # eq. 9


Height = Annotated[float, Ge(0.5), Le(2.6)]  # of a small child and of the tallest; refuses centimetres and feet

_LEAST_MEANS = 4  # means of the sliding window within a step, for a range


@params
class WalkerParams:
    """Who walks. The defaults are those of the paper's application."""

    height_m: Height = 1.73
    gender: Gender = "male"


@params
class StepLengthParams:
    """model: which equation. weinberg_k2 and scarlett_k3: the tuned constants of eqs. 3 and 4, for which the paper
    gives no value; in m / (m/s^2)^(1/4) and m / (m/s^2)^(1/3). range_power_k, range_power_exponent: of
    `range-power`. smoothing_s: running mean before the extremes and the mean are taken."""

    model: LengthModel = "range-power"
    weinberg_k2: Positive = 0.48
    scarlett_k3: Positive = 0.60
    range_power_k: Positive = 0.55
    range_power_exponent: Annotated[float, Gt(0.0), Le(1.0)] = 0.15
    smoothing_s: Positive = 0.24


class StepLength:
    """Stage Step -> Step that fills in the length."""

    latency_s = 0.0

    def __init__(self, rate_hz: float, walker: WalkerParams, parameters: StepLengthParams) -> None:
        self._walker = walker
        self._parameters = parameters
        self._window = max(round(parameters.smoothing_s * rate_hz), 1)
        self._models: dict[LengthModel, Callable[[Step], float]] = {
            "static": self._static,
            "weinberg": self._weinberg,
            "scarlett": self._scarlett,
            "mmpdr": self._mmpdr,
            "range-power": self._range_power,
        }

    def push(self, item: Step, /) -> list[Step]:
        return [replace(item, length_m=self._models[self._parameters.model](item))]

    def flush(self) -> list[Step]:
        return []

    def _static(self, step: Step) -> float:
        return static_length_m(self._walker)

    def _mmpdr(self, step: Step) -> float:
        return mmpdr_length_m(self._walker, step.frequency_hz)

    def _weinberg(self, step: Step) -> float:
        return self._by_acceleration(step, partial(weinberg_length_m, self._parameters.weinberg_k2))

    def _scarlett(self, step: Step) -> float:
        return self._by_acceleration(step, partial(scarlett_length_m, self._parameters.scarlett_k3))

    def _range_power(self, step: Step) -> float:
        p = self._parameters
        return self._by_acceleration(step, partial(range_power_length_m, p.range_power_k, p.range_power_exponent))

    def _by_acceleration(self, step: Step, model: Callable[[Array], float]) -> float:
        """A model on the smoothed vertical acceleration; a step cut too short to show its range takes eq. 2."""
        if len(step.samples) < self._window + _LEAST_MEANS:
            return static_length_m(self._walker)
        return model(running_mean(step.samples.vertical_mps2, self._window))


def static_length_m(walker: WalkerParams) -> float:
    """MMPDR eq. 2: a constant share of the height."""
    return STATIC_K1[walker.gender] * walker.height_m


def weinberg_length_m(k2: float, vertical_mps2: Array) -> float:
    """MMPDR eq. 3: fourth root of the range of the vertical acceleration (n,) within the step."""
    return float(k2 * np.ptp(vertical_mps2) ** 0.25)


def range_power_length_m(k: float, exponent: float, vertical_mps2: Array) -> float:
    """MMPDR eq. 3 with a free exponent."""
    return float(k * np.ptp(vertical_mps2) ** exponent)


def scarlett_length_m(k3: float, vertical_mps2: Array) -> float:
    """MMPDR eq. 4: cube root of the mean absolute vertical acceleration (n,) within the step."""
    return float(k3 * np.mean(np.abs(vertical_mps2)) ** (1.0 / 3.0))


def mmpdr_length_m(walker: WalkerParams, frequency_hz: float) -> float:
    """MMPDR eq. 9; a first step, whose frequency is 0, takes eq. 2 (section III-D)."""
    if frequency_hz == 0.0:
        return static_length_m(walker)
    return float(MMPDR_K[walker.gender] * walker.height_m * np.sqrt(frequency_hz))


def running_mean(samples: Array, window: int) -> Array:
    """Mean over `window` consecutive samples; shorter signals give their overall mean."""
    width = min(window, len(samples))
    total = np.cumsum(np.concatenate([[0.0], samples]))
    mean: Array = (total[width:] - total[:-width]) / width
    return mean
