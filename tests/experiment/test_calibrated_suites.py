"""The suites with known lengths: what is scored, and calibration on other walks only, on tiny made-up walks."""

import math
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from result_rows import result_row
from small_sets import N_STEPS, bouncing, crests_s, plain_table, write

from pdr_est.calibration.step_length_fit import SIGMA_LOG_SCALE, SIGMA_WALK, Calibration, ScaleObservation
from pdr_est.config import Config
from pdr_est.experiment import comparison_on_axis, run_benchmark
from pdr_est.experiment.scoring.calibrated import with_calibrated
from pdr_est.front_end.mode import ModeParams
from pdr_est.front_end.step_length import StepLengthParams
from pdr_est.types.outcome import TrackOutcome

STEP_M = 0.415 * 1.73  # of the model `static`
CONFIG = Config(mode=ModeParams(method="fixed"), step_length=StepLengthParams(model="static"))
SHRINKAGE = SIGMA_LOG_SCALE**2 / (SIGMA_LOG_SCALE**2 + SIGMA_WALK**2)  # of one walk towards the model


def run(suite, data, **options):
    return run_benchmark(suite, data, comparison_on_axis(CONFIG), **options).to_dict()


def stride_table(path: Path, scale: float, first_stride_end: int = 3, outlier: int | None = None) -> None:
    """Somebody whose strides are `scale` times those of the model; one of them perhaps mismeasured as 9 m."""
    ends = crests_s()[first_stride_end::2]
    walked, rows = 0.0, []
    for t, up in zip(*bouncing(100.0), strict=True):
        number = int(np.searchsorted(ends, t, side="right"))
        length = 0.0 if number == 0 else 9.0 if number == outlier else 2.0 * STEP_M * scale
        walked = number * length
        rows.append(
            f"test 0 0 {up:.4f} 0 0 0 20 0 -40 {1_540_000_000_000 + round(1e3 * t)} {length} {number} {walked}"
        )
    write(path, rows)


def stride_set(folder: Path, *scales: float) -> None:
    for i, scale in enumerate(scales):
        stride_table(folder / f"stride-length/PDR_Raw_{i}.txt", scale)


# --- stride-length -----------------------------------------------------------------------------------------------


def test_strides_are_two_steps_and_outliers_and_ends_are_left_out(tmp_path):
    stride_table(tmp_path / "stride-length/PDR_Raw_0.txt", 1.25, outlier=7)
    document = run("stride-length", tmp_path)
    (walk,) = document["walks"]
    complete = len(crests_s()[3::2]) - 1  # the first has no beginning
    assert walk["true_strides"] == complete - 2  # without the outlier and the last
    assert abs(walk["detected_steps"] - 2 * walk["true_strides"]) <= 1
    for name in ("stride_error", "stride_error_by_time", "distance_error"):
        assert walk[name] == pytest.approx(0.2, abs=0.01), name  # 1 of 1.25
    (skipped,) = document["skipped"]
    assert skipped["reason"].endswith("_calibrated: fewer than 1 other walks to calibrate on")
    assert walk["stride_error_calibrated"] is None


def test_calibration_is_on_each_other_walk_in_turn(tmp_path):
    stride_set(tmp_path, 1.2, 1.2, 0.9)
    document = run("stride-length", tmp_path)
    assert document["skipped"] == []
    first, second, third = document["walks"]
    like = abs(1.2**SHRINKAGE / 1.2 - 1.0)
    unlike = abs(0.9**SHRINKAGE / 1.2 - 1.0)
    assert first["distance_error_calibrated"] == pytest.approx((like + unlike) / 2.0, abs=0.005)
    assert first["stride_error_calibrated"] == pytest.approx((like + unlike) / 2.0, abs=0.005)
    assert first["stride_error_by_time_calibrated"] == pytest.approx((like + unlike) / 2.0, abs=0.005)
    assert second["distance_error_calibrated"] == pytest.approx(first["distance_error_calibrated"], abs=1e-9)
    assert third["distance_error_calibrated"] == pytest.approx(1.2**SHRINKAGE / 0.9 - 1.0, abs=0.01)


def test_variants_are_calibrated_on_walks_of_their_own_kind(tmp_path):
    stride_set(tmp_path, 1.2, 1.1)
    both = run_benchmark(
        "stride-length", tmp_path, comparison_on_axis(CONFIG, "length-model", ["static", "auto"])
    ).to_dict()
    of_static = [walk for walk in both["walks"] if walk["length-model"] == "static"]
    alone = run("stride-length", tmp_path)["walks"]
    for name in ("distance_error", "distance_error_calibrated", "stride_error_calibrated"):
        assert [walk[name] for walk in of_static] == [walk[name] for walk in alone]


@pytest.mark.slow
def test_the_same_in_several_processes(tmp_path):
    stride_set(tmp_path, 1.1, 1.2, 0.9)
    one, two = (run("stride-length", tmp_path, jobs=jobs)["summary"] for jobs in (1, 2))
    assert one == two
    assert one["stride_error_calibrated"]["n"] == 3


def test_somebody_without_steps_is_scored_and_takes_no_part(tmp_path):
    stride_set(tmp_path, 1.2, 1.2)
    rows = [
        f"test 0 0 9.8 0 0 0 20 0 -40 {1_540_000_000_000 + 10 * i} {1.2 * (i >= 100)} {i // 100} {1.2 * (i // 100)}"
        for i in range(1000)
    ]
    write(tmp_path / "stride-length/PDR_Raw_9.txt", rows)
    document = run("stride-length", tmp_path)
    still = document["walks"][-1]
    assert (still["stride_error"], still["distance_error"], still["stride_error_calibrated"]) == (1.0, 1.0, None)
    (skipped,) = document["skipped"]
    assert (skipped["walk"], skipped["reason"].rsplit(": ", 1)[1]) == ("PDR_Raw_9", "no step found")
    assert document["walks"][0]["distance_error_calibrated"] == pytest.approx(
        1.0 - 1.2 ** (SHRINKAGE - 1.0), abs=0.01
    )


def test_the_stated_uncertainty_of_the_scale_is_measured(tmp_path):
    stride_set(tmp_path, 1.05, 1.05, 1.3)
    first, second, third = run("stride-length", tmp_path)["walks"]
    assert [walk["scale_coverage68"] for walk in (first, second, third)] == [1.0, 1.0, 0.0]  # within 11 %
    # On each other, the first two are right; on the third one they are far too long, and it is too short on them.
    assert [walk["scale_coverage68_calibrated"] for walk in (first, second, third)] == [0.5, 0.5, 0.0]
    vague = replace(CONFIG, odometry=replace(CONFIG.odometry, sigma_length_scale=0.3))
    document = run_benchmark("stride-length", tmp_path, comparison_on_axis(vague)).to_dict()
    assert document["summary"]["scale_coverage68"]["mean"] == 1.0


def test_why_no_stride_can_be_scored(tmp_path):
    rows = [
        f"test 0 0 9.8 0 0 0 20 0 -40 {1_540_000_000_000 + 10 * i} {4.0 * (i >= 100)} {i // 100} {4.0 * (i // 100)}"
        for i in range(400)
    ]
    write(tmp_path / "stride-length/PDR_Raw_0.txt", rows)
    (skipped,) = run("stride-length", tmp_path)["skipped"]
    assert skipped["reason"] == (
        "no stride to compare with: 2 measured from beginning to end, left out 1 above 3 m and the last"
    )


# --- known-distance ----------------------------------------------------------------------------------------------


def test_known_distance_is_calibrated_on_every_pair_of_others(tmp_path):
    folder = tmp_path / "known-distance"
    scales = {"A": 1.2, "B": 1.2, "C": 0.9, "D": 1.0}
    for name in scales:
        plain_table(folder / f"{name}.csv")
    length_m = N_STEPS * STEP_M
    write(
        folder / "truth.csv",
        [
            "file,distance_m,steps",
            *(f"{name}.csv,{length_m * scale:.4f},{N_STEPS}" for name, scale in scales.items()),
        ],
    )
    document = run("known-distance", tmp_path)
    assert document["skipped"] == []
    walk = document["walks"][0]
    # The first or last step of so short a walk may be missed, or have begun before it: D's true scale is 1.
    counted = 1.0 - document["walks"][3]["distance_error"]
    shrinkage = 2.0 * SIGMA_LOG_SCALE**2 / (2.0 * SIGMA_LOG_SCALE**2 + SIGMA_WALK**2)
    errors = []
    for a, b in combinations((1.2, 0.9, 1.0), 2):
        fitted = math.exp(shrinkage * 0.5 * (math.log(a / counted) + math.log(b / counted)))
        errors.append(abs(fitted * counted / 1.2 - 1.0))
    # One cadence: the exponent is not learnt, and evens out within each walk but for its square.
    assert walk["distance_error_calibrated"] == pytest.approx(np.mean(errors), abs=5e-4)
    # The model is off by 20, 20, 10 and 0 %. Only D lies between pairs of the others: two of three, A or B with C.
    assert [walk["scale_coverage68"] for walk in document["walks"]] == [0.0, 0.0, 1.0, 1.0]
    covered = [walk["scale_coverage68_calibrated"] for walk in document["walks"]]
    assert covered == pytest.approx([0.0, 0.0, 0.0, 2.0 / 3.0])


# --- what a calibration may see ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Case:
    """A walk that says which scale it was given."""

    scale: float

    @property
    def observation(self) -> ScaleObservation:
        return ScaleObservation(math.log(self.scale), 0.0, 0.6)

    def errors(self, calibration: Calibration) -> dict[str, float]:
        return {"scale": float(calibration.mean[0])}


def row(walk: str, track: str, variant: str) -> TrackOutcome:
    return result_row(walk, variant, {"error": 1.0}, track)


def test_a_walk_never_sees_itself_nor_another_variant():
    """Two phones on each of three walks, with two models: of 12 rows, each learns from the four of other walks."""
    keys = [(walk, track, variant) for variant in "XY" for walk in "abc" for track in ("left", "right")]
    scales = dict(zip(keys, np.linspace(0.7, 1.4, len(keys)), strict=True))
    rows, missing = with_calibrated([row(*key) for key in keys], [Case(scales[key]) for key in keys], 1, ("scale",))
    assert missing == {}
    for key, completed in zip(keys, rows, strict=True):
        others = [math.log(scales[of]) for of in keys if of[0] != key[0] and of[2] == key[2]]
        assert len(others) == 4
        assert (completed.walk, completed.track, completed.variant) == key
        assert completed.metrics == {"error": 1.0, "scale": pytest.approx(SHRINKAGE * np.mean(others))}


def test_the_other_phone_of_a_walk_is_not_another_walk():
    rows = [row("a", "left", "X"), row("a", "right", "X"), row("a", "left", "Y"), row("b", "left", "Y")]
    cases = [Case(1.1), Case(1.2), Case(1.1), None]
    completed, missing = with_calibrated(rows, cases, 1, ("scale",))
    assert [one.metrics for one in completed] == [one.metrics for one in rows]
    assert missing == {"a": "scale: fewer than 1 other walks to calibrate on"}
