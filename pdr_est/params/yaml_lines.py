"""Read YAML files strictly, with the line on which each key stands."""

from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import yaml

from pdr_est.errors import ConfigError
from pdr_est.params.validation_messages import Location

_LARGEST_BYTES = 1 << 24  # an experiment may list many thousand walks
_MOST_VALUES = 1_000_000  # with those that an alias repeats

_NO_LINES: Mapping[Location, int] = MappingProxyType({})


@dataclass(frozen=True)
class Lines:
    """Lines of the values of a document.

    Attributes
    ----------
    numbers
        Line of each location, counted from 1.
    """

    numbers: Mapping[Location, int] = field(default_factory=lambda: _NO_LINES)

    def of(self, location: Location) -> int | None:
        """Find the line of a value, else of the first one below it, else of the nearest section that it would lie in.

        Returns None when no line is known.
        """
        below = [line for key, line in self.numbers.items() if key[: len(location)] == location]
        if location not in self.numbers and below:
            return min(below)
        for length in range(len(location), -1, -1):
            if location[:length] in self.numbers:
                return self.numbers[location[:length]]
        return None

    def words(self, location: Location) -> str:
        """Make the words to put before what is said of a value, such as "line 7: ", or nothing."""
        line = self.of(location)
        return "" if line is None else f"line {line}: "

    def below(self, location: Location) -> "Lines":
        """Give the lines of the value at a location, as if it were a document of its own."""
        size = len(location)
        return Lines({key[size:]: line for key, line in self.numbers.items() if key[:size] == location})


def load_yaml(path: str | Path) -> Any:
    """Read a YAML file. Raises ConfigError, which names the file, also for a key that stands twice."""
    return load_yaml_lines(path)[0]


def load_yaml_lines(path: str | Path) -> tuple[Any, Lines]:
    """Read a YAML file with the lines of its values. Raises ConfigError as `load_yaml` does."""
    try:
        return _parsed(_text(Path(path)))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read ({error.strerror}): check the path") from error
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: is not UTF-8 text: save it as UTF-8 YAML") from error
    except yaml.MarkedYAMLError as error:
        line = "" if error.problem_mark is None else f", line {error.problem_mark.line + 1}"
        raise ConfigError(f"{path}{line}: is not valid YAML ({error.problem}): correct it") from error
    except (yaml.YAMLError, RecursionError) as error:
        raise ConfigError(f"{path}: is not valid YAML ({' '.join(str(error).split())}): correct it") from error


def _text(path: Path) -> str:
    """Read a file of at most the size of settings: a device may never end."""
    with path.open("rb") as file:
        content = file.read(_LARGEST_BYTES + 1)
    if len(content) > _LARGEST_BYTES:
        raise ConfigError(f"{path}: is larger than {_LARGEST_BYTES >> 20} MiB: give a file of settings")
    return content.decode("utf-8-sig")


class _StrictLoader(yaml.SafeLoader):
    """Loader for which a key that stands twice is an error: the first value would be lost without a word."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        """Make the dictionary of a mapping whose keys all differ."""
        seen: set[str] = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                continue
            if key.value in seen:
                raise yaml.constructor.ConstructorError(None, None, f"{key.value!r} stands twice", key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep)


def _parsed(text: str) -> tuple[Any, Lines]:
    loader = _StrictLoader(text)
    try:
        node = loader.get_single_node()
        _refuse_endless(node)
        lines = {} if node is None else dict(_lines_of(node, ()))
        return (None if node is None else loader.construct_document(node)), Lines(lines)
    finally:
        loader.dispose()


def _refuse_endless(root: yaml.Node | None) -> None:
    """Refuse aliases that contain themselves or multiply the values of the document."""
    counts: dict[yaml.Node, int] = {}
    open_nodes: set[yaml.Node] = set()

    def count(node: yaml.Node) -> int:
        if node in open_nodes:
            raise yaml.composer.ComposerError(None, None, "an alias contains itself", node.start_mark)
        if node not in counts:
            open_nodes.add(node)
            counts[node] = 1 + sum(count(inner) for inner in _inner(node))
            open_nodes.remove(node)
            if counts[node] > _MOST_VALUES:
                problem = f"with its aliases it has more than {_MOST_VALUES} values"
                raise yaml.composer.ComposerError(None, None, problem, node.start_mark)
        return counts[node]

    if root is not None:
        count(root)


def _inner(node: yaml.Node) -> Iterator[yaml.Node]:
    """Iterate over the keys and values in a node."""
    if isinstance(node, yaml.MappingNode):
        for pair in node.value:
            yield from pair
    elif isinstance(node, yaml.SequenceNode):
        yield from node.value


def _lines_of(node: yaml.Node, location: Location) -> Iterator[tuple[Location, int]]:
    yield location, node.start_mark.line + 1
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            if isinstance(key, yaml.ScalarNode):
                inner = (*location, str(key.value))
                yield from _lines_of(value, inner)
                yield inner, key.start_mark.line + 1  # a section is named by its key, not by what stands below
    elif isinstance(node, yaml.SequenceNode):
        for place, value in enumerate(node.value):
            yield from _lines_of(value, (*location, place))
