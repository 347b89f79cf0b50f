"""Records with some fields changed."""

from dataclasses import dataclass

import pytest

from pdr_est.records import changed


@dataclass(frozen=True)
class Pair:
    """Record with a default."""

    one: int
    two: int = 2


def test_the_other_fields_stay_and_the_record_itself_too() -> None:
    pair = Pair(1)
    assert changed(pair, one=5) == Pair(5, 2)
    assert changed(pair, two=7) == Pair(1, 7)
    assert pair == Pair(1, 2)


def test_a_field_that_the_record_does_not_have_is_refused() -> None:
    with pytest.raises(TypeError, match=r"Pair has no field thre, toe: give one of one, two"):
        changed(Pair(1), one=3, toe=4, thre=5)
