"""Settings that are in range one by one but do not go together."""

from collections.abc import Callable, Iterator
from functools import lru_cache
from math import degrees
from typing import Any

from pdr_est.config.records import PART_KEYS, Config
from pdr_est.errors import ConfigError
from pdr_est.estimators import EstimatorSpec
from pdr_est.front_end.gait import gait_model, gait_stage
from pdr_est.front_end.heading import heading_stage
from pdr_est.front_end.mode import mode_stage
from pdr_est.front_end.step_length import step_length_stage
from pdr_est.front_end.steps import StepsParams, step_detector
from pdr_est.params.validation_messages import Location
from pdr_est.parts import PartError, is_external

Contradiction = tuple[Location, str]
"""Place of a setting, and what is wrong with it, with the remedy."""


def first_contradiction(config: Config) -> Contradiction | None:
    """Find the first contradiction between the settings of a configuration; None if there is none."""
    return next((found for check in _CHECKS for found in check(config)), None)


def unused_closure(spec: EstimatorSpec) -> str | None:
    """Say that an estimator makes no use of `start.closed`; None if it does."""
    if spec.uses_closure:
        return None
    return (
        f"start.closed: {spec.name} makes no use of a walk that ends where it began: choose the estimator "
        "factor-graph or ekf"
    )


def _external_parts(config: Config) -> Iterator[Contradiction]:
    """Make each part from outside the package once; refuse parameters where the package's own part is chosen."""
    rate_hz = config.resample.rate_hz
    makers: dict[str, Callable[[], Any]] = {
        "mode": lambda: mode_stage(rate_hz, config.mode),
        "steps": lambda: step_detector(rate_hz, config.steps),
        "gait": lambda: gait_stage(rate_hz, config.gait),
        "step_length": lambda: step_length_stage(rate_hz, config.walker, config.step_length),
        "heading": lambda: heading_stage(rate_hz, config.heading),
        "estimator": config.estimator.make,
    }
    for section, key in PART_KEYS.items():
        parameters = getattr(config, section)
        name = getattr(parameters, key)
        if is_external(name):
            try:
                makers[section]()
            except PartError as error:
                yield (section, *(error.below or (key,))), str(error)
        elif parameters.parameters:
            words = f"{section}.parameters: are for a part of your own, and {section}.{key} = {name} is none: leave "
            yield (section, "parameters"), f"{words}them out"


def _closed(config: Config) -> Iterator[Contradiction]:
    words = unused_closure(config.estimator.make().spec) if config.start.closed else None
    if words is not None:
        yield ("start", "closed"), words


def _detector(config: Config) -> Iterator[Contradiction]:
    if not is_external(config.steps.detector):
        section = config.steps.detector.replace("-", "_")
        words = _fault_of_detector(config.resample.rate_hz, config.steps)
        if words is not None:
            yield ("steps", section), f"steps.{section}: {words}"


@lru_cache(maxsize=256)
def _fault_of_detector(rate_hz: float, steps: StepsParams) -> str | None:
    """Make a detector of the package once; a configuration is copied many times with the same one."""
    try:
        step_detector(rate_hz, steps)
    except ConfigError as error:
        return str(error)
    return None


def _transition(config: Config) -> Iterator[Contradiction]:
    watched_s, compensated_s = config.mode.mmpdr.window_s, config.steps.mmpdr.transition_s
    if config.mode.method == config.steps.detector == "mmpdr" and watched_s != compensated_s:
        yield (
            ("mode", "mmpdr", "window_s"),
            f"mode.mmpdr.window_s = {watched_s:g} and steps.mmpdr.transition_s = {compensated_s:g} are both "
            "the length of a transition: give them one value",
        )


def _clocks(config: Config) -> Iterator[Contradiction]:
    if config.devices.clocks and config.devices.clock != "given":
        yield (
            ("devices", "clocks"),
            f"devices.clocks: devices.clock = {config.devices.clock} makes no use of clocks that are given: choose "
            "given (--clock given), or leave them out",
        )


def _direction(config: Config) -> Iterator[Contradiction]:
    heading = config.heading
    gives_priors = heading.method == "auto" and heading.dominant.enabled and heading.use == "priors"
    if heading.dominant.direction_rad is not None and not gives_priors:
        yield (
            ("heading", "dominant", "direction_rad"),
            f"heading.dominant.direction_rad = {heading.dominant.direction_rad:g} (--corridors "
            f"{degrees(heading.dominant.direction_rad):g}): is a direction in the map, of which heading.method = "
            f"{heading.method} (--heading-method) with heading.use = {heading.use} and heading.dominant.enabled = "
            f"{str(heading.dominant.enabled).lower()} makes no use: choose auto, priors and true, or leave it out",
        )


def _gait_model(config: Config) -> Iterator[Contradiction]:
    if config.gait.model is not None:
        try:
            gait_model(config.gait)
        except ConfigError as error:
            yield ("gait", "model"), f"gait.model: {error}"


_CHECKS: tuple[Callable[[Config], Iterator[Contradiction]], ...] = (
    _external_parts,
    _closed,
    _detector,
    _transition,
    _clocks,
    _direction,
    _gait_model,
)
