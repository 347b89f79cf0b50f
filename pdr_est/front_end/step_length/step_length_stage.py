"""The stage that gives each step its length and the standard deviation of it."""

from collections.abc import Callable, Sequence
from dataclasses import field
from functools import partial
from typing import Annotated, Any, Literal, get_args

import numpy as np
from annotated_types import Gt, Le

from pdr_est.frames import Array
from pdr_est.front_end.step_length import equations
from pdr_est.front_end.step_length.cadence import Pace, PaceMeter
from pdr_est.front_end.step_length.harmonic_model import (
    LEAST_SAMPLES,
    HarmonicParams,
    StepShape,
    TurnMeter,
    length_of_features_m,
    shape_features,
    step_shapes,
    walked_part,
)
from pdr_est.front_end.step_length.length_mixture import mixture_mean_and_sigma
from pdr_est.front_end.step_length.stairs import StairParams
from pdr_est.front_end.step_length.walk_run_model import (
    RunningParams,
    running_length_m,
    share_of_running,
    walking_length_m,
)
from pdr_est.front_end.step_length.walker import WalkerParams
from pdr_est.params import Positive, params
from pdr_est.parts import PartName
from pdr_est.records import changed
from pdr_est.types.steps import Step

LengthModel = Literal[
    "auto", "harmonic", "walk-run", "range-power", "static", "weinberg", "scarlett", "mmpdr", "gait-table", "kim"
]
LENGTH_MODELS: tuple[LengthModel, ...] = get_args(LengthModel)
LAW_OF_AUTO: LengthModel = "harmonic"
"""Name of the law of step length that the model "auto" stands for. What was learnt with one law fits no other."""

_AT_ONCE = 1024  # steps whose samples are looked at together, which bounds the memory
_LEAST_MEANS = 4  # least number of running means within a step for a range


@params
class StepLengthParams:
    """Choose the step-length model; with its constants and standard deviations."""

    model: Annotated[str, PartName(LENGTH_MODELS)] = "auto"
    """Name of the model; "auto" is "harmonic", the best one on people and phones that it was not fitted on."""
    parameters: dict[str, Any] = field(default_factory=dict, hash=False)
    """Arguments of a step-length stage of your own, which `model` names as module:attribute."""
    weinberg_k2: Positive = 0.48
    """Constant of MMPDR's eq. 3, m / (m/s^2)^(1/4); tuned, as the paper gives no value."""
    scarlett_k3: Positive = 0.60
    """Constant of MMPDR's eq. 4, m / (m/s^2)^(1/3); tuned, as the paper gives no value."""
    kim_k: Positive = equations.KIM_K
    """Constant of Kim et al. (2004), m / (m/s^2)^(1/3)."""
    harmonic: HarmonicParams = HarmonicParams()
    """Constants of "harmonic"."""
    range_power_k: Positive = 0.55
    """Constant of "range-power", and of walking in "walk-run", m / (m/s^2)^exponent; ours."""
    range_power_exponent: Annotated[float, Gt(0.0), Le(1.0)] = 0.15
    """Exponent of "range-power", and of walking in "walk-run"; ours."""
    smoothing_s: Positive = 0.24
    """Window of the running mean, s, before the extremes and the mean are taken; ours."""
    running: RunningParams = RunningParams()
    """Parameters of running steps in "walk-run"."""
    stairs: StairParams = StairParams()
    """Length of steps on stairs, with "auto" and "harmonic"; for estimators that use the whole walk."""
    sigma_walking: Positive = 0.07
    """Standard deviation of a walking step over its length, taken for independent from step to step; ours."""
    sigma_running: Positive = 0.20
    """Standard deviation of a running step over its length, taken for independent from step to step; ours."""


def length_law(parameters: StepLengthParams) -> str:
    """Return the name of the model, and for "auto" that of the law that it stands for."""
    return LAW_OF_AUTO if parameters.model == "auto" else parameters.model


class StepLength:
    """Stage Step -> Step that fills in the length and its standard deviation.

    Both are those of a mixture of a walking and a running step with the probabilities of the gait classifier, as far
    as the cadence allows for running (`share_of_running`). In published models the two have the same length, and in
    `harmonic` as well, if the step is not shorter than any of a walker (`walked_part`).

    The standard deviation is that of one step by itself, and users take the steps of a walk for independent. It is
    too small for an error that all of them share: constants that do not fit the walker, or somebody who is in doubt
    between walking and running all along. `odometry.sigma_length_scale` stands for that, as found on walkers. A
    runner's scale is less certain than it says, by an unknown amount: only two runners at one speed, and one in a
    small room, are known with their distance.

    A step that had begun before the recording, or its segment, counts for the part that was recorded, with the
    standard deviation of a whole one.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the level samples.
    walker : WalkerParams
        Body and personal constants.
    parameters : StepLengthParams
        Model and constants.
    """

    latency_s = 0.0

    def __init__(self, rate_hz: float, walker: WalkerParams, parameters: StepLengthParams) -> None:
        self._walker = walker
        self._parameters = parameters
        self._law = length_law(parameters)
        self._window = max(round(parameters.smoothing_s * rate_hz), 1)
        self._pace = PaceMeter()
        self._turn = TurnMeter()

    def push(self, item: Step, /) -> list[Step]:
        """Give a step its length."""
        return self.push_all([item])

    def push_all(self, items: Sequence[Step], /) -> list[Step]:
        """Give steps their length."""
        found: list[Step] = []
        for begin in range(0, len(items), _AT_ONCE):
            steps = items[begin : begin + _AT_ONCE]
            found += [self._with_length(step, shape) for step, shape in zip(steps, step_shapes(steps), strict=True)]
        return found

    def _with_length(self, step: Step, shape: StepShape) -> Step:
        pace = self._pace.at(step)
        turn_rad = self._turn.after(step, shape.turn_rate_radps)
        walking_m, running_m = self._lengths_m(step, pace, turn_rad, shape)
        mean_m, sigma_m = mixture_mean_and_sigma(
            share_of_running(step, pace.cadence_hz),
            (walking_m, self._parameters.sigma_walking * walking_m),
            (running_m, self._parameters.sigma_running * running_m),
        )
        factor = self._walker.personal_factor(pace.cadence_hz)
        length_m = factor * mean_m * step.recorded_share
        return changed(step, length_m=length_m, sigma_length_m=factor * sigma_m)

    def flush(self) -> list[Step]:
        """Return nothing: no step is held back."""
        return []

    def _lengths_m(self, step: Step, pace: Pace, turn_rad: float, shape: StepShape) -> tuple[float, float]:
        """Compute the lengths of this step if it is a walking one and if it is a running one."""
        p, height_m = self._parameters, self._walker.height_m
        if self._law == "harmonic":
            length_m = self._harmonic_length_m(step, turn_rad, shape)
            return walked_part(p.harmonic, step.event.time_s - step.start_s) * length_m, length_m
        if self._law != "walk-run":
            length_m = self._published_length_m(step)
            return length_m, length_m
        walking_m = self._length_from_acceleration(
            step, lambda vertical: walking_length_m(p.range_power_k, p.range_power_exponent, height_m, vertical)
        )
        # Doubt about the gait must not shorten a gentle walk: a running step is never shorter than a walking one.
        return walking_m, max(walking_m, running_length_m(p.running, height_m, pace))

    def _harmonic_length_m(self, step: Step, turn_rad: float, shape: StepShape) -> float:
        """Apply our law; a step too short to show its shape takes eq. 2."""
        if len(step.samples.time_s) < LEAST_SAMPLES:
            return self._static_length_m()
        features = shape_features(step.event.time_s - step.start_s, shape)
        return length_of_features_m(self._parameters.harmonic, self._walker.height_m, turn_rad, features)

    def _published_length_m(self, step: Step) -> float:
        p, walker = self._parameters, self._walker
        match p.model:
            case "mmpdr":
                return equations.mmpdr_length_m(walker.height_m, walker.gender, step.frequency_hz)
            case "gait-table":
                return equations.gait_table_length_m(step.gait)
            case "kim":
                return equations.kim_length_m(p.kim_k, step.samples.vertical_mps2)
            case "weinberg":
                return self._length_from_acceleration(step, partial(equations.weinberg_length_m, p.weinberg_k2))
            case "scarlett":
                return self._length_from_acceleration(step, partial(equations.scarlett_length_m, p.scarlett_k3))
            case "range-power":
                model = partial(equations.range_power_length_m, p.range_power_k, p.range_power_exponent)
                return self._length_from_acceleration(step, model)
        return self._static_length_m()

    def _static_length_m(self) -> float:
        return equations.static_length_m(self._walker.height_m, self._walker.gender)

    def _length_from_acceleration(self, step: Step, model: Callable[[Array], float]) -> float:
        """Apply a model to the smoothed vertical acceleration; a step too short to show its range takes eq. 2."""
        if len(step.samples) < self._window + _LEAST_MEANS:
            return self._static_length_m()
        return model(windowed_mean(step.samples.vertical_mps2, self._window))


def windowed_mean(samples: Array, window: int) -> Array:
    """Average `window` consecutive samples; a signal shorter than that gives its overall mean."""
    width = min(window, len(samples))
    total = np.cumsum(np.concatenate([[0.0], samples]))
    mean: Array = (total[width:] - total[:-width]) / width
    return mean
