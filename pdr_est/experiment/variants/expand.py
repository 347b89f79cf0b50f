"""Configurations from the settings, variants and sweeps of an experiment file."""

from collections.abc import Iterator, Mapping
from itertools import product
from pathlib import Path
from typing import Any

from pdr_est.config import Config, load_config
from pdr_est.config.loading import config_from_settings
from pdr_est.config.settings import Settings, nested_by, unfolded
from pdr_est.errors import ConfigError
from pdr_est.experiment.config import ExperimentConfig
from pdr_est.experiment.variants.axes import TRACK_FILES, Variant
from pdr_est.params.validation_messages import Location
from pdr_est.params.yaml_lines import Lines
from pdr_est.parts import importable

_FILE_KEY = "settings_file"
_CHOICES = ("name", "method", "detector", "model")  # keys whose value is a name that needs no key
_MOST_VARIANTS = 10_000


def expand(config: ExperimentConfig, path: Path, lines: Lines) -> tuple[Variant, ...]:
    """Make the variants in the order of the file, with the combinations of the sweep inside each.

    Modules of the user's own parts that the file names may lie in its folder.

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
    with importable([path.resolve().parent]):
        return _expanded(config, path, lines)


def _expanded(config: ExperimentConfig, path: Path, lines: Lines) -> tuple[Variant, ...]:
    base = _from_file(config.settings_file, path, (_FILE_KEY,), lines, Config())
    shared = unfolded(config.settings, str(path), lines, ("settings",))
    variants: dict[str, Variant] = {}
    for name, given in (config.variants or {"": None}).items():
        own = dict(given or {})
        place: Location = ("variants", name)
        if TRACK_FILES in own:
            pattern = _track_pattern(own, path, lines.words((*place, TRACK_FILES)))
            variants[name] = Variant(name, base, pattern)
            continue
        start = _from_file(own.pop(_FILE_KEY, None), path, (*place, _FILE_KEY), lines, base)
        settings = unfolded(own, str(path), lines, place).over(shared)
        for words, choice in _combinations(config.sweep, path, lines):
            full = " ".join(part for part in (name, *words) if part) or "default"
            if full in variants:
                swept = max(choice.lines.values(), default=None)
                words_of = lines.words(place) if swept is None else f"line {swept}: "
                raise ConfigError(f"{path}: {words_of}two variants are called {full!r}: rename one or leave it out")
            chosen = choice.over(settings)
            made = config_from_settings(chosen, f"{path}, variant {full!r}", path, start)
            variants[full] = Variant(full, made)
    return tuple(variants.values())


def _track_pattern(own: Mapping[str, Any], path: Path, line: str) -> str:
    """Return the pattern of the files of another program's tracks, which is relative to the experiment file."""
    pattern, place = own[TRACK_FILES], f"{path}: {line}{TRACK_FILES}"
    others = [key for key in own if key != TRACK_FILES]
    if others:
        raise ConfigError(f"{place}: the setting {others[0]} does not apply to tracks from files: remove it")
    if not isinstance(pattern, str) or not any(mark in pattern for mark in ("{walk}", "{name}")):
        raise ConfigError(
            f"{place} = {pattern!r}: is no pattern with {{walk}} or {{name}} for the name of the walk: write one "
            "such as ronin/{walk}.tum"
        )
    return str(path.parent.absolute() / pattern)


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
) -> Iterator[tuple[tuple[str, ...], Settings]]:
    """Yield each combination of the values of the sweep: the words of its name, and its settings."""
    count = 1
    for key, values in sweep.items():
        count *= len(values)
        if not values or count > _MOST_VARIANTS:
            what = "no value to sweep over" if not values else f"more than {_MOST_VARIANTS} combinations"
            raise ConfigError(f"{path}: {lines.words(('sweep', key))}sweep {key}: {what}: change the list")
    for chosen in product(*(range(len(values)) for values in sweep.values())):
        words, settings = [], Settings({}, {})
        for (key, values), number in zip(sweep.items(), chosen, strict=True):
            place: Location = ("sweep", key, number)
            words.append(_value_name(key, values[number]))
            nested, location = nested_by(key, values[number])
            line = lines.of(place)
            settings = Settings(nested, {} if line is None else {location: line}).over(settings)
        yield tuple(words), settings


def _value_name(key: str, value: Any) -> str:
    short = key.rpartition(".")[2]
    return str(value) if short in _CHOICES else f"{short}={value}"
