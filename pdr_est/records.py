"""Make frozen records, and change fields of them, where there are many."""

from collections.abc import Iterable, Sequence
from typing import Any, TypeVar

Record = TypeVar("Record")


def changed(record: Record, **fields: Any) -> Record:
    """Return a frozen record with some fields changed, at a fraction of the cost of `dataclasses.replace`.

    Parameters
    ----------
    record
        A dataclass without slots; it is not validated again.
    **fields
        Fields and their new values.

    Raises
    ------
    TypeError
        If the record has no field of such a name.
    """
    merged = record.__dict__ | fields
    if len(merged) != len(record.__dict__):
        _refuse_unknown(record, fields)
    copy = object.__new__(type(record))
    object.__setattr__(copy, "__dict__", merged)  # faster than to fill the dictionary that the copy has
    return copy


def changed_each(records: Sequence[Record], **columns: Iterable[Any]) -> list[Record]:
    """Return records of one class, each with values of its own in some fields; see `changed`.

    Parameters
    ----------
    records
        Dataclasses without slots, as for `changed`.
    **columns
        Fields, and as many new values of each as there are records.

    Raises
    ------
    TypeError
        If the records have no field of such a name.
    ValueError
        If there are more or fewer values than records.
    """
    if records:
        _refuse_unknown(records[0], columns)
    names, new, found = tuple(columns), object.__new__, []
    for record, *values in zip(records, *columns.values(), strict=True):
        copy = new(type(record))
        object.__setattr__(copy, "__dict__", record.__dict__ | dict(zip(names, values, strict=True)))
        found.append(copy)
    return found


def made(record: type[Record], **fields: Any) -> Record:
    """Make a frozen record with all its fields, at a fraction of the cost of its constructor.

    Parameters
    ----------
    record
        A dataclass without slots and without validation.
    **fields
        All its fields; which there are is not checked.
    """
    new = object.__new__(record)
    new.__dict__.update(fields)
    return new


def _refuse_unknown(record: Any, fields: dict[str, Any]) -> None:
    """Raise TypeError for fields that a record does not have."""
    if not fields.keys() <= record.__dict__.keys():
        unknown = ", ".join(sorted(fields.keys() - record.__dict__.keys()))
        raise TypeError(f"{type(record).__name__} has no field {unknown}: give one of {', '.join(record.__dict__)}")
