"""Make the objects of a table again.

Nothing that the data name is called: of a class of an allowed module an empty instance is made, which gets its
attributes back, by its own `__setstate__` if it has one.
"""

from base64 import b64decode
from collections import OrderedDict, defaultdict, deque
from collections.abc import Callable, Collection, Mapping
from enum import Enum
from importlib import import_module
from typing import Any

import numpy as np

from pdr_est.online.saved_state.table_format import (
    ARRAY_KINDS,
    FACTORIES,
    NOTHING_OUTSIDE,
    PLAIN,
    SEQUENCES,
    ObjectTableError,
)

_PACKAGE = __name__.partition(".")[0]
_UNFIT = (TypeError, ValueError, KeyError, IndexError, AttributeError, OverflowError, MemoryError)

_Filling = Callable[[], None]


def decoded(table: Any, modules: Collection[str] = (), outside: Mapping[str, object] = NOTHING_OUTSIDE) -> Any:
    """Make the object of the first row of a table.

    Parameters
    ----------
    table
        What `encoded` returned.
    modules
        Names of modules whose classes may occur, besides those of this package.
    outside
        The objects that are not in the table, by name.

    Raises
    ------
    ObjectTableError
        For anything else, and classes of other modules.
    """
    if not isinstance(table, list) or not table:
        raise ObjectTableError("there is no table of objects")
    reader = _Reader(table, modules, outside)
    try:
        return reader.root()
    except _UNFIT as error:
        raise ObjectTableError(f"its objects do not fit together ({error})") from error


class _Reader:
    """Makes the objects of a table: empty ones first, so that they may refer to each other, then their content."""

    def __init__(self, table: list[Any], modules: Collection[str], outside: Mapping[str, object]) -> None:
        self._table, self._modules, self._outside = table, frozenset(modules), outside
        self._made: dict[int, Any] = {}
        self._attributes: deque[_Filling] = deque()  # of objects and lists
        self._hashed: list[_Filling] = []  # dictionaries and sets: their keys must be complete
        self._restored: list[_Filling] = []  # objects that need their state complete

    def root(self) -> Any:
        root = self._object(0)
        while self._attributes:
            self._attributes.popleft()()
        while self._hashed:
            self._hashed.pop()()
            while self._attributes:
                self._attributes.popleft()()
        for restore in reversed(self._restored):
            restore()
        return root

    def _value(self, value: Any) -> Any:
        if type(value) in PLAIN:
            return value
        (row,) = value
        return self._object(row)

    def _values(self, values: Any) -> list[Any]:
        return [self._value(value) for value in values]

    def _pairs(self, pairs: Any) -> list[tuple[Any, Any]]:
        return [(self._value(key), self._value(value)) for key, value in pairs]

    def _object(self, row: int) -> Any:
        if row not in self._made:
            if not 0 <= row < len(self._table):
                raise IndexError(f"row {row} of {len(self._table)}")
            kind, *content = self._table[row]
            self._made[row] = self._make(kind, content)
        return self._made[row]

    def _make(self, kind: str, content: list[Any]) -> Any:
        """Make the object of a row, empty if it can be filled later."""
        match kind, content:
            case "array" | "scalar", [str() as dtype, order, shape, data]:
                return _array(kind, dtype, order, shape, data)
            case "complex", [float() as real, float() as imaginary]:
                return complex(real, imaginary)
            case "bytes", [data]:
                return b64decode(data, validate=True)
            case "outside", [str() as name]:
                return self._outside[name]
            case "plain", [value] if type(value) in PLAIN:
                return value
            case "slice", [bounds]:
                return slice(*self._values(bounds))
            case "generator", [state]:
                made, complete = np.random.Generator(np.random.PCG64(0)), self._value(state)
                return self._later(made, self._restored, lambda one: setattr(one.bit_generator, "state", complete))
            case "tuple" | "frozenset", [values]:
                return SEQUENCES[kind](self._values(values))
            case "named" | "enum" | "object" | "restored", [str() as name, *data]:
                return self._make_instance(kind, name, data)
        return self._make_collection(kind, content)

    def _make_collection(self, kind: str, content: list[Any]) -> Any:
        """Make an empty collection; what it holds is added later."""
        match kind, content:
            case "list", [values]:
                return self._later([], self._attributes, lambda made: made.extend(self._values(values)))
            case "deque", [most, values]:
                last = deque[Any](maxlen=most)
                return self._later(last, self._attributes, lambda made: made.extend(self._values(values)))
            case "set", [values]:
                return self._later(set(), self._hashed, lambda made: made.update(self._values(values)))
            case "dict" | "OrderedDict", [pairs]:
                empty = {} if kind == "dict" else OrderedDict[Any, Any]()
                return self._later(empty, self._hashed, lambda made: made.update(self._pairs(pairs)))
            case "defaultdict", [factory, pairs]:
                empty = defaultdict(FACTORIES[factory])
                return self._later(empty, self._hashed, lambda made: made.update(self._pairs(pairs)))
        raise ValueError(f"a row of kind {kind!r}")

    def _make_instance(self, kind: str, name: str, data: list[Any]) -> Any:
        """Make an instance of a class; its attributes are added later."""
        match kind, data:
            case "named", [values]:
                return tuple.__new__(self._class(name, tuple), self._values(values))
            case "enum", [str() as member]:
                return self._class(name, Enum)[member]
            case "object", [in_dict, in_slots]:
                made = object.__new__(self._class(name))
                return self._later(made, self._attributes, lambda one: self._fill(one, in_dict, in_slots))
            case "restored", [state]:
                made, complete = object.__new__(self._class(name)), self._value(state)
                return self._later(made, self._restored, lambda one: one.__setstate__(complete))
        raise ValueError(f"a row of kind {kind!r}")

    def _later(self, made: Any, queue: "deque[_Filling] | list[_Filling]", fill: Callable[[Any], None]) -> Any:
        queue.append(lambda: fill(made))
        return made

    def _fill(self, made: Any, in_dict: Any, in_slots: Any) -> None:
        """Give an object its attributes, also a frozen one."""
        if in_dict:
            made.__dict__.update(self._pairs(in_dict))
        for name, value in self._pairs(in_slots):
            object.__setattr__(made, name, value)

    def _class(self, name: str, base: type[Any] = object) -> Any:
        """Find a class of an allowed module by its name."""
        module, _, qualname = name.partition(":")
        inside = module == _PACKAGE or module.startswith(f"{_PACKAGE}.")
        if not (inside or module in self._modules) or module.endswith("__main__"):
            raise ObjectTableError(
                f"it holds objects of the module {module!r}: name the modules of your own parts where you restore it"
            )
        try:
            found = getattr(import_module(module), qualname, None)
        except ImportError as error:
            raise ObjectTableError(f"the module {module!r} cannot be imported ({error})") from error
        if not isinstance(found, type) or not issubclass(found, base) or found.__module__ != module:
            raise ObjectTableError(f"{name} is no class that can be restored")
        return found


def _array(kind: str, dtype: str, order: Any, shape: Any, data: Any) -> Any:
    wanted = np.dtype(dtype)
    if wanted.kind not in ARRAY_KINDS or order not in ("C", "F"):
        raise ValueError(f"an array of type {dtype!r}, order {order!r}")
    array = np.frombuffer(b64decode(data, validate=True), wanted).reshape(shape, order=order).copy(order)
    return array[()] if kind == "scalar" else array
