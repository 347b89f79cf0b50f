"""Records with some fields changed, and records that are made without their constructor."""

from dataclasses import dataclass, fields

import pytest
from signals import step

from pdr_est.front_end.heading.step_motion import step_motions
from pdr_est.front_end.odometry import Odometry, OdometryParams
from pdr_est.records import changed, made
from pdr_est.types.measurements import StepOdometry
from pdr_est.types.steps import StepMotion


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


def test_a_record_that_is_made_is_the_constructed_one() -> None:
    assert made(Pair, one=3, two=4) == Pair(3, 4)


def test_the_many_records_of_a_walk_have_all_their_fields() -> None:
    """A new field must also be given where records are made without their constructor."""
    steps = [step(0.5 * k + 1.0, 0.5 * k + 0.5) for k in range(6)]
    records = [*Odometry("phone", OdometryParams()).push_all(steps), *step_motions([one.samples for one in steps])]
    assert {type(record) for record in records} == {StepOdometry, StepMotion}
    for record in records:
        assert vars(record).keys() == {field.name for field in fields(record)}
