"""The experiments on UPTIME's Tables II and IV: their arithmetic, and that the recorded files tell the same."""

import json
import runpy
from pathlib import Path

import numpy as np
import pytest

from pdr_est.evaluate.gait_recognition import accuracies
from pdr_est.experiment.suite import ConfusionMatrix
from pdr_est.front_end.gait.training_data import LabelledSteps, step_table
from pdr_est.types.steps import Gait

EXPERIMENTS = Path(__file__).resolve().parents[2] / "experiments"
TABLE_2 = runpy.run_path(str(EXPERIMENTS / "uptime_table2.py"))
TABLE_4 = runpy.run_path(str(EXPERIMENTS / "uptime_table4.py"))
DETAILS = (EXPERIMENTS / "paper-details.md").read_text(encoding="utf-8")


def recorded(name):
    """Document and text in the results."""
    text = (EXPERIMENTS / f"results/{name}.txt").read_text(encoding="utf-8")
    return json.loads((EXPERIMENTS / f"results/{name}.json").read_text(encoding="utf-8")), text


# --- Table II ----------------------------------------------------------------------------------------------------


def test_table_2_averages_over_the_recordings_of_a_group():
    def walk(activity, step_m):
        factors = zip(TABLE_2["MODELS"], (1, 2, 3), strict=True)
        lengths = {model: np.full(10, factor * step_m) for model, factor in factors}
        return TABLE_2["Walk"](activity, 5.0, lengths)

    rows = TABLE_2["as_document"]([walk("wlk", 0.5), walk("D04", 1.0), walk("wlk", 0.8)])
    assert [(row["what"], row["recordings"], row["paper_m"]) for row in rows] == [
        ("pocket, walking", 2, 0.74),
        ("belt, quick jog", 1, 1.70),
    ]
    assert rows[0]["models"]["auto"] == {"length_m": [0.65, 0.5, 0.8], "speed_mps": [1.3, 1.0, 1.6]}
    assert rows[1]["models"]["gait-table"]["length_m"] == [3.0, 3.0, 3.0]


def test_table_2_as_recorded():
    document, text = recorded("uptime_table2")
    assert TABLE_2["as_text"](document) == text
    assert TABLE_2["as_markdown"](document) in DETAILS
    assert [row["recordings"] for row in document] == [36, 16, 12, 12, 12, 12]
    for row in document:
        assert row["paper_m"] == TABLE_2["PAPER_M"][dict(TABLE_2["GROUPS"].values())[row["what"]]]


@pytest.mark.slow
def test_table_2_walks_real_recordings(shared_data, tmp_path):
    person = tmp_path / "sisfall" / "SA02"
    person.mkdir(parents=True)
    for path in (shared_data / "sisfall" / "SA02").iterdir():
        (person / path.name).symlink_to(path)
    walks = {walk.activity: walk for walk in TABLE_2["measured"](tmp_path)}
    assert walks.keys() == {"D01", "D02", "D03", "D04"}
    speeds = [walks[activity].speed_mps("auto") for activity in ("D01", "D02", "D03", "D04")]
    assert speeds == sorted(speeds)
    assert walks["D01"].mean_m("gait-table") == pytest.approx(0.74, abs=0.02)


# --- Table IV ----------------------------------------------------------------------------------------------------


def test_table_4_of_the_paper_gives_the_papers_accuracy():
    paper = TABLE_4["paper"]()
    assert paper.counts.sum() == 1286
    assert paper.percent()["gait_accuracy"] == 97.74
    assert paper.percent()["walking_accuracy"] == pytest.approx(100.0 * (1286 - 1 - 18 - 5) / 1286, abs=0.005)


def test_table_4_takes_the_counts_of_the_suite():
    labels = dict.fromkeys(("walking", "jogging", "running", "unknown"), 0)
    counts = TABLE_4["counts_of"](
        ConfusionMatrix({"walking": labels | {"walking": 5}, "jogging": labels | {"running": 2, "unknown": 1}}, {})
    )
    assert counts[Gait.WALKING].tolist() == [0, 5, 0, 0]
    assert counts[Gait.JOGGING].tolist() == [1, 0, 0, 2]
    assert counts.sum() == 8


def test_table_4_as_recorded():
    document, text = recorded("uptime_table4")
    table = []
    for entry in document:
        counts = np.zeros((4, 4), dtype=np.int64)
        for gait, row in entry["counts"].items():
            counts[Gait[gait.upper()], 1:] = row
        table.append(TABLE_4["Matrix"](entry["who"], entry["split"], entry["where"], counts))
    assert TABLE_4["as_text"](table) == text
    assert TABLE_4["as_document"](table) == document
    assert TABLE_4["as_markdown"](table) in DETAILS
    sets = TABLE_4["SETS"]
    assert [(matrix.who, matrix.split, matrix.where) for matrix in table] == [
        ("paper", "not said", "hand, pocket"),
        *(
            (who, split, data_set)
            for who in ("published", "stride")
            for split in ("random steps", "people left out")
            for data_set in sets
        ),
        *((who, "people left out", data_set) for who in ("uptime", "auto") for data_set in sets),
    ]
    by_random, left_out = (table[1].percent(), table[3].percent())
    assert by_random["walking_accuracy"] >= 98.0  # the paper's 98.13
    assert left_out["walking_accuracy"] < by_random["walking_accuracy"]
    both = sum(matrix.counts for matrix in table[-2:])
    assert 100.0 * accuracies(both)["walking_accuracy"] >= 99.3
    assert table[-1].percent()["balanced_accuracy"] >= 89.0


def made_up_steps(people=6, steps=40, gaits=(Gait.WALKING, Gait.JOGGING, Gait.RUNNING)):
    """Steps whose features tell the gait, on another scale for each person."""
    rng = np.random.default_rng(0)
    return step_table(
        [
            LabelledSteps(
                f"person {person}",
                "made up",
                gait,
                (3.0 * gait + person / people + 0.1 * rng.standard_normal((steps, 1))) * np.ones(6),
                np.zeros(steps, dtype=bool),
            )
            for person in range(people)
            for gait in gaits
        ]
    )


def test_the_published_classifier_tells_gaits_that_differ_and_needs_no_runner():
    for gaits in ((Gait.WALKING, Gait.JOGGING, Gait.RUNNING), (Gait.WALKING, Gait.JOGGING)):
        table = made_up_steps(gaits=gaits)
        for split in TABLE_4["SPLITS"]:
            labels = TABLE_4["cross_validated"](table, TABLE_4["folds_of"](table, split))
            counts = TABLE_4["counts_of_labels"](table.gait, labels)
            assert counts.sum() == len(table)
            assert accuracies(counts)["gait_accuracy"] > 0.99


def test_splits_of_table_4():
    table = made_up_steps()
    people = TABLE_4["folds_of"](table, "people left out")
    assert all(len(set(people[table.person == person])) == 1 for person in set(table.person.tolist()))
    assert len(set(people)) == 6
    steps = TABLE_4["folds_of"](table, "random steps")
    assert np.bincount(steps).tolist() == [len(table) // 10] * 10
    assert len(set(steps[table.person == "person 0"])) > 5
