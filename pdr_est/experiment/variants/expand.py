"""Configurations from the settings, variants and sweeps of an experiment file."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from pdr_est.config import Config, config_from_dict, config_to_dict, load_config, merged
from pdr_est.config.yaml_lines import Lines, Location
from pdr_est.errors import ConfigError
from pdr_est.experiment.config import ExperimentConfig
from pdr_est.experiment.variants.axes import Variant

_FILE_KEY = "settings_file"
_CHOICES = ("name", "method", "detector", "model")  # keys whose value is a name that needs no key
_MOST_VARIANTS = 10_000


@dataclass(frozen=True)
class _Settings:
    """Sections of settings, and the line of each of their values."""

    values: Mapping[str, Any]
    lines: Mapping[Location, int]

    def over(self, below: "_Settings") -> "_Settings":
        return _Settings(merged(dict(below.values), dict(self.values)), {**below.lines, **self.lines})


def expand(config: ExperimentConfig, path: Path, lines: Lines) -> tuple[Variant, ...]:
    """Make the variants in the order of the file, with the combinations of the sweep inside each.

    Parameters
    ----------
    config : ExperimentConfig
        Sections of the file.
    path : Path
        The file.
    lines : Lines
        Line numbers of its values.

    Raises
    ------
    ConfigError
        For settings that are unknown, out of range or contradict each other, with their line, and for two variants of
        one name.
    """
    base = _from_file(config.settings_file, path, (_FILE_KEY,), lines, Config())
    shared = _sections(config.settings, path, ("settings",), lines)
    variants: dict[str, Variant] = {}
    for name, given in (config.variants or {"": None}).items():
        own = dict(given or {})
        place: Location = ("variants", name)
        start = _from_file(own.pop(_FILE_KEY, None), path, (*place, _FILE_KEY), lines, base)
        settings = _sections(own, path, place, lines).over(shared)
        for words, choice in _combinations(config.sweep, path, lines):
            full = " ".join(part for part in (name, *words) if part) or "default"
            if full in variants:
                swept = max(choice.lines.values(), default=None)
                words_of = lines.words(place) if swept is None else f"line {swept}: "
                raise ConfigError(f"{path}: {words_of}two variants are called {full!r}: rename one or leave it out")
            chosen = choice.over(settings)
            complete = merged(config_to_dict(start), dict(chosen.values))
            variants[full] = Variant(
                full, config_from_dict(complete, f"{path}, variant {full!r}", Lines(chosen.lines))
            )
    return tuple(variants.values())


def _from_file(file: Any, path: Path, place: Location, lines: Lines, base: Config) -> Config:
    """Read a settings file whose path is relative to the experiment file."""
    if file is None:
        return base
    if not isinstance(file, str) or not (path.parent / file).is_file():
        known = f"{path}: {lines.words(place)}settings_file = {file!r}"
        raise ConfigError(f"{known}: no such file beside the experiment: correct the path")
    return load_config(path.parent / file, base)


def _combinations(
    sweep: Mapping[str, tuple[Any, ...]], path: Path, lines: Lines
) -> Iterator[tuple[tuple[str, ...], _Settings]]:
    """Yield each combination of the values of the sweep: the words of its name, and its settings."""
    count = 1
    for key, values in sweep.items():
        count *= len(values)
        if not values or count > _MOST_VARIANTS:
            what = "no value to sweep over" if not values else f"more than {_MOST_VARIANTS} combinations"
            raise ConfigError(f"{path}: {lines.words(('sweep', key))}sweep {key}: {what}: change the list")
    for chosen in product(*(range(len(values)) for values in sweep.values())):
        words, settings = [], _Settings({}, {})
        for (key, values), number in zip(sweep.items(), chosen, strict=True):
            place: Location = ("sweep", key, number)
            words.append(_value_name(key, values[number]))
            nested, location = _nested(key, values[number])
            line = lines.of(place)
            settings = _Settings(nested, {} if line is None else {location: line}).over(settings)
        yield tuple(words), settings


def _value_name(key: str, value: Any) -> str:
    short = key.rpartition(".")[2]
    return str(value) if short in _CHOICES else f"{short}={value}"


def _sections(given: Mapping[str, Any], path: Path, place: Location, lines: Lines) -> _Settings:
    """Nest settings that are given with dotted keys."""
    settings = _Settings({}, {})
    for key, value in given.items():
        nested, location = _nested(str(key), value)
        below = lines.below((*place, str(key))).numbers
        inner = {(*location, *rest): line for rest, line in below.items()}
        for leaf in _leaves(value, location):
            if any(_ends_at(settings.values, leaf[:size]) for size in range(1, len(leaf) + 1)):
                words = lines.words((*place, str(key)))
                raise ConfigError(f"{path}: {words}{'.'.join(leaf)} stands twice: remove one")
        settings = _Settings(nested, inner).over(settings)
    return settings


def _nested(key: str, value: Any) -> tuple[dict[str, Any], tuple[str, ...]]:
    parts = key.split(".")
    nested: Any = value
    for part in reversed(parts):
        nested = {part: nested}
    return nested, tuple(parts)


def _leaves(value: Any, location: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Yield the locations of the values that are no sections."""
    if isinstance(value, dict) and value:
        for key, inner in value.items():
            yield from _leaves(inner, (*location, str(key)))
    else:
        yield location


def _ends_at(values: Any, location: tuple[str, ...]) -> bool:
    """Check if a value that is no section, or a whole section, is at that location."""
    for part in location:
        if not isinstance(values, dict) or part not in values:
            return False
        values = values[part]
    return not isinstance(values, dict)
