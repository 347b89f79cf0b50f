"""Settings whose values a benchmark compares, and the variants that differ in one of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from pdr_est.config import Config, EstimatorParams, config_to_dict, config_with
from pdr_est.config.front_ends import FRONT_ENDS, front_end_of, with_front_end
from pdr_est.errors import ConfigError
from pdr_est.estimators import AUTO, ESTIMATORS, automatic_name
from pdr_est.front_end.heading import HEADINGS
from pdr_est.front_end.step_length import LENGTH_MODELS
from pdr_est.front_end.steps import DETECTORS

EVERY = "all"
TRACK_FILES = "track_files"
"""Key of a variant, in an experiment file, whose tracks are those of another program."""


class Axis(Protocol):
    """Something whose values can be compared.

    Attributes
    ----------
    name : str
        Name in options, tables and documents.
    values : tuple of str
        Values that it can have.
    """

    @property
    def name(self) -> str:
        """Return the name."""

    @property
    def values(self) -> tuple[str, ...]:
        """Return the values."""

    def value_in(self, config: Config) -> str:
        """Return the value in a configuration."""

    def with_value(self, config: Config, value: str) -> Config:
        """Return the configuration with this value.

        Raises
        ------
        ConfigError
            For a value that is unknown or contradicts other settings.
        """


@dataclass(frozen=True)
class SettingAxis:
    """A single setting.

    Attributes
    ----------
    name : str
        Name in options, tables and documents.
    values : tuple of str
        Values of the setting.
    section, key : str
        Place of the setting in the configuration.
    """

    name: str
    values: tuple[str, ...]
    section: str
    key: str

    def value_in(self, config: Config) -> str:
        """Return the value in a configuration."""
        return str(config_to_dict(config)[self.section][self.key])

    def with_value(self, config: Config, value: str) -> Config:
        """Return the configuration with this value."""
        return config_with(config, {f"{self.section}.{self.key}": value}, f"--{self.name}")


@dataclass(frozen=True)
class EstimatorAxis(SettingAxis):
    """The estimator. Where none is chosen, the value is that of walks without a floor plan."""

    def value_in(self, config: Config) -> str:
        """Return the name of the estimator of walks without a floor plan."""
        name = config.estimator.name
        return automatic_name(on_plan=False) if name == AUTO else name


@dataclass(frozen=True)
class FrontEndAxis:
    """The choice among the named front ends, which stands for several settings.

    Attributes
    ----------
    name : str
        Name in options, tables and documents.
    values : tuple of str
        Names of the front ends.
    """

    name: str = "front-end"
    values: tuple[str, ...] = tuple(FRONT_ENDS)

    def value_in(self, config: Config) -> str:
        """Return the name of the front end of a configuration."""
        return front_end_of(config)

    def with_value(self, config: Config, value: str) -> Config:
        """Return the configuration with this front end."""
        return with_front_end(config, value, f"--{self.name}")


AXES: tuple[Axis, ...] = (
    EstimatorAxis("estimator", ESTIMATORS, "estimator", "name"),
    SettingAxis("detector", DETECTORS, "steps", "detector"),
    SettingAxis("length-model", LENGTH_MODELS, "step_length", "model"),
    SettingAxis("heading", HEADINGS, "heading", "method"),
    FrontEndAxis(),
)


@dataclass(frozen=True)
class Variant:
    """One configuration under comparison.

    Attributes
    ----------
    name : str
        Name in the results; in a benchmark the value on the axis of the comparison.
    config : Config
        The settings.
    track_files : str or None
        Pattern of the files with the tracks of another program, which are scored in place of an estimator's; None
        for a variant that is estimated. `track_file` says what stands in it.
    """

    name: str
    config: Config
    track_files: str | None = None

    def track_file(self, walk: str) -> Path:
        """Return the file with the track of a walk; `{walk}` stands for its name, `{name}` for the end of it."""
        pattern = self.track_files or ""
        return Path(pattern.replace("{walk}", walk).replace("{name}", walk.rpartition("/")[2]))

    @property
    def automatic_on_plan(self) -> str | None:
        """Name of the estimator of walks on a floor plan where none is chosen; None where one is."""
        return automatic_name(on_plan=True) if self.config.estimator.name == AUTO else None

    def settings(self) -> dict[str, str]:
        """Return the value on every axis, by name of the axis."""
        return {axis.name: axis.value_in(self.config) for axis in AXES}


@dataclass(frozen=True)
class Comparison:
    """Variants that differ on one axis.

    Attributes
    ----------
    axis : str
        Name of the axis.
    variants : tuple of Variant
        The variants.
    main : Variant
        The one that the summary is computed for.
    """

    axis: str
    variants: tuple[Variant, ...]
    main: Variant

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the variants: the values that are compared."""
        return tuple(variant.name for variant in self.variants)


def comparison_on_axis(config: Config, axis: str = "estimator", values: Sequence[str] | None = None) -> Comparison:
    """Make the variants of a configuration on an axis: one for each value, or the configured one alone.

    Raises
    ------
    ConfigError
        For an unknown axis, for no value or an unknown one.
    """
    chosen = axis_named(axis)
    configured = chosen.value_in(config)
    if values is None:
        only = Variant(configured, config)  # with what stands open in the configuration, such as "auto"
        return Comparison(axis, (only,), only)
    wanted = tuple(values)
    if not wanted:
        raise ConfigError(f"no {axis} to compare: name at least one")
    variants = tuple(Variant(value, chosen.with_value(config, value)) for value in wanted)
    main = next((variant for variant in variants if variant.name == configured), variants[0])
    return Comparison(axis, variants, main)


def comparison_from_options(config: Config, options: Mapping[str, str | None]) -> Comparison:
    """Make the variants that command-line options ask for.

    Parameters
    ----------
    config : Config
        The configuration that the options change.
    options : Mapping
        Name of an axis -> its value, "all" for every value, None for the configured one.

    Raises
    ------
    ConfigError
        If more than one option is "all", and as `comparison_on_axis` does.
    """
    every = [axis for axis in AXES if options.get(axis.name) == EVERY]
    if len(every) > 1:
        words = " and ".join(f"--{axis.name} {EVERY}" for axis in every)
        raise ConfigError(f"{words}: only one setting is compared at a time: name one value of the other")
    compared = every[0] if every else AXES[0]
    for axis in AXES:
        value = options.get(axis.name)
        if value is not None and axis not in every:
            config = axis.with_value(config, value)
            compared = compared if every else axis
    return comparison_on_axis(config, compared.name, compared.values if every else None)


def same_front_end(a: Config, b: Config) -> bool:
    """Check if two configurations differ in nothing but the estimator, so that one analysis serves both."""
    return replace(a, estimator=EstimatorParams()) == replace(b, estimator=EstimatorParams())


def axis_named(name: str) -> Axis:
    """Return the axis of that name.

    Raises
    ------
    ConfigError
        For an unknown name; the message lists the known ones.
    """
    for axis in AXES:
        if axis.name == name:
            return axis
    raise ConfigError(f"unknown axis {name!r}: choose one of {', '.join(axis.name for axis in AXES)}")
