"""The files and folders that a call reads, found by the types of its options, so that a new option counts at once."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

_NOTED = "pdr_est.inputs"  # in the context: inputs that are no value of an option any more
_PATTERN = ("*", "?", "[")


def is_pattern(path: Path) -> bool:
    """Tell whether a path stands for all files that match it."""
    return any(mark in str(path) for mark in _PATTERN) and not path.exists()


def matching_paths(pattern: Path) -> list[Path]:
    """List the files and folders that match a pattern, in order."""
    anchor = Path(pattern.anchor)
    return sorted(anchor.glob(str(pattern.relative_to(anchor))))


class OutputPath(click.Path):
    """Path that is written and not read."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)


class FixesType(click.ParamType[Any]):
    """Table of known positions, or a word for those in the recording."""

    name = "fixes"
    words = ("recording", "waypoints")

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the text, and take note of a table."""
        if value not in self.words:
            note_input(Path(value), ctx)
        return value


def note_input(path: Path, context: click.Context | None = None) -> None:
    """Take note of a file that the current call reads and that is no value of an option."""
    context = click.get_current_context(silent=True) if context is None else context
    if context is not None:
        context.meta.setdefault(_NOTED, []).append(path)


def input_paths(leave_out: str = "") -> tuple[Path, ...]:
    """List the files and folders that the current call reads; patterns stand for what they match.

    Parameters
    ----------
    leave_out
        Option whose file is brought up to date.
    """
    context = click.get_current_context()
    values = [
        context.params.get(parameter.name)
        for parameter in context.command.params
        if not isinstance(parameter.type, OutputPath) and parameter.name not in (None, leave_out)
    ]
    found = [path for value in (*values, context.meta.get(_NOTED, ())) for path in _paths_in(value)]
    return tuple(dict.fromkeys(found))


def _paths_in(value: Any) -> Iterator[Path]:
    if isinstance(value, tuple | list):
        for one in value:
            yield from _paths_in(one)
    elif isinstance(value, Path):
        yield value
        if is_pattern(value):
            yield from matching_paths(value)
