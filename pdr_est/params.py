"""Parameter records: frozen dataclasses that pydantic can validate strictly, which `config` does.

The parameters of a stage live beside the stage. `config.py` nests the same records into the configuration, so
that a name, a default or a range is written once.
"""

from dataclasses import dataclass
from typing import Annotated, TypeVar, dataclass_transform

from annotated_types import Ge, Gt, Le
from pydantic import AfterValidator, ConfigDict

T = TypeVar("T")

_SMALLEST, _LARGEST = 1e-9, 1e6  # beyond lie mistakes, and squares that no number can hold


def _zero_or_not_tiny(value: float) -> float:
    if 0.0 < value < _SMALLEST:
        raise ValueError(f"Input should be 0 or at least {_SMALLEST:g}")
    return value


Positive = Annotated[float, Gt(0.0), Le(_LARGEST), AfterValidator(_zero_or_not_tiny)]
NonNegative = Annotated[float, Ge(0.0), Le(_LARGEST), AfterValidator(_zero_or_not_tiny)]
Fraction = Annotated[float, Ge(0.0), Le(1.0)]
Window = Annotated[Positive, Le(60.0)]  # seconds of signal that are looked at together


@dataclass_transform(frozen_default=True, kw_only_default=True)
def params(cls: type[T]) -> type[T]:
    """Make `cls` a frozen keyword-only dataclass whose validation refuses unknown keys, NaN and infinity.

    Making one does not validate it; `config.check` and reading a configuration do.
    """
    cls.__pydantic_config__ = ConfigDict(extra="forbid", allow_inf_nan=False)  # type: ignore[attr-defined]
    return dataclass(frozen=True, kw_only=True)(cls)
