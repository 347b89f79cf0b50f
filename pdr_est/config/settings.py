"""Settings before they are validated: nested dictionaries, with the line of each value in its file."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pdr_est.config.records import PART_KEYS
from pdr_est.errors import ConfigError
from pdr_est.params.validation_messages import Location
from pdr_est.params.yaml_lines import Lines
from pdr_est.parts import is_external


@dataclass(frozen=True)
class Settings:
    """Some settings, nested by section.

    Attributes
    ----------
    values
        The settings.
    lines
        Line of each value by its location.
    """

    values: Mapping[str, Any]
    lines: Mapping[Location, int]

    def over(self, below: "Settings") -> "Settings":
        """Merge these settings over others."""
        return Settings(merged(below.values, self.values), {**below.lines, **self.lines})


def unfolded(given: Mapping[Any, Any], place: str, lines: Lines, location: Location = ()) -> Settings:
    """Nest settings whose keys may be dotted, such as `steps.detector`.

    Parameters
    ----------
    given
        Settings by key.
    place
        What to call their source in messages.
    lines
        Lines of that source.
    location
        Where the settings stand in it.

    Raises
    ------
    ConfigError
        For a setting that is given twice.
    """
    settings = Settings({}, {})
    for key, value in given.items():
        nested, own = nested_by(str(key), value)
        below = lines.below((*location, str(key))).numbers
        inner = {(*own, *rest): line for rest, line in below.items()}
        for leaf in _leaves(value, own):
            if any(_ends_at(settings.values, leaf[:size]) for size in range(1, len(leaf) + 1)):
                words = lines.words((*location, str(key)))
                raise ConfigError(f"{place}: {words}{'.'.join(leaf)} stands twice: remove one")
        settings = Settings(_merged(settings.values, nested), {**settings.lines, **inner})
    return settings


def nested_by(key: str, value: Any) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Nest a value by the parts of its dotted key; return it with the location that the key stands for."""
    parts = key.split(".")
    nested: Any = value
    for part in reversed(parts):
        nested = {part: nested}
    return nested, tuple(parts)


def merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """Merge settings over others, section by section.

    The parameters of a part from outside the package belong to its name: they are dropped where `over` names another
    part.
    """
    result = dict(base)
    for section, key in PART_KEYS.items():
        mine, theirs = base.get(section), over.get(section)
        if not isinstance(mine, dict) or not isinstance(theirs, dict) or key not in theirs:
            continue
        if mine.get(key, theirs[key]) != theirs[key] or not is_external(str(theirs[key])):
            result[section] = {name: value for name, value in mine.items() if name != "parameters"}
    return _merged(result, over)


def _merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    result = dict(base)
    for key, value in over.items():
        sections = isinstance(base.get(key), dict) and isinstance(value, dict)
        result[key] = _merged(base[key], value) if sections else value
    return result


def _leaves(value: Any, location: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Yield the locations of the values that are no sections."""
    if isinstance(value, dict) and value:
        for key, inner in value.items():
            yield from _leaves(inner, (*location, str(key)))
    else:
        yield location


def _ends_at(values: Any, location: tuple[str, ...]) -> bool:
    """Check whether a value that is no section, or all of a section, stands at a location."""
    for part in location:
        if not isinstance(values, dict) or part not in values:
            return False
        values = values[part]
    return not isinstance(values, dict)
