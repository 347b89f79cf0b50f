"""Write a graph of objects as a table of plain data."""

import sys
from base64 import b64encode
from collections import OrderedDict, defaultdict, deque
from collections.abc import Iterable, Mapping
from enum import Enum
from typing import Any, Literal

import numpy as np

from pdr_est.online.saved_state.table_format import (
    ARRAY_KINDS,
    FACTORIES,
    NOTHING_OUTSIDE,
    PLAIN,
    SEQUENCES,
    ObjectTableError,
)

_BUILT_IN_CONTENT = (tuple, list, dict, set, frozenset, str, bytes, int, float, BaseException, type)
_NO_DATA = (
    "which is no data: let parts of your own hold only numbers, texts, arrays, collections of these, and objects of "
    "classes at the top level of a module"
)


def encoded(root: object, outside: Mapping[str, object] = NOTHING_OUTSIDE) -> list[Any]:
    """Return the table of an object; its first row is the object.

    Parameters
    ----------
    root
        The object.
    outside
        Objects by name that are not written, but given again when the table is read.

    Raises
    ------
    ObjectTableError
        For an object that is no data.
    """
    return _Writer(outside).table(root)


class _Writer:
    """Writes rows until all objects that others refer to have one."""

    def __init__(self, outside: Mapping[str, object]) -> None:
        self._outside = {id(value): name for name, value in outside.items()}
        self._objects: list[object] = []  # by row; also keeps them alive, so that no identity is used twice
        self._row_of: dict[int, int] = {}

    def table(self, root: object) -> list[Any]:
        self._reference(root)
        rows: list[Any] = []
        while len(rows) < len(self._objects):
            rows.append(self._row(self._objects[len(rows)]))
        return rows

    def _value(self, value: object) -> Any:
        return value if type(value) in PLAIN else self._reference(value)

    def _values(self, values: Iterable[object]) -> list[Any]:
        return [self._value(value) for value in values]

    def _pairs(self, pairs: Iterable[tuple[object, object]]) -> list[Any]:
        return [[self._value(key), self._value(value)] for key, value in pairs]

    def _reference(self, value: object) -> list[int]:
        row = self._row_of.get(id(value))
        if row is None:
            row = self._row_of[id(value)] = len(self._objects)
            self._objects.append(value)
        return [row]

    def _row(self, value: Any) -> list[Any]:
        if id(value) in self._outside:
            return ["outside", self._outside[id(value)]]
        if isinstance(value, np.generic | np.ndarray):
            return _array_row(value)
        if isinstance(value, np.random.Generator) and isinstance(value.bit_generator, np.random.PCG64):
            return ["generator", self._value(dict(value.bit_generator.state))]
        if isinstance(value, Enum):
            return ["enum", _class_name(type(value)), value.name]
        return self._collection_row(value) or _number_row(value) or self._object_row(value, type(value))

    def _collection_row(self, value: Any) -> list[Any] | None:
        """Write a collection; None for anything else."""
        kind = type(value)
        name = kind.__name__
        if kind in SEQUENCES.values():
            return [name, self._values(value)]
        if kind in (dict, OrderedDict):
            return [name, self._pairs(value.items())]
        if kind is deque:
            return [name, value.maxlen, self._values(value)]
        if kind is defaultdict and value.default_factory in FACTORIES.values():
            return [name, value.default_factory.__name__, self._pairs(value.items())]
        if kind is slice:
            return [name, self._values((value.start, value.stop, value.step))]
        if isinstance(value, tuple) and hasattr(kind, "_fields"):
            return ["named", _class_name(kind), self._values(value)]
        return None

    def _object_row(self, value: Any, kind: type[Any]) -> list[Any]:
        """Write class and attributes; those in slots stand in a second list."""
        if isinstance(value, _BUILT_IN_CONTENT):  # their content is not among their attributes
            raise ObjectTableError(f"it holds a {kind.__module__}.{kind.__qualname__}, {_NO_DATA}")
        name, state = _class_name(kind), value.__getstate__()
        if hasattr(kind, "__setstate__"):
            return ["restored", name, self._value(state)]
        in_dict, in_slots = state if isinstance(state, tuple) else (state, None)
        return ["object", name, self._pairs((in_dict or {}).items()), self._pairs((in_slots or {}).items())]


def _number_row(value: Any) -> list[Any] | None:
    """Write a value that is no collection and has no attributes; None for anything else."""
    kind = type(value)
    if kind is complex:
        return ["complex", value.real, value.imag]
    if kind is bytes:
        return ["bytes", b64encode(value).decode()]
    return ["plain", value] if kind in PLAIN else None


def _class_name(kind: type[Any]) -> str:
    """Return the name by which a class is found again."""
    name = f"{kind.__module__}:{kind.__qualname__}"
    module = sys.modules.get(kind.__module__)
    if kind.__module__ == "builtins" or getattr(module, kind.__qualname__, None) is not kind:
        raise ObjectTableError(f"it holds a {kind.__module__}.{kind.__qualname__}, {_NO_DATA}")
    return name


def _array_row(value: Any) -> list[Any]:
    array = np.asarray(value)
    if array.dtype.kind not in ARRAY_KINDS:
        raise ObjectTableError(f"it holds an array of type {array.dtype}, which is no data: use numbers")
    order: Literal["C", "F"] = "F" if array.flags.f_contiguous and not array.flags.c_contiguous else "C"
    data = b64encode(array.tobytes(order)).decode()
    return ["scalar" if isinstance(value, np.generic) else "array", array.dtype.str, order, list(array.shape), data]
