"""Parameter records: frozen dataclasses that are validated when they are made.

The parameters of a stage lie beside the stage, in a record made with `params`. `pdr_est.config` nests these records
into the configuration, so that a name, a default and a range are written once. Each field has a docstring right
under it, which `pdr_est.params.field_docstrings` reads for the JSON schema and for `pdr-est config show`.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import MISSING, dataclass, fields
from functools import cache, wraps
from inspect import get_annotations
from typing import Annotated, Any, TypeVar, dataclass_transform

from annotated_types import Ge, Gt, Le
from pydantic import AfterValidator, BeforeValidator, ConfigDict, TypeAdapter, ValidationError
from pydantic_core import PydanticCustomError

from pdr_est.errors import ConfigError
from pdr_est.params.validation_messages import BOOLEAN, explain, kinds_of

T = TypeVar("T")

_RECORDS: set[type] = set()  # all that `params` made

_SMALLEST, _LARGEST = 1e-9, 1e6  # beyond lie mistakes, and numbers whose square overflows


def _zero_or_not_tiny(value: float) -> float:
    if 0.0 < value < _SMALLEST:
        raise ValueError(f"Input should be 0 or at least {_SMALLEST:g}")
    return value


Positive = Annotated[float, Gt(0.0), Le(_LARGEST), AfterValidator(_zero_or_not_tiny)]
"""Number above 0."""

NonNegative = Annotated[float, Ge(0.0), Le(_LARGEST), AfterValidator(_zero_or_not_tiny)]
"""Number that is 0 or above."""

Fraction = Annotated[float, Ge(0.0), Le(1.0)]
"""Number from 0 to 1."""

Window = Annotated[Positive, Le(60.0)]
"""Length of a window of signal, s."""


@dataclass_transform(frozen_default=True, kw_only_default=True)
def params(cls: type[T]) -> type[T]:
    """Make a class a frozen, keyword-only dataclass whose fields are validated when a record is made.

    Unknown keys, values of the wrong type or out of range, NaN, infinity, and booleans given for numbers are
    refused. A `__post_init__` may call `contradiction` for values that do not go together.

    Parameters
    ----------
    cls
        Class with annotated fields. A base class that is a parameter record hands down its fields.

    Returns
    -------
    type
        The same class. Making a record, also with `dataclasses.replace`, raises `ConfigError`, which names the field,
        its value and its range.
    """
    hints = get_annotations(cls)
    cls.__annotations__ = {name: _without_booleans(hint) for name, hint in hints.items()}
    cls.__pydantic_config__ = ConfigDict(extra="forbid", allow_inf_nan=False)  # type: ignore[attr-defined]
    made = dataclass(frozen=True, kw_only=True)(cls)
    made.__init__ = _validating(made, made.__init__)  # type: ignore[method-assign]
    _RECORDS.add(made)
    return made


def _validating(record: Any, set_fields: Callable[..., None]) -> Callable[..., None]:
    """Make the constructor of a record that validates its arguments; defaults and records of the kind need none."""
    names = [entry.name for entry in fields(record)]
    kinds = get_annotations(record)
    complete = all(entry.default is not MISSING or entry.default_factory is not MISSING for entry in fields(record))

    @wraps(set_fields)
    def init(self: Any, **values: Any) -> None:
        if complete and not values:
            set_fields(self)
            return
        if complete and all(type(value) is kinds.get(name) in _RECORDS for name, value in values.items()):
            with suppress(ValueError):  # a contradiction between them, which the validation explains
                set_fields(self, **values)
                return
        try:
            kind: Any = type(self)
            valid = _validator_of(kind).validate_python(values)
        except ValidationError as error:
            raise ConfigError(f"{type(self).__name__}: {explain(error, type(self))}") from error
        for name in names:
            object.__setattr__(self, name, getattr(valid, name))

    return init


@cache
def _validator_of(record: Any) -> TypeAdapter[Any]:
    """Build the validator of a record at its first use: those of all records together take 0.15 s."""
    return TypeAdapter(record)


def _without_booleans(hint: Any) -> Any:
    """Refuse True for 1 in a field that is no boolean; YAML also reads yes, no, on and off as booleans."""
    kinds = set(kinds_of(hint))
    if bool in kinds or not kinds & {int, float}:
        return hint
    return Annotated[hint, BeforeValidator(_refuse_boolean)]


def _refuse_boolean(value: Any) -> Any:
    if isinstance(value, bool):
        raise PydanticCustomError("no_boolean", BOOLEAN)
    return value
