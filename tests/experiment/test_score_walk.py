import json
from dataclasses import replace

import numpy as np
import pytest

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.errors import ConfigError, RecordingError
from pdr_est.experiment import SUITES, comparison_on_axis, run_benchmark
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.runners.score_variants import missing_reasons
from pdr_est.experiment.scoring.known_plan import PLAN_METRICS
from pdr_est.experiment.scoring.known_start import START_METRICS
from pdr_est.experiment.scoring.profiles import PROFILE_METRICS
from pdr_est.experiment.suite import TrackScores
from pdr_est.experiment.suites import ilc20, ipin2023
from pdr_est.experiment.variants.axes import Comparison, Variant
from pdr_est.front_end.gait import GaitParams, shipped_model
from pdr_est.front_end.gait.model import save_model
from pdr_est.front_end.mode import ModeParams
from pdr_est.io import read
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import PositionFix

HELD = Config(mode=ModeParams(method="fixed"))  # made-up signals are not like those of a hand
EKF = comparison_on_axis(HELD, values=("ekf",))
ALL = comparison_on_axis(HELD, values=("dead-reckoning", "ekf", "factor-graph"))
DETECTORS = comparison_on_axis(HELD.with_estimator("ekf"), "detector", ("auto", "zero-crossing"))
HELDOUT = ("error_heldout_m", "coverage95", "nees_mean")


@pytest.fixture
def data(tmp_path, write_ilc20):
    write_ilc20(tmp_path / "ilc20/site1/F1/one.txt")
    write_ilc20(tmp_path / "ilc20/site1/F1/two.txt.gz", duration_s=25.0)
    return tmp_path


def without_seconds(document):
    return {
        **document,
        "walks": [{key: value for key, value in walk.items() if key != "seconds"} for walk in document["walks"]],
    }


def test_suite_runs_from_files_to_a_document_of_the_agreed_shape(data):
    document = run_benchmark("ilc20", data, ALL).to_dict()
    assert json.loads(json.dumps(document, allow_nan=False)) == document
    assert set(document["summary"]) == set(ilc20.SUITE.metrics)
    assert [(walk["walk"], walk["estimator"]) for walk in document["walks"]] == [
        (walk, estimator) for walk in ("site1/F1/one", "site1/F1/two") for estimator in ALL.names
    ]
    assert document["skipped"] == [
        {"walk": f"site1/F1/{walk}", "reason": f"{', '.join(PLAN_METRICS)}: no floor plan beside the recording"}
        for walk in ("one", "two")
    ]
    for walk in document["walks"]:
        assert (walk["track"], walk["mode"], walk["mode_accuracy"]) == ("device", "HOLDING", 1.0)
        assert walk["truth_points_not_scored"] == 0
        assert walk["seconds"] > 0.0
        assert walk["legs"] == walk["truth_points"] - 1
        assert walk["leg_turns"] == walk["legs"] - 1
        assert walk["leg_length_mae_m"] == pytest.approx(3.9 * abs(walk["length_ratio"] - 1.0), abs=0.35)
        # A straight walk with an exact gyroscope: only the length of the steps is not known.
        assert walk["ate_rigid_m"] == pytest.approx(abs(walk["length_ratio"] - 1.0) * rms_from_mean(walk), abs=0.35)


def rms_from_mean(walk):
    """Root mean square distance of the waypoints, 3.9 m apart on a line, from their mean."""
    along = 3.9 * np.arange(walk["truth_points"])
    return along.std()


def test_data_may_be_the_suites_own_folder(data):
    inside = run_benchmark("ilc20", data / "ilc20", EKF)
    assert without_seconds(inside.to_dict()) == without_seconds(run_benchmark("ilc20", data, EKF).to_dict())


@pytest.mark.slow
def test_number_of_processes_does_not_change_the_result(data):
    one = run_benchmark("ilc20", data, ALL, jobs=1)
    two = run_benchmark("ilc20", data, ALL, jobs=2)
    assert without_seconds(one.to_dict()) == without_seconds(two.to_dict())


def test_limit_takes_the_first_walks_and_progress_counts_them(data):
    seen = []
    result = run_benchmark("ilc20", data, EKF, limit=1, on_progress=lambda *counts: seen.append(counts))
    assert [row.walk for row in result.rows] == ["site1/F1/one"]
    assert seen == [(1, 1)]


def test_a_walk_that_cannot_be_read_is_skipped_with_its_reason(data):
    whole = (data / "ilc20/site1/F1/two.txt.gz").read_bytes()
    (data / "ilc20/site1/F1/three.txt.gz").write_bytes(whole[: len(whole) // 2])
    result = run_benchmark("ilc20", data, EKF)
    (skipped,) = [failure for failure in result.failures if failure.walk == "site1/F1/three"]
    assert "truncated gzip" in skipped.reason
    assert [row.walk for row in result.rows] == ["site1/F1/one", "site1/F1/two"]


def test_walk_without_truth_is_skipped(data, write_ilc20):
    write_ilc20(data / "ilc20/site1/F1/one.txt", every_s=1e3, duration_s=1.0)  # no waypoint before its end
    (skipped,) = run_benchmark("ilc20", data, EKF, limit=1).failures
    assert "no true positions" in skipped.reason


def test_few_points_cost_the_heldout_metrics_only_and_the_reason_is_given_once(data, write_ilc20):
    write_ilc20(data / "ilc20/site1/F1/one.txt", every_s=5.0)  # waypoints at 1, 6, 11 and 16 s
    document = run_benchmark(
        "ilc20", data, comparison_on_axis(HELD, values=("dead-reckoning", "ekf")), limit=1
    ).to_dict()
    for walk in document["walks"]:
        assert walk["truth_points"] == 4
        assert [walk[metric] for metric in HELDOUT] == [None, None, None]
        assert walk["ate_rigid_m"] is not None
    assert document["summary"]["error_heldout_m"]["n"] == 0
    assert document["skipped"] == [
        {"walk": "site1/F1/one", "reason": "error_heldout_m, coverage95, nees_mean: fewer than 5 truth points"},
        {"walk": "site1/F1/one", "reason": f"{', '.join(PLAN_METRICS)}: no floor plan beside the recording"},
        {"walk": "site1/F1/one", "reason": f"{', '.join(PROFILE_METRICS)}: no other walk of site1 to learn from"},
    ]


def test_a_recording_without_steps_is_scored_by_its_errors(data, write_ilc20):
    write_ilc20(data / "ilc20/site1/F1/one.txt", bounce_mps2=0.0)
    document = run_benchmark("ilc20", data, ALL, limit=1).to_dict()
    for walk in document["walks"]:
        assert (walk["mode"], walk["mode_accuracy"], walk["length_ratio"]) == ("UNKNOWN", None, 0.0)
        # Waypoints 3.9 m apart, the track in one place: errors 3.9 to 6 * 3.9 m, mean 3.5 * 3.9.
        assert walk["error_open_m"] == pytest.approx(3.5 * 3.9)
    assert document["skipped"] == [
        {"walk": "site1/F1/one", "reason": "leg_turn_mae_m: no leg long enough for the turn of the next one"},
        {"walk": "site1/F1/one", "reason": f"{', '.join(START_METRICS)}: no device of the walk knows north"},
        {"walk": "site1/F1/one", "reason": f"{', '.join(PLAN_METRICS)}: no floor plan beside the recording"},
        {"walk": "site1/F1/one", "reason": "mode_accuracy: no step found"},
    ]


def test_estimator_gets_no_truth_but_the_points_that_are_given(data, monkeypatch):
    given: list[tuple[PositionFix, ...]] = []
    estimate = pipeline.estimate_tracks

    def spy(walks, config, fixes=()):
        given.append(tuple(fixes))
        assert config.start.x_m is None
        assert config.start.heading_rad is None
        return estimate(walks, config, fixes)

    monkeypatch.setattr(pipeline, "estimate_tracks", spy)
    run_benchmark("ilc20", data, EKF, limit=1)
    without, sparse, start = given
    assert without == ()
    # Waypoints number 1 to 7 at 1, 4, … 19 s: number 1, 4 and 7 are given.
    assert [fix.time_s for fix in sparse] == pytest.approx([1.0, 10.0, 19.0])
    assert [fix.time_s for fix in start] == pytest.approx([1.0])


def test_a_programming_error_in_a_walk_is_not_hidden_and_names_the_walk(data, monkeypatch):
    def fail(*_):
        raise ZeroDivisionError

    monkeypatch.setattr(pipeline, "analyse_recording", fail)
    with pytest.raises(ZeroDivisionError) as caught:
        run_benchmark("ilc20", data, EKF)
    assert caught.value.__notes__ == ["in the walk site1/F1/one"]


def test_a_folder_without_walks_is_an_error(tmp_path):
    with pytest.raises(RecordingError, match="no walk of the suite oxiod: give the folder that holds oxiod/"):
        run_benchmark("oxiod", tmp_path, EKF)


@pytest.mark.parametrize(("jobs", "limit"), [(0, None), (1, 0)])
def test_numbers_out_of_range_are_refused(data, jobs, limit):
    with pytest.raises(ConfigError, match="at least 1"):
        run_benchmark("ilc20", data, EKF, jobs, limit)


def analyses(monkeypatch):
    """The configurations that the front end is run with."""
    configs: list[Config] = []
    analyse = pipeline.analyse_recording

    def spy(recording, config):
        configs.append(config)
        return analyse(recording, config)

    monkeypatch.setattr(pipeline, "analyse_recording", spy)
    return configs


def test_estimators_share_one_run_of_the_front_end(data, monkeypatch):
    configs = analyses(monkeypatch)
    run_benchmark("ilc20", data, ALL, limit=1)
    assert len(configs) == 1


def test_each_detector_gets_its_own_run_of_the_front_end(data, monkeypatch):
    configs = analyses(monkeypatch)
    result = run_benchmark("ilc20", data, DETECTORS, limit=1)
    assert [config.steps.detector for config in configs] == ["auto", "zero-crossing"]
    assert [row.variant for row in result.rows] == ["auto", "zero-crossing"]
    assert {walk["estimator"] for walk in result.to_dict()["walks"]} == {"ekf"}
    one, other = (row.metrics["ate_rigid_m"] for row in result.rows)
    assert one != other
    assert result.to_dict()["detector"] == "all"


def test_ipin2023_stages_see_nothing_before_the_first_surveyed_point(tmp_path, write_ilc20):
    recording = read(write_ilc20(tmp_path / "log.txt"))
    part = ipin2023.from_first_point(recording)
    assert float(part.devices[0].specific_force.time_s[0]) == pytest.approx(1.0)
    assert float(part.devices[0].rotation_rate.time_s[0]) == pytest.approx(1.0)
    assert len(part.truth.positions.time_s) == len(recording.truth.positions.time_s)


def test_cpu_time_adds_up_front_end_and_estimates(data):
    recording = read(data / "ilc20/site1/F1/one.txt")
    walk = AnalysedWalk(
        recording, pipeline.analyse_recording(recording, Config()), Config().with_estimator("ekf"), 100.0
    )
    walk.track()
    once = walk.seconds
    walk.track([PositionFix(1.0, np.zeros(2), np.eye(2))])
    assert 100.0 < once < walk.seconds < 110.0


def test_the_estimator_runs_once_for_the_same_fixes(data):
    recording = read(data / "ilc20/site1/F1/one.txt")
    walk = AnalysedWalk(recording, pipeline.analyse_recording(recording, Config()), Config().with_estimator("ekf"))
    first, other = (walk.track([PositionFix(1.0, np.full(2, x), np.eye(2))]) for x in (0.0, 1.0))
    seconds = walk.seconds
    assert walk.track([PositionFix(1.0, np.zeros(2), np.eye(2))]) is first
    assert other is not first
    assert walk.seconds == seconds
    assert len(walk.tracks) == 2


@pytest.mark.slow
@pytest.mark.parametrize("suite", [suite.name for suite in SUITES])
def test_suites_score_the_real_recordings(shared_data, suite):
    document = run_benchmark(suite, shared_data, EKF, limit=4).to_dict()
    assert len({walk["walk"] for walk in document["walks"]}) == 4
    assert not [walk for walk in document["skipped"] if ":" not in walk["reason"]]


def test_missing_value_that_no_reason_explains_is_told():
    scores = TrackScores("device", "HOLDING", dict.fromkeys(ilc20.SUITE.metrics, 1.0) | {"nees_mean": np.nan})
    assert missing_reasons(ilc20.SUITE, scores) == ["nees_mean: not a finite number"]


def test_a_metric_that_does_not_apply_needs_no_reason():
    scores = TrackScores("device", "HOLDING", {"nees_mean": 1.0}, missing={"coverage95": "too dark"})
    assert missing_reasons(ilc20.SUITE, scores) == ["coverage95: too dark"]


def test_doubtful_findings_are_counted(data, monkeypatch):
    estimate = pipeline.estimate_tracks
    found = tuple(Finding(FindingKind.NORTH, str(k), doubtful=k < 2) for k in range(3))

    def with_findings(walks, config, fixes=()):
        return replace(estimate(walks, config, fixes), findings=found if fixes else ())

    monkeypatch.setattr(pipeline, "estimate_tracks", with_findings)
    document = run_benchmark("ilc20", data, EKF, limit=1).to_dict()
    assert [walk["findings"] for walk in document["walks"]] == [2]


def test_settings_that_no_walk_can_use_end_the_run(data, tmp_path):
    path = tmp_path / "gone.json"
    save_model(shipped_model("auto"), path)
    gone = replace(HELD.with_estimator("ekf"), gait=GaitParams(model=str(path)))
    path.unlink()  # the file vanishes after the configuration was read
    variant = Variant("ekf", gone)
    with pytest.raises(ConfigError, match=r"gone\.json"):
        run_benchmark("ilc20", data, Comparison("estimator", (variant,), variant))


def test_a_missing_table_of_a_walk_is_named(tmp_path):
    walk = tmp_path / "phone_person_floor_hand_1"
    walk.mkdir()
    (walk / "stepcounter.csv").write_text("1,0,0\n")
    with pytest.raises(RecordingError, match=r"hand_1: no accelerometer\.csv beside stepcounter\.csv"):
        run_benchmark("oxford-steps", tmp_path, EKF)


def test_the_name_of_a_skipped_walk_is_said_once(data, monkeypatch):
    def refuse(recording, config):
        raise RecordingError(f"{recording.name}: too dull")

    monkeypatch.setattr(pipeline, "analyse_recording", refuse)
    assert {skipped.reason for skipped in run_benchmark("ilc20", data, EKF).failures} == {"too dull"}
