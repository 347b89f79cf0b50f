"""`pdr-est train-gait`: a model from recordings in folders, the same bytes every time."""

from pathlib import Path

import numpy as np
import pytest
from cli_runs import refused, run
from gait_people import DURATION_S, GAITS, RATE_HZ, three_people

from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.front_end.gait.folds import load_folds
from pdr_est.front_end.gait.model import load_model
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.training.gait_files import labelled_files, recordings_digest
from pdr_est.types.recording import DeviceRecording, Recording, Signal

FILES = {"gait-auto.json", "gait-auto-folds.json", "gait-auto.md", ".pdr_est-files.json"}


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three people who walk, jog and run, each a little differently."""
    return three_people(tmp_path_factory.mktemp("data"))


def test_own_recordings_give_a_model_with_its_card_the_same_every_time(data: Path, tmp_path: Path) -> None:
    for name in ("a", "b"):
        result = run("train-gait", "--data", data, "-o", tmp_path / name, "--date", "2024-02-29")
        assert result.exit_code == 0, result.output
        assert f"{name}: 3 people; leave-one-person-out accuracy 100.00 % for walking or faster" in result.stdout
    assert {path.name for path in (tmp_path / "a").iterdir()} == FILES
    for name in FILES:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    model = load_model(tmp_path / "a" / "gait-auto.json")
    assert model.people == ("own/anna", "own/ben", "own/chris")
    assert load_folds(tmp_path / "a" / "gait-auto-folds.json").model_for("own/ben") is not None
    card = (tmp_path / "a" / "gait-auto.md").read_text(encoding="utf-8")
    assert "Trained 2024-02-29" in card
    assert (tmp_path / "a" / "gait-auto.json").read_text().split('"sha256": "')[1][:64] in card
    assert recordings_digest(data) in card
    assert "MotionSense" not in card
    assert "labels and the place of the phone have not been checked" in card
    (own,) = model.data
    assert f"| own | 3 | 9 | {own.steps[0]} | {own.steps[1]} | {own.steps[2]} |" in card


@pytest.mark.slow
def test_earlier_results_are_kept_unless_told_otherwise(data: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert run("train-gait", "--data", data, "-o", out, "--features", "uptime").exit_code == 0
    assert "--overwrite" in refused("train-gait", "--data", data, "-o", out)
    assert (out / "gait-uptime.json").is_file()
    assert run("train-gait", "--data", data, "-o", out, "--overwrite").exit_code == 0
    assert {path.name for path in out.iterdir()} == FILES


def test_folders_without_labelled_recordings_are_refused(data: Path, tmp_path: Path) -> None:
    assert "no such folder" in refused("train-gait", "--data", tmp_path / "none", "-o", tmp_path / "out")
    assert "{walking,jogging,running}/PERSON" in refused("train-gait", "--data", tmp_path, "-o", tmp_path / "out")
    assert "too few people" in refused("train-gait", "--data", one_person(data, tmp_path), "-o", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_misplaced_recordings_are_refused_by_name(tmp_path: Path) -> None:
    def given(*names: str) -> str:
        folder = tmp_path / names[-1].replace("/", "_")
        for name in ("walking/anna/walk.csv", *names):
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            if name.endswith("/"):
                (folder / name).mkdir(exist_ok=True)
            else:
                (folder / name).touch()
        return refused("train-gait", "--data", folder, "-o", tmp_path / "out")

    assert "jog: is none of walking, jogging, running" in given("jog/anna/a.csv")
    assert "b.csv: has no folder of its person" in given("walking/b.csv")
    assert "ben: holds no recording" in given("walking/ben/.hidden", "walking/ben/")
    assert "running: holds no recording" in given("running/")


def test_a_recording_without_a_step_is_named(data: Path, tmp_path: Path) -> None:
    (tmp_path / "walking" / "anna").mkdir(parents=True)
    path = tmp_path / "walking" / "anna" / "still.csv"
    time_s = np.arange(0.0, DURATION_S, 1.0 / RATE_HZ)
    force = np.tile([0.0, 0.0, STANDARD_GRAVITY_MPS2], (len(time_s), 1))
    write_plain_csv(Recording("still", "plain", (DeviceRecording(specific_force=Signal(time_s, force)),)), path)
    message = refused("train-gait", "--data", tmp_path, "-o", tmp_path / "out")
    assert f"{path}: " in message
    assert "no step found in walking" in message


def one_person(data: Path, folder: Path) -> Path:
    for gait in GAITS:
        (folder / "one" / gait).mkdir(parents=True)
        (folder / "one" / gait / "anna").symlink_to(data / gait / "anna")
    return folder / "one"


def test_the_public_data_sets_are_found_by_their_folders(tmp_path: Path) -> None:
    names = (
        "motionsense/wlk_7/sub_2.csv.gz",
        "motionsense/jog_9/sub_2.csv",
        "motionsense/jog_9/sub_2.csv.gz",
        "motionsense/std_6/sub_2.csv",
        "sisfall/SA03/D04_SA03_R01.txt.gz",
        "sisfall/SA03/D05_SA03_R01.txt",
    )
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    found = [(file.path.relative_to(tmp_path).as_posix(), file.person) for file in labelled_files(tmp_path)]
    assert found == [(names[0], "motionsense/2"), (names[1], "motionsense/2"), (names[4], "sisfall/SA03")]


@pytest.mark.slow
@pytest.mark.parametrize("features", ["auto", "uptime"])
def test_the_shipped_model_is_reproduced_byte_for_byte(features: str, shared_data: Path, tmp_path: Path) -> None:
    result = run("train-gait", "--data", shared_data, "-o", tmp_path / "out", "--features", features)
    assert result.exit_code == 0, result.output
    shipped = Path(__file__).resolve().parents[2] / "models"
    for name in (f"gait-{features}.json", f"gait-{features}-folds.json"):
        assert (tmp_path / "out" / name).read_bytes() == (shipped / name).read_bytes()
