"""What a benchmark compares: configurations that differ in one setting."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from pdr_est.config import Config, EstimatorParams, config_to_dict, config_with
from pdr_est.errors import ConfigError
from pdr_est.estimators import ESTIMATORS
from pdr_est.front_end.heading import HEADINGS
from pdr_est.front_end.step_length import LENGTH_MODELS
from pdr_est.front_end.steps import DETECTORS

EVERY = "all"


@dataclass(frozen=True)
class Axis:
    """A setting whose values can be compared. word: its name in options, tables and documents. names: its values.
    section, key: where it stands in the configuration."""

    word: str
    names: tuple[str, ...]
    section: str
    key: str

    def of(self, config: Config) -> str:
        """The value in a configuration."""
        return str(config_to_dict(config)[self.section][self.key])

    def chosen(self, config: Config, name: str) -> Config:
        """The configuration with this value. Raises ConfigError for a value that is unknown or contradicts others."""
        return config_with(config, {f"{self.section}.{self.key}": name}, f"--{self.word}")


AXES: tuple[Axis, ...] = (
    Axis("estimator", ESTIMATORS, "estimator", "name"),
    Axis("detector", DETECTORS, "steps", "detector"),
    Axis("length-model", LENGTH_MODELS, "step_length", "model"),
    Axis("heading", HEADINGS, "heading", "method"),
)


@dataclass(frozen=True)
class Variant:
    """One configuration under comparison. name: its value on the axis of the comparison."""

    name: str
    config: Config

    def settings(self) -> dict[str, str]:
        """Its value on every axis, by the axis' word."""
        return {axis.word: axis.of(self.config) for axis in AXES}


@dataclass(frozen=True)
class Comparison:
    """Variants that differ on one axis. main: the one of them that the plain summary is of."""

    axis: str
    variants: tuple[Variant, ...]
    main: Variant

    @property
    def names(self) -> tuple[str, ...]:
        """The values that are compared."""
        return tuple(variant.name for variant in self.variants)


def compare(config: Config, word: str = "estimator", names: Sequence[str] | None = None) -> Comparison:
    """Variants of a configuration on the axis of that word: the configured one alone, or one for each name.

    Raises ConfigError for an unknown axis, for no name or an unknown one.
    """
    axis = axis_named(word)
    configured = axis.of(config)
    wanted = (configured,) if names is None else tuple(names)
    if not wanted:
        raise ConfigError(f"no {word} to compare: name at least one")
    variants = tuple(Variant(name, axis.chosen(config, name)) for name in wanted)
    main = next((variant for variant in variants if variant.name == configured), variants[0])
    return Comparison(word, variants, main)


def comparison_of_choices(config: Config, choices: Mapping[str, str | None]) -> Comparison:
    """What the values given for some axes ask for. choices: by the axis' word, None for what is configured, or "all".

    Raises ConfigError when more than one is "all", and as `compare` does.
    """
    every = [axis for axis in AXES if choices.get(axis.word) == EVERY]
    if len(every) > 1:
        words = " and ".join(f"--{axis.word} {EVERY}" for axis in every)
        raise ConfigError(f"{words}: only one setting is compared at a time: name one value of the other")
    compared = every[0] if every else AXES[0]
    for axis in AXES:
        name = choices.get(axis.word)
        if name is not None and axis not in every:
            config = axis.chosen(config, name)
            compared = compared if every else axis
    return compare(config, compared.word, compared.names if every else None)


def same_front_end(a: Config, b: Config) -> bool:
    """Whether two configurations differ in nothing but the estimator, so that one analysis serves both."""
    return replace(a, estimator=EstimatorParams()) == replace(b, estimator=EstimatorParams())


def axis_named(word: str) -> Axis:
    """The axis of that word. Raises ConfigError that lists the known ones."""
    for axis in AXES:
        if axis.word == word:
            return axis
    raise ConfigError(f"unknown axis {word!r}: choose one of {', '.join(axis.word for axis in AXES)}")
