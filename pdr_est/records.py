"""Change fields of frozen records."""

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
    """
    copy = object.__new__(type(record))
    copy.__dict__.update(record.__dict__, **fields)
    return copy
