"""Configurations from YAML files and dictionaries."""

from collections.abc import Mapping
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from pdr_est.config.records import PART_KEYS, Config
from pdr_est.config.settings import Settings, merged, unfolded
from pdr_est.errors import ConfigError
from pdr_est.params.validation_messages import explain
from pdr_est.params.yaml_lines import Lines, load_yaml_lines
from pdr_est.parts import PartError, files_of, folder_of, importable, is_external, refuse_other_module


def load_config(path: str | Path, base: Config | None = None) -> Config:
    """Load a configuration from a YAML file of sections or dotted keys.

    Parameters
    ----------
    path
        The file. Modules that it names for parts of the user's own may lie in its folder.
    base
        Configuration whose settings are kept where the file says nothing; default: the default settings.

    Raises
    ------
    ConfigError
        With the file, the line and the key, for damaged YAML, unknown keys, values out of range and values that
        contradict each other.
    """
    data, lines = load_yaml_lines(path)
    if data is None:
        return Config() if base is None else base
    with importable([Path(path).resolve().parent]):
        if not isinstance(data, dict):
            return config_from_dict(data, str(path), lines)
        settings = unfolded(data, str(path), lines)
        return config_from_settings(settings, str(path), Path(path), base)


def config_from_settings(settings: Settings, place: str, path: Path, base: Config | None = None) -> Config:
    """Validate the settings of a file over those of a base.

    Parameters
    ----------
    settings
        The settings, with their lines.
    place
        What to call their source in messages.
    path
        The file, in whose folder the modules lie that it names.
    base
        Configuration whose settings are kept; default: the default settings.
    """
    lines = Lines(settings.lines)
    values = merged({} if base is None else config_to_dict(base), settings.values)
    config = config_from_dict(values, place, lines)
    _refuse_other_modules(settings, config, path.resolve().parent, place)
    return config


def config_from_dict(data: Any, place: str, lines: Lines | None = None) -> Config:
    """Validate settings that are nested by section.

    Parameters
    ----------
    data
        Nested dictionaries.
    place
        What to call their source in messages.
    lines
        Lines of the values in the file that `place` names.

    Raises
    ------
    ConfigError
        For unknown keys, values of the wrong type or out of range, and values that contradict each other.
    """
    known = Lines() if lines is None else lines
    try:
        return _adapter().validate_python(data)
    except ValidationError as error:
        raise ConfigError(f"{place}: {explain(error, Config, known.words)}") from error


def config_with(config: Config, changes: Mapping[str, Any], place: str) -> Config:
    """Make a configuration with some settings changed; `Config.replace` explains it. place: for messages."""
    changed = unfolded(changes, place, Lines()).values
    values = merged(config_to_dict(config), changed)
    try:  # to validate the changed sections alone is much quicker
        return replace(config, **{name: type(getattr(config, name))(**values[name]) for name in changed})
    except (AttributeError, TypeError, ConfigError):  # whose message does not tell the section
        return config_from_dict(values, place)


def config_to_dict(config: Config) -> dict[str, Any]:
    """Convert a configuration to nested plain dictionaries, ready for YAML or JSON."""
    return asdict(config)


def import_folders(config: Config) -> tuple[str, ...]:
    """Find the folders of the modules that a configuration names, for processes that have to import them."""
    folders = [folder_of(name) for name in _external_names(config)]
    return tuple(dict.fromkeys(folder for folder in folders if folder is not None))


def external_files(config: Config) -> tuple[Path, ...]:
    """Find the source files of the modules and packages that a configuration names, for checksums."""
    return tuple(sorted({file for name in _external_names(config) for file in files_of(name)}))


def _external_names(config: Config) -> list[str]:
    names = [getattr(getattr(config, section), key) for section, key in PART_KEYS.items()]
    return [name for name in names if is_external(name)]


@cache
def _adapter() -> TypeAdapter[Config]:
    return TypeAdapter(Config)


def _refuse_other_modules(settings: Settings, config: Config, folder: Path, place: str) -> None:
    """Raise ConfigError if a module in a folder is not the one that was imported under its name."""
    for section, key in PART_KEYS.items():
        name = getattr(getattr(config, section), key)
        if is_external(name) and key in settings.values.get(section, {}):
            try:
                refuse_other_module(name, folder, f"{section}.{key} = {name!r}")
            except PartError as error:
                words = Lines(settings.lines).words((section, key))
                raise ConfigError(f"{place}: {words}{error}") from error
