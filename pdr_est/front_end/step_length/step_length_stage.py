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
    TurnMeter,
    lengths_of_features_m,
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
from pdr_est.records import changed_each
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
            found += self._with_lengths(items[begin : begin + _AT_ONCE])
        return found

    def _with_lengths(self, steps: Sequence[Step]) -> list[Step]:
        p, factor = self._parameters, self._walker.personal_factor
        paces = self._pace.at_each(steps)
        lengths_m = (
            self._harmonic_lengths_m(steps) if self._law == "harmonic" else self._other_lengths_m(steps, paces)
        )
        found_m, sigmas_m = [], []
        for step, pace, (walking_m, running_m) in zip(steps, paces, lengths_m, strict=True):
            share = share_of_running(step, pace.cadence_hz)
            walking, running = (walking_m, p.sigma_walking * walking_m), (running_m, p.sigma_running * running_m)
            mean_m, sigma_m = mixture_mean_and_sigma(share, walking, running)
            personal = factor(pace.cadence_hz)
            found_m.append(personal * mean_m * step.recorded_share)
            sigmas_m.append(personal * sigma_m)
        return changed_each(steps, length_m=found_m, sigma_length_m=sigmas_m)

    def flush(self) -> list[Step]:
        """Return nothing: no step is held back."""
        return []

    def _harmonic_lengths_m(self, steps: Sequence[Step]) -> list[tuple[float, float]]:
        """Apply our law to each step as a walking and a running one; one too short to show its shape takes eq. 2."""
        p, shapes = self._parameters.harmonic, step_shapes(steps)
        durations_s = [step.event.time_s - step.start_s for step in steps]
        turn_rad = self._turn.after_each(steps, shapes.turn_rate_radps.tolist())
        features = shape_features(np.array(durations_s), shapes)
        running_m = lengths_of_features_m(p, self._walker.height_m, np.array(turn_rad), features)
        short = [len(step.samples.time_s) < LEAST_SAMPLES for step in steps]
        running_m[short] = self._static_length_m()
        pairs = zip(durations_s, running_m.tolist(), strict=True)
        return [(walked_part(p, duration_s) * length_m, length_m) for duration_s, length_m in pairs]

    def _other_lengths_m(self, steps: Sequence[Step], paces: Sequence[Pace]) -> list[tuple[float, float]]:
        """Compute the lengths of each step by another model, if it is a walking one and if it is a running one."""
        p, height_m = self._parameters, self._walker.height_m
        if self._law != "walk-run":
            return [(length_m, length_m) for length_m in map(self._published_length_m, steps)]
        found = []
        for step, pace in zip(steps, paces, strict=True):
            walking_m = self._length_from_acceleration(
                step, lambda vertical: walking_length_m(p.range_power_k, p.range_power_exponent, height_m, vertical)
            )
            # Doubt about the gait must not shorten a gentle walk: a running step is never shorter than a walking one.
            found.append((walking_m, max(walking_m, running_length_m(p.running, height_m, pace))))
        return found

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
