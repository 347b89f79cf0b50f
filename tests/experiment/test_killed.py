"""Runs that are killed at random moments, or whose parts are damaged, end with the results of an undisturbed one."""

import gzip
import json
import random
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from experiment_files import SMALL, experiment_file

from pdr_est.experiment import load_experiment, run_experiment
from pdr_est.experiment.results.walk_result import encode, stored
from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.types.recording import DeviceRecording, Recording, Signal

WALKS = [f"walk_{number:04d}" for number in (1, 2, 3)]

# A process that has loaded everything, and makes a child for each run: loading would take most of the time.
KILLED_RUNS = """
import os, random, signal, sys, time
from pdr_est.cli import main
from pdr_est.experiment import load_experiment, run_experiment
from pdr_est.report.comparison import page
from pdr_est.training import gait_training

words, kills = sys.argv[2:], int(sys.argv[1])

def start():
    child = os.fork()
    if child == 0:
        code = 1
        try:
            main(words, standalone_mode=False)
            code = 0
        finally:
            os._exit(code)
    return child

begun = time.monotonic()
assert os.waitpid(start(), 0)[1] == 0  # to see how long it takes; the results are removed again
took = time.monotonic() - begun
rng, alive = random.Random(1), 0
for number in range(kills):
    if "--overwrite" not in words:
        words.append("--overwrite")
    child = start()
    time.sleep(rng.uniform(0.0, 0.9 * took))
    os.kill(child, signal.SIGKILL)
    alive += os.WIFSIGNALED(os.waitpid(child, 0)[1])
    if number % 2 == 0 and words[0] == "experiment":  # the next one goes on where this one was
        words.remove("--overwrite")
assert alive > kills / 4 or kills < 4
assert os.waitpid(start(), 0)[1] == 0
"""

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="needs fork, also with threads")


def run_and_kill(kills: int, *words: object) -> None:
    command = (sys.executable, "-c", KILLED_RUNS, str(kills), *map(str, words))
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def contents(folder: Path, *left_out: str) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file() and path.name not in left_out)
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


@pytest.mark.slow
@pytest.mark.parametrize("kills", [60])
def test_an_experiment_that_is_killed(kills: int, tmp_path: Path) -> None:
    path = experiment_file(tmp_path, SMALL.replace("45.0", "20.0"))
    run_and_kill(kills, "experiment", path, "-o", tmp_path / "out", "-q")
    run_experiment(load_experiment(path), tmp_path / "alone")
    varying = ("timings.parquet", "provenance.json")  # CPU times and the moment of the run
    found, expected = (contents(tmp_path / name, *varying) for name in ("out", "alone"))
    assert found.keys() == expected.keys()
    assert {name for name in found if not name.startswith("parts/") and found[name] != expected[name]} == set()


@pytest.fixture
def people(tmp_path: Path) -> Path:
    """Three people who walk, jog and run, each a little differently, with an accelerometer."""
    rng, time_s = np.random.default_rng(0), np.arange(0.0, 15.0, 0.02)
    for number in range(3):
        for gait, rate_hz, height in (("walking", 1.8, 3.0), ("jogging", 2.5, 9.0), ("running", 2.8, 13.0)):
            force = 0.5 * rng.standard_normal((len(time_s), 3))
            bounce = (height + 0.2 * number) * np.sin(2.0 * np.pi * (rate_hz + 0.05 * number) * time_s)
            force[:, 2] += STANDARD_GRAVITY_MPS2 + bounce
            folder = tmp_path / "data" / gait / f"person{number}"
            folder.mkdir(parents=True)
            recording = Recording("made up", "plain", (DeviceRecording(specific_force=Signal(time_s, force)),))
            write_plain_csv(recording, folder / "walk.csv")
    return tmp_path / "data"


@pytest.mark.slow
@pytest.mark.parametrize("kills", [40])
def test_a_training_that_is_killed(kills: int, people: Path, tmp_path: Path) -> None:
    words = ("train-gait", "--data", people, "--date", "2024-02-29", "-q")
    run_and_kill(0, *words, "--overwrite", "-o", tmp_path / "alone")
    run_and_kill(kills, *words, "-o", tmp_path / "out")
    assert contents(tmp_path / "out") == contents(tmp_path / "alone")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["alone", "data", "out"]


def damaged(content: bytes, rng: random.Random) -> bytes:
    """The content of a part with a random fault of a disk, of a program or of a person."""
    at = rng.randrange(len(content))
    kind = rng.randrange(6)
    if kind == 0:
        return content[:at]
    if kind == 1:
        return content[:at] + bytes([content[at] ^ (1 << rng.randrange(8))]) + content[at + 1 :]
    if kind == 2:
        return content[:at] + bytes(rng.randrange(1, 4096)) + content[at + 4096 :]
    if kind == 3:
        return content + content[:at]
    digest, _, text = gzip.decompress(content).partition(b"\n")
    return gzip.compress(digest + b"\n" + json.dumps(mutated(json.loads(text), rng)).encode())


def mutated(document: object, rng: random.Random) -> object:
    """A document in which one value has another type, or one key is missing or new."""
    others = [None, "text", 3, -1.5e308, [], {}, [[1]], True, {"a": {}}]
    if isinstance(document, dict) and document and rng.random() < 0.9:
        key = rng.choice(sorted(document))
        if rng.random() < 0.1:
            return {name: value for name, value in document.items() if name != key}
        return {**document, key: mutated(document[key], rng)}
    if isinstance(document, list) and document and rng.random() < 0.9:
        at = rng.randrange(len(document))
        return [*document[:at], mutated(document[at], rng), *document[at + 1 :]]
    return rng.choice([other for other in others if type(other) is not type(document)])


@pytest.mark.parametrize("number", [60, pytest.param(2000, marks=pytest.mark.slow)])
def test_a_damaged_part_counts_as_missing(number: int, tmp_path: Path) -> None:
    """Reading never fails, and what is taken is what was written."""
    path = experiment_file(tmp_path, SMALL.replace("45.0", "20.0"))
    experiment = load_experiment(path)
    run_experiment(experiment, tmp_path / "out")
    parts = sorted((tmp_path / "out" / "parts").iterdir())
    before, rng = [part.read_bytes() for part in parts], random.Random(0)
    whole = stored(parts[0].parent, WALKS)
    assert set(whole) == set(WALKS)
    for _ in range(number):
        which = rng.randrange(len(parts))
        parts[which].write_bytes(damaged(before[which], rng))
        found = stored(parts[0].parent, WALKS)
        parts[which].write_bytes(before[which])
        assert set(found) >= set(WALKS) - {WALKS[which]}
        assert all(encode(found[walk]) == encode(whole[walk]) for walk in found)
