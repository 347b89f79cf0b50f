"""What is wrong with settings, in words: the key, the value, and the remedy."""

import difflib
import reprlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from types import MappingProxyType
from typing import Any, get_args, get_type_hints

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from pdr_est.config.yaml_lines import Lines, Location

_MOST_ERRORS = 3  # told at once
_LONGEST_VALUE = 60  # characters of a value in a message
_UNIT_WORDS: Mapping[str, str] = MappingProxyType(
    {"_m": "metres", "_s": "seconds", "_hz": "hertz", "_rad": "radians", "_mps": "m/s", "_mps2": "m/s^2"}
)


def explain(error: ValidationError, record: type, lines: Lines) -> str:
    """What pydantic found wrong, each with its line where that is known. record: the class that was validated."""
    details = error.errors()
    words = [lines.words(_place(detail["loc"])) + _explain(detail, record) for detail in details[:_MOST_ERRORS]]
    if len(details) > _MOST_ERRORS:
        words.append(f"and {len(details) - _MOST_ERRORS} more")
    return "; ".join(words)


def _place(location: Location) -> Location:
    """Where it stands in the file: what is wrong with a key, such as a number, stands at the key as a text."""
    return (*location[:-2], str(location[-2])) if location[-1:] == ("[key]",) else location


def nearest(name: str, known: list[str]) -> str:
    """A remedy for an unknown name: the one that is meant, or all that there are."""
    near = difflib.get_close_matches(name, known, n=1)
    return f"did you mean {near[0]!r}?" if near else f"known are {', '.join(known)}"


def keys_of(record: type, location: Location) -> list[str]:
    """Keys of the section at a location inside a record of nested sections."""
    section: Any = record
    for part in location:
        hint = None if section is None else get_type_hints(section, include_extras=True).get(str(part))
        section = next((kind for kind in _kinds(hint) if is_dataclass(kind)), None)
    return [] if section is None else [entry.name for entry in fields(section)]


def _kinds(hint: Any) -> list[Any]:
    """A type and everything that it is a union, a list or an annotation of."""
    return [hint, *(kind for argument in get_args(hint) for kind in _kinds(argument))]


def _explain(detail: ErrorDetails, record: type) -> str:
    location = detail["loc"]
    key = ".".join(str(part) for part in location if part != "[key]") if location else "top level"
    value = brief(detail["input"])
    match detail["type"]:
        case "unexpected_keyword_argument" | "extra_forbidden" | "invalid_key":
            known = keys_of(record, location[:-1])
            near = difflib.get_close_matches(str(location[-1]), known, n=1)
            remedy = f"did you mean {near[0]!r}?" if near else f"known keys are {', '.join(known)}"
            return f"unknown key {key!r}: {remedy}"
        case "dataclass_type" | "dataclass_exact_type":
            return f"{key} = {value}: is a section, give it keys such as {keys_of(record, location)[0]!r}"
        case "missing":
            return f"{key}: is missing: give it"
        case "greater_than" | "greater_than_equal" | "less_than" | "less_than_equal" | "finite_number":
            return f"{key} = {value}: {detail['msg']}{_unit_hint(key)}"
        case "tuple_type" | "list_type":
            return f"{key} = {value}: is no list: write its values in brackets, [a, b]"
        case "dict_type":
            return f"{key} = {value}: is no section: write keys and values below it"
        case "string_type":
            return f"{key} = {value}: is no text: put it in quotes"
        case "too_short":
            return f"{key} = {value}: is empty: give at least one value"
    return f"{key} = {value}: {detail['msg']}"


def brief(value: Any) -> str:
    """A value as it may stand in a message."""
    text = reprlib.repr(value)
    return text if len(text) <= _LONGEST_VALUE else f"{text[:_LONGEST_VALUE]}…"


def _unit_hint(key: str) -> str:
    """The unit that the suffix of a key names: most values out of range are in another one."""
    _, underscore, suffix = key.rpartition("_")
    words = _UNIT_WORDS.get(underscore + suffix)
    return f"; the unit is {words}" if words is not None and "_per_" not in key else ""
