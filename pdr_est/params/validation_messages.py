"""Messages for invalid settings: the key, the value, and the remedy."""

import difflib
import reprlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from types import MappingProxyType
from typing import Any, get_args, get_type_hints

from pydantic import ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

Location = tuple[int | str, ...]
"""Keys and positions in lists that lead to a value."""

BOOLEAN = "is true or false: give a number or a word"
CONTRADICTION = "contradiction"  # type of the errors that `contradiction` makes

_MAX_ERRORS = 3  # in one message
_MAX_VALUE_CHARACTERS = 60
_UNIT_WORDS: Mapping[str, str] = MappingProxyType(
    {"_m": "metres", "_s": "seconds", "_hz": "hertz", "_rad": "radians", "_mps": "m/s", "_mps2": "m/s^2"}
)


def _no_line(_location: Location) -> str:
    return ""


def contradiction(message: str, location: Location = ()) -> PydanticCustomError:
    """Make the error for values that are in range one by one but do not go together.

    Parameters
    ----------
    message
        Complete message: keys, values and remedy.
    location
        Place of the value to blame, relative to the record whose `__post_init__` raises the error.
    """
    return PydanticCustomError(CONTRADICTION, "{message}", {"message": message, "location": list(location)})


def explain(error: ValidationError, record: type, line_of: Callable[[Location], str] = _no_line) -> str:
    """Describe what pydantic found wrong, at most three errors.

    Parameters
    ----------
    error
        Error of the validation.
    record
        Class that was validated.
    line_of
        Function that gives the words to put before what is said of a value, such as "line 7: ", or nothing.
    """
    details = error.errors(include_url=False)
    words = [line_of(_location(detail)) + _explain(detail, record) for detail in details[:_MAX_ERRORS]]
    if len(details) > _MAX_ERRORS:
        words.append(f"and {len(details) - _MAX_ERRORS} more")
    return "; ".join(words)


def nearest(name: str, known: Sequence[str]) -> str:
    """Suggest the known name that is probably meant, else list all known names."""
    near = difflib.get_close_matches(name, known, n=1)
    return f"did you mean {near[0]!r}?" if near else f"known are {', '.join(known)}"


def keys_of(record: type, location: Location) -> list[str]:
    """List the keys of the section at a location inside a record of nested sections."""
    section = section_at(record, location)
    return [] if section is None else [entry.name for entry in fields(section)]


def section_at(record: type, location: Location) -> Any:
    """Find the record class of the section at a location; None where there is no section."""
    section: Any = record
    for part in location:
        hint = None if section is None else get_type_hints(section, include_extras=True).get(str(part))
        section = next((kind for kind in kinds_of(hint) if is_dataclass(kind)), None)
    return section


def kinds_of(hint: Any) -> Iterator[Any]:
    """Yield a type and everything that it is a union, a list or an annotation of."""
    yield hint
    for argument in get_args(hint):
        yield from kinds_of(argument)


def brief(value: Any) -> str:
    """Shorten a value so that it fits into a message."""
    text = reprlib.repr(value)
    return text if len(text) <= _MAX_VALUE_CHARACTERS else f"{text[:_MAX_VALUE_CHARACTERS]}…"


def _location(detail: ErrorDetails) -> Location:
    """Find where the fault lies: an error in a key, such as a number, lies at the key as a text."""
    location: Location = detail["loc"]
    if detail["type"] == CONTRADICTION:
        return (*location, *detail["ctx"]["location"])
    return (*location[:-2], str(location[-2])) if location[-1:] == ("[key]",) else location


def _explain(detail: ErrorDetails, record: type) -> str:
    location = detail["loc"]
    key = ".".join(str(part) for part in location if part != "[key]") if location else "top level"
    value = brief(detail["input"])
    if isinstance(detail["input"], bool):
        return f"{key} = {value}: {BOOLEAN}"
    match detail["type"]:
        case "contradiction":
            return f"{key}: {detail['msg']}" if location else detail["msg"]
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


def _unit_hint(key: str) -> str:
    """Name the unit that the suffix of a key stands for: most values out of range are in another one."""
    _, underscore, suffix = key.rpartition("_")
    words = _UNIT_WORDS.get(underscore + suffix)
    return f"; the unit is {words}" if words is not None and "_per_" not in key else ""
