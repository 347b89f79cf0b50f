"""Table of plain data that a graph of objects is written as.

The table has one row for each object, in which other objects are given by the number of their row, so that an object
that two others share is shared again. A value is written as it is if it is None, a truth value, an integer, a
floating-point number or a text; a list of one number refers to a row. Numbers come back bit for bit, arrays with
their type and memory order.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

PLAIN = (type(None), bool, int, float, str)
"""Types of the values that are written as they are."""

SEQUENCES: Mapping[str, type[Any]] = MappingProxyType(
    {"list": list, "tuple": tuple, "set": set, "frozenset": frozenset}
)
"""Collections without keys, by the name of their rows."""

FACTORIES: Mapping[str, type[Any]] = MappingProxyType(
    {"list": list, "dict": dict, "set": set, "int": int, "float": float}
)
"""Possible factories of a `defaultdict`."""

ARRAY_KINDS = "biufcU"
"""Kinds of the types of arrays that are data."""

NOTHING_OUTSIDE: Mapping[str, object] = MappingProxyType({})
"""No objects outside the table."""


class ObjectTableError(Exception):
    """Objects cannot be written as a table, or a table is not that of objects."""
