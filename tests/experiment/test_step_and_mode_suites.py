"""The suites with annotated steps, counts, fixes or activities, on tiny made-up walks with a known answer."""

import numpy as np
import pytest
from small_sets import (
    N_STEPS,
    crests_s,
    motionsense_table,
    oxford_walk,
    plain_table,
    weallwalk_annotation,
    weallwalk_table,
    write,
)

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.experiment import comparison_on_axis, run_benchmark
from pdr_est.experiment.suites import oxford_steps, phone_gps
from pdr_est.front_end.mode import ModeParams
from pdr_est.io import read
from pdr_est.types.steps import CarryingMode

HELD = Config(mode=ModeParams(method="fixed"))
POCKET = Config(mode=ModeParams(method="fixed", fixed="POCKET"))


def run(suite, data, config=HELD):
    return run_benchmark(suite, data, comparison_on_axis(config)).to_dict()


@pytest.fixture
def no_estimator(monkeypatch):
    def fail(*_):
        pytest.fail("an estimator was run")

    monkeypatch.setattr(pipeline, "estimate_tracks", fail)


# --- oxford-steps ------------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("no_estimator")
def test_oxford_steps_are_compared_with_the_contacts_whatever_their_delay(tmp_path):
    true_s = crests_s()[4:34]  # the annotation ends before the walk
    oxford_walk(tmp_path / "oxford-steps/Phone_Ann_Hard_InHand_1", true_s + 0.15)
    oxford_walk(tmp_path / "oxford-steps/Phone_Ann_Hard_FrontPocket_2", np.delete(true_s, [10, 20, 25]))
    document = run("oxford-steps", tmp_path)
    assert document["skipped"] == []
    pocket, hand = document["walks"]
    assert (hand["walk"], pocket["walk"]) == ("Phone_Ann_Hard_InHand_1", "Phone_Ann_Hard_FrontPocket_2")
    assert [hand[name] for name in ("phone", "person", "floor", "position")] == ["Phone", "Ann", "Hard", "InHand"]
    assert (hand["count_error"], hand["step_precision"], hand["step_recall"]) == (0.0, 1.0, 1.0)
    assert (hand["true_steps"], hand["detected_steps"]) == (30, 30)
    # Three contacts are missing: 30 detected steps against 27.
    assert pocket["count_error"] == pytest.approx(3 / 27)
    assert (pocket["step_precision"], pocket["step_recall"]) == (pytest.approx(27 / 30), 1.0)
    assert document["estimator"] == "factor-graph"
    assert document["groups"].keys() == {"FrontPocket", "InHand"}


@pytest.mark.usefixtures("no_estimator")
def test_oxford_walk_without_annotation_is_skipped(tmp_path):
    oxford_walk(tmp_path / "Phone_Ann_Hard_InHand_1", crests_s())
    (tmp_path / "Phone_Ann_Hard_InHand_1/stepcounter.csv").unlink()
    document = run("oxford-steps", tmp_path)
    assert document["walks"] == []
    (skipped,) = document["skipped"]
    assert "no annotated step" in skipped["reason"]


def test_oxford_folders_of_another_build_have_no_labels():
    assert set(oxford_steps.labels_of("mine").values()) == {None}
    assert oxford_steps.labels_of("Pixel_Jamie_Carpet_Purse_12")["position"] == "Purse"


# --- weallwalk ---------------------------------------------------------------------------------------------------


def test_weallwalk_scores_both_phones_of_a_walk(tmp_path):
    for device in ("1L", "2R"):
        weallwalk_table(tmp_path / f"weallwalk/sensor/iPhoneSensors_T1_ID2_{device}_WC.csv")
    weallwalk_annotation(tmp_path / "weallwalk/xml/T1_ID2_WC.xml", crests_s()[2:38], [(8.0, 30.0), (14.0, 60.0)])
    document = run("weallwalk", tmp_path)
    assert document["skipped"] == []
    assert [walk["walk"] for walk in document["walks"]] == ["sensor/iPhoneSensors_T1_ID2_1L_WC"] * 3
    assert [walk["track"] for walk in document["walks"]] == ["1L", "2R", "fused"]
    for walk in document["walks"]:
        assert (walk["aid"], walk["count_error"], walk["step_recall"]) == ("WC", 0.0, 1.0)
        # The phone goes straight ahead: nothing of 30 and 60 degrees, median 45, sum 90.
        assert walk["turn_error_deg"] == pytest.approx(45.0, abs=0.1)
        assert walk["heading_net_error_deg"] == pytest.approx(90.0, abs=0.1)
    assert document["summary"]["count_error"]["n"] == 3


def test_weallwalk_turns_before_the_annotated_walk_do_not_count(tmp_path):
    weallwalk_table(tmp_path / "sensor/iPhoneSensors_T1_ID2_1L_NA.csv", turning_until_s=2.0)
    weallwalk_annotation(tmp_path / "xml/T1_ID2_NA.xml", crests_s()[7:38], [(12.0, 60.0)])
    (walk,) = run("weallwalk", tmp_path)["walks"]
    assert walk["heading_net_error_deg"] == pytest.approx(60.0, abs=1.0)


def test_weallwalk_walk_without_turns_is_scored_by_its_steps(tmp_path):
    weallwalk_table(tmp_path / "sensor/iPhoneSensors_T1_ID2_2R_NA.csv")
    weallwalk_annotation(tmp_path / "xml/T1_ID2_NA.xml", crests_s()[2:38], [])
    document = run("weallwalk", tmp_path)
    (walk,) = document["walks"]
    assert (walk["track"], walk["count_error"], walk["turn_error_deg"]) == ("device", 0.0, None)
    assert [skipped["reason"] for skipped in document["skipped"]] == [
        "turn_error_deg, heading_net_error_deg: no annotated turn"
    ]


# --- known-distance ----------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("no_estimator")
def test_known_distance_compares_all_steps_with_the_table(tmp_path):
    folder = tmp_path / "known-distance"
    for name in ("A", "B", "C"):
        plain_table(folder / f"{name}.csv")
    write(folder / "truth.csv", ["file,distance_m,steps", f"A.csv,25.0,{N_STEPS}", f"B.csv,50.0,{2 * N_STEPS}"])
    document = run("known-distance", tmp_path)
    a, b = document["walks"]
    assert abs(a["detected_steps"] - N_STEPS) <= 1
    assert a["count_error"] == abs(a["detected_steps"] - N_STEPS) / N_STEPS
    assert b["count_error"] == abs(a["detected_steps"] - 2 * N_STEPS) / (2 * N_STEPS)
    # The same walk against 25 and 50 m: it is between, and the two errors tell the same length.
    assert 50.0 * (1.0 - b["distance_error"]) == pytest.approx(25.0 * (1.0 + a["distance_error"]))
    skipped = {walk["walk"]: walk["reason"] for walk in document["skipped"]}
    assert set(skipped) == {"A", "B", "C"}
    assert "not in truth.csv" in skipped["C"]
    lacking = "distance_error_calibrated, scale_coverage68_calibrated"
    assert skipped["A"] == f"{lacking}: fewer than 2 other walks to calibrate on"


def test_known_distance_without_its_table_has_no_walk(tmp_path):
    plain_table(tmp_path / "known-distance/A.csv")
    with pytest.raises(RecordingError, match=r"no truth\.csv beside the recordings"):
        run("known-distance", tmp_path)


# --- phone-gps ---------------------------------------------------------------------------------------------------


def test_phone_gps_scores_against_fixes_that_no_estimator_sees(tmp_path, monkeypatch):
    given = []
    estimate = pipeline.estimate_tracks

    def spy(walks, config, fixes=()):
        given.append(tuple(fixes))
        return estimate(walks, config, fixes)

    monkeypatch.setattr(pipeline, "estimate_tracks", spy)
    plain_table(tmp_path / "phone-gps/Soccer_swing1.csv", speed_mps=1.3)
    plain_table(tmp_path / "phone-gps/Basket_1.csv", speed_mps=1.3)
    document = run("phone-gps", tmp_path)
    assert document["skipped"] == []
    assert given == [(), ()]
    held, swung = document["walks"]
    assert (held["walk"], held["mode_accuracy"]) == ("Basket_1", 1.0)
    assert (swung["walk"], swung["mode_accuracy"]) == ("Soccer_swing1", 0.0)  # the mode is fixed to HOLDING here
    # A straight walk: the error of the track is that of its length alone.
    along = 1.3 * np.arange(20.0)
    assert held["ate_rigid_m"] == pytest.approx(abs(held["length_ratio"] - 1.0) * along.std(), abs=0.4)


def test_phone_gps_truth_is_marked_as_gps_and_no_fix_is_left(tmp_path):
    plain_table(tmp_path / "Basket_1.csv", speed_mps=1.3)
    recording = phone_gps.with_fixes_as_truth(read(tmp_path / "Basket_1.csv"))
    assert recording.fixes == ()
    assert recording.truth.positions.source == "gps"
    np.testing.assert_allclose(recording.truth.positions.position_m[:, 1], 1.3 * np.arange(20.0), atol=0.1)


def test_phone_gps_without_fixes_is_skipped(tmp_path):
    plain_table(tmp_path / "Basket_1.csv")
    (skipped,) = run("phone-gps", tmp_path)["skipped"]
    assert "no GPS fix" in skipped["reason"]


# --- motionsense -------------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("no_estimator")
def test_motionsense_scores_the_mode_of_those_who_move_and_the_steps_of_those_who_rest(tmp_path):
    for activity in ("wlk_7", "jog_9", "ups_3", "std_6"):
        motionsense_table(tmp_path / f"motionsense/{activity}/sub_1.csv")
    document = run("motionsense", tmp_path, POCKET)
    assert document["skipped"] == []
    walks = {walk["walk"]: walk for walk in document["walks"]}
    assert walks.keys() == {"wlk_7/sub_1", "jog_9/sub_1", "ups_3/sub_1", "std_6/sub_1"}
    assert {name: walk["mode_accuracy"] for name, walk in walks.items() if walk["activity"] != "std"} == {
        "wlk_7/sub_1": 1.0,
        "jog_9/sub_1": 1.0,
        "ups_3/sub_1": 1.0,
    }
    # Somebody who is said to stand, but bounces: two steps a second are 120 a minute.
    assert walks["std_6/sub_1"]["mode_accuracy"] is None
    assert walks["std_6/sub_1"]["false_steps_per_min"] == pytest.approx(120.0, rel=0.05)
    assert document["summary"]["mode_accuracy"]["n"] == 2
    assert document["summary"]["false_steps_per_min"]["n"] == 1
    assert document["groups"]["ups"]["mode_accuracy"]["n"] == 1


@pytest.mark.usefixtures("no_estimator")
def test_motionsense_standing_still_has_no_false_step(tmp_path):
    motionsense_table(tmp_path / "std_6/sub_1.csv", bounce_mps2=0.0)
    (walk,) = run("motionsense", tmp_path)["walks"]
    assert walk["false_steps_per_min"] == 0.0


def test_the_true_mode_is_the_data_sets_and_not_the_recognised_one(tmp_path):
    motionsense_table(tmp_path / "wlk_7/sub_1.csv")
    (walk,) = run("motionsense", tmp_path, HELD)["walks"]
    assert (walk["mode"], walk["mode_accuracy"]) == (CarryingMode.HOLDING.name, 0.0)
