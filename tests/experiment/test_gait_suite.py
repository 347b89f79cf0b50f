"""The suite `gait` on tiny made-up walks, with models that give every step the same label."""

import io
from dataclasses import replace

import pytest
from rich.console import Console
from small_sets import motionsense_table, sisfall_table

import pdr_est.front_end.gait as gait_package
from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.experiment import comparison_on_axis, print_benchmark, run_benchmark
from pdr_est.experiment.suites import gait
from pdr_est.front_end.gait import GaitParams
from pdr_est.front_end.gait.folds import GaitFolds
from pdr_est.front_end.gait.model import GaitModel, SupportVectorMachine, save_model
from pdr_est.io import read
from pdr_est.training.gait_files import labelled_files
from pdr_est.types.steps import Gait


def always(label):
    """A model that gives this label to every step."""

    def machine(upper):
        return SupportVectorMachine(
            columns=(0,),
            mean=(0.0,),
            scale=(1.0,),
            kernel="linear",
            gamma=0.0,
            support=((0.0,),),
            dual=(1.0,),
            intercept=2.0 if upper else -2.0,
            sigmoid=(3.0, 0.0),
        )

    return GaitModel(
        features="auto",
        faster=machine(label != Gait.WALKING),
        running=machine(label == Gait.RUNNING),
        people=("somebody",),
        data=(),
    )


@pytest.fixture
def models(monkeypatch):
    """A shipped model that says walking, and one that has not seen MotionSense's 1 and SA01 and says running."""
    monkeypatch.setattr(gait_package, "shipped_model", lambda _method: always(Gait.WALKING))
    left_out = (always(Gait.JOGGING), always(Gait.RUNNING))
    folds = GaitFolds(models=left_out, fold_of={"motionsense/1": 1, "sisfall/SA01": 1})
    monkeypatch.setattr(gait, "shipped_folds", lambda _method: folds)


def run(data, parameters=None):
    return run_benchmark("gait", data, comparison_on_axis(Config(gait=parameters or GaitParams())))


def by_name(result):
    return {row["walk"]: row for row in result.to_dict()["walks"]}


def predicted(row):
    """The one label that all steps of a row have; about two steps a second."""
    (label,) = [label for label, steps in row["predicted"].items() if steps]
    assert 36 <= row["predicted"][label] <= 40
    return label


@pytest.mark.usefixtures("models")
def test_people_of_the_training_data_are_labelled_by_the_model_that_has_not_seen_them(tmp_path):
    for name in ("wlk_7/sub_1", "wlk_7/sub_11", "jog_9/sub_1", "ups_3/sub_1"):
        motionsense_table(tmp_path / f"motionsense/{name}.csv")
    for person, code in (("SA01", "D04"), ("SA13", "D03")):
        sisfall_table(tmp_path / f"sisfall/{person}/{code}_{person}_R01.txt")
    result = run(tmp_path)
    assert result.failures == ()
    rows = by_name(result)
    assert {name: (row["true_class"], predicted(row)) for name, row in rows.items()} == {
        "motionsense/wlk_7/sub_1": ("walking", "running"),
        "motionsense/wlk_7/sub_11": ("walking", "walking"),
        "motionsense/jog_9/sub_1": ("jogging", "running"),
        "motionsense/ups_3/sub_1": (None, "running"),
        "sisfall/SA01/D04_SA01_R01": ("running", "running"),
        "sisfall/SA13/D03_SA13_R01": ("jogging", "walking"),
    }
    assert [rows[name]["gait_accuracy"] for name in list(rows)] == [0.0, None, 0.0, 1.0, 1.0, 0.0]
    assert rows["motionsense/jog_9/sub_1"]["walking_accuracy"] == 1.0
    assert rows["sisfall/SA13/D03_SA13_R01"]["count_plausibility"] == pytest.approx(1.0, abs=0.06)
    assert rows["motionsense/ups_3/sub_1"]["count_plausibility"] is None


@pytest.mark.usefixtures("models")
def test_confusion_of_each_data_set_and_of_all(tmp_path):
    for name in ("wlk_7/sub_1", "wlk_7/sub_2", "jog_9/sub_1", "ups_3/sub_1", "std_6/sub_1"):
        motionsense_table(tmp_path / f"motionsense/{name}.csv")
    sisfall_table(tmp_path / "sisfall/SA01/D04_SA01_R01.txt")
    result = run(tmp_path)
    document = result.to_dict()
    steps = {name: sum(row.get("predicted", {}).values()) for name, row in by_name(result).items()}
    walk_1, walk_2, jog, belt = (
        steps[name]
        for name in (
            "motionsense/wlk_7/sub_1",
            "motionsense/wlk_7/sub_2",
            "motionsense/jog_9/sub_1",
            "sisfall/SA01/D04_SA01_R01",
        )
    )
    nothing = dict.fromkeys(("walking", "jogging", "running", "unknown"), 0)
    assert document["confusion"].keys() == {"all", "motionsense", "sisfall"}
    whole = document["confusion"]["all"]
    assert whole["counts"] == {
        "walking": nothing | {"walking": walk_2, "running": walk_1},
        "jogging": nothing | {"running": jog},
        "running": nothing | {"running": belt},
    }
    total = walk_1 + walk_2 + jog + belt
    assert whole["gait_accuracy"] == pytest.approx((walk_2 + belt) / total)
    assert whole["walking_accuracy"] == pytest.approx((walk_2 + jog + belt) / total)
    assert whole["balanced_accuracy"] == pytest.approx((walk_2 / (walk_1 + walk_2) + 0.0 + 1.0) / 3)
    assert document["confusion"]["sisfall"]["balanced_accuracy"] == 1.0
    assert document["groups"].keys() == {
        "motionsense/walking",
        "motionsense/jogging",
        "motionsense/upstairs",
        "motionsense/standing",
        "sisfall/running",
    }
    text = io.StringIO()
    print_benchmark(result, Console(file=text, width=300))
    for words in ("steps taken for, all", "steps taken for, sisfall", f"{whole['balanced_accuracy']:.4f}"):
        assert words in text.getvalue()


@pytest.mark.usefixtures("models")
def test_those_who_stand_have_false_steps_and_no_gait(tmp_path):
    motionsense_table(tmp_path / "motionsense/std_6/sub_1.csv")
    motionsense_table(tmp_path / "motionsense/sit_5/sub_1.csv", bounce_mps2=0.0)
    document = run(tmp_path).to_dict()
    sitting, standing = document["walks"]
    assert sitting["false_steps_per_min"] == 0.0
    assert standing["false_steps_per_min"] == pytest.approx(120.0, rel=0.05)
    assert (standing["true_class"], standing["gait_accuracy"]) == (None, None)
    assert "predicted" not in standing
    assert "confusion" not in document
    assert document["skipped"] == []


@pytest.mark.usefixtures("models")
def test_a_model_of_ones_own_labels_everybody(tmp_path):
    for person in (1, 2):
        motionsense_table(tmp_path / f"data/motionsense/wlk_7/sub_{person}.csv")
    save_model(always(Gait.JOGGING), tmp_path / "own.json")
    rows = by_name(run(tmp_path / "data", GaitParams(model=str(tmp_path / "own.json"))))
    assert {predicted(row) for row in rows.values()} == {"jogging"}


@pytest.mark.usefixtures("models")
def test_the_shipped_model_by_its_path_is_left_out_like_the_shipped_one(tmp_path):
    motionsense_table(tmp_path / "data/motionsense/wlk_7/sub_1.csv")
    save_model(always(Gait.WALKING), tmp_path / "copy.json")
    (row,) = by_name(run(tmp_path / "data", GaitParams(model=str(tmp_path / "copy.json")))).values()
    assert predicted(row) == "running"


@pytest.mark.usefixtures("models")
def test_a_model_of_ones_own_does_not_label_those_whom_it_has_seen(tmp_path):
    for person in (1, 2):
        motionsense_table(tmp_path / f"data/motionsense/wlk_7/sub_{person}.csv")
    save_model(replace(always(Gait.JOGGING), people=("motionsense/1",)), tmp_path / "own.json")
    result = run(tmp_path / "data", GaitParams(model=str(tmp_path / "own.json")))
    seen, unseen = by_name(result).values()
    assert seen["gait_accuracy"] is None
    assert "predicted" not in seen
    assert predicted(unseen) == "jogging"
    (skipped,) = result.failures
    assert skipped.walk == "motionsense/wlk_7/sub_1"
    assert "was trained on this person" in skipped.reason


def test_without_a_classifier_every_label_is_wrong(tmp_path):
    motionsense_table(tmp_path / "motionsense/wlk_7/sub_1.csv")
    (row,) = by_name(run(tmp_path, GaitParams(method="none"))).values()
    assert predicted(row) == "unknown"
    assert (row["gait_accuracy"], row["walking_accuracy"]) == (0.0, 0.0)


def test_a_walk_without_a_step_says_so(tmp_path):
    motionsense_table(tmp_path / "motionsense/jog_9/sub_1.csv", bounce_mps2=0.0)
    assert [walk.reason for walk in run(tmp_path, GaitParams(method="none")).failures] == [
        "gait_accuracy, walking_accuracy: no step found",
        "count_plausibility: nobody moves enough for a step",
    ]


def test_people_have_the_names_that_the_training_gives_them(tmp_path):
    for name in ("wlk_7/sub_1", "jog_9/sub_12"):
        motionsense_table(tmp_path / f"motionsense/{name}.csv")
    sisfall_table(tmp_path / "sisfall/SA01/D04_SA01_R01.txt")
    walks = {walk.path: walk for walk in gait.SUITE.find(tmp_path)}
    trained = {file.path: file for file in labelled_files(tmp_path)}
    assert walks.keys() == trained.keys()
    for path, walk in walks.items():
        assert walk.labels["person"] == trained[path].person == gait.person_of(read(path))


def test_an_empty_folder_is_told_what_belongs_there(tmp_path):
    with pytest.raises(RecordingError, match="give the folder that holds its data sets"):
        run(tmp_path, GaitParams(method="none"))
