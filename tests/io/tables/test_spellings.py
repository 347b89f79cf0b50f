"""A table whose columns are renamed, reordered and in other units is read to the same samples, or says so."""

import random
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from spelt_tables import spelt_table
from table_walk import table_walk

from pdr_est.errors import RecordingError
from pdr_est.io import read

SEEDS = st.integers(0, 2**32 - 1)
UNCERTAIN = ("is not certain", "contradicts")


def check_spelling(folder: Path, seed: int) -> None:
    """Read a table in the spelling of a seed: right, or with words that the unit is not certain."""
    walk = table_walk()
    table = spelt_table(walk, random.Random(seed))
    (folder / "walk.csv").write_bytes(table.data)
    try:
        device = read(folder / "walk.csv").devices[0]
    except RecordingError as error:
        pytest.fail(f"{table.header}: {error}")
    force, rate = device.specific_force, device.rotation_rate
    assert force is not None, table.header
    assert rate is not None, table.header
    right = (
        np.allclose(force.values, walk.force, atol=2e-5)
        and np.allclose(rate.values, walk.rate, atol=2e-5)
        and np.allclose(force.time_s - force.time_s[0], walk.time_s, atol=2e-3)
    )
    told = any(mark in words for words in device.warnings for mark in UNCERTAIN)
    assert right or told, table.header


@settings(
    max_examples=15, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(seed=SEEDS)
def test_some_spellings_are_read_to_the_same_samples(tmp_path: Path, seed: int) -> None:
    check_spelling(tmp_path, seed)


@pytest.mark.slow
@settings(
    max_examples=1000, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(seed=SEEDS)
@example(seed=1_029_363_966)  # ROS titles with a unit
def test_many_spellings_are_read_to_the_same_samples(tmp_path: Path, seed: int) -> None:
    check_spelling(tmp_path, seed)
