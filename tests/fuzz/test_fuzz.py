"""Random damage to everything that comes from outside.

In CI each target gets a fixed number of attacks, the same in every run. `make fuzz` goes on with new ones for
`PDR_EST_FUZZ_MINUTES`, and adds what fails to the corpus, which the fast tests replay.
"""

import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from attacks import TARGETS, attacks, faults
from confined_cli import ConfinedCli
from hypothesis import HealthCheck, given, seed, settings
from mutations import Attack, load_attack

CORPUS = Path(__file__).parent / "corpus"
MINUTES = float(os.environ.get("PDR_EST_FUZZ_MINUTES", "0"))
IN_CI = {"recording": 60, "fixes": 20, "settings": 30, "live": 12, "measurements": 200}
_BATCH = 100


@pytest.fixture(scope="module")
def cli() -> Iterator[ConfinedCli]:
    worker = ConfinedCli()
    yield worker
    worker.close()


def faults_of(attack: Attack, cli: ConfinedCli) -> list[str]:
    folder = Path(tempfile.mkdtemp())
    try:
        return faults(attack, cli, folder)
    finally:
        shutil.rmtree(folder)


@pytest.mark.parametrize("path", sorted(CORPUS.glob("*.json")), ids=lambda path: path.stem)
def test_what_once_failed_does_not_fail_again(path: Path, cli: ConfinedCli) -> None:
    assert faults_of(load_attack(path), cli) == []


def batch(target: str, number: int, examples: int, cli: ConfinedCli) -> None:
    """Attack a target with some examples that the number determines; the simplest failure joins the corpus."""
    failed: list[Attack] = []

    @seed(number)
    @settings(
        max_examples=examples,
        derandomize=False,
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(attacks(target))
    def withstand(attack: Attack) -> None:
        found = faults_of(attack, cli)
        if found:
            failed.append(attack)
        assert found == []

    try:
        withstand()
    except AssertionError:
        if MINUTES:
            failed[-1].save(CORPUS)
        raise


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_every_attack_is_withstood(target: str, cli: ConfinedCli) -> None:
    batch(target, 0, IN_CI[target], cli)
    end_s = time.monotonic() + 60.0 * MINUTES / len(TARGETS)
    while time.monotonic() < end_s:
        batch(target, int.from_bytes(os.urandom(4)), _BATCH, cli)
