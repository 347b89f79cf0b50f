"""Scores of tracks from files: exact answers, one clock, one frame, and what has no value."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pdr_est.errors import RecordingError
from pdr_est.evaluate.consistency import radius95_m
from pdr_est.evaluate.trajectories.common_clock import on_clock_of_recording, require_one_clock
from pdr_est.evaluate.trajectories.common_frame import in_metres, in_one_frame
from pdr_est.evaluate.trajectories.foreign_track import track_of_trajectory, true_positions_of
from pdr_est.evaluate.trajectories.on_recording import track_on_recording, with_surveyed_truth
from pdr_est.evaluate.trajectories.person import person_in
from pdr_est.evaluate.trajectories.scores import TRACK_METRICS, Alignment, TrajectoryScore, score_trajectory
from pdr_est.frames import Array, rotation_matrix
from pdr_est.io.trajectories import Clock, Trajectory
from pdr_est.types.recording import GeoOrigin, Recording

UNIX_S = 1_718_030_736.0
MUNICH = GeoOrigin(48.1, 11.5)
TIMES_S = np.arange(0.0, 60.0, 5.0)
WALK_M = np.column_stack([np.minimum(TIMES_S, 30.0), np.maximum(TIMES_S - 30.0, 0.0)])  # an L at 1 m/s


def trajectory(position: Array = WALK_M, time_s: Array = TIMES_S, **changes: object) -> Trajectory:
    made = Trajectory(
        place="a.csv",
        format="table",
        time_s=np.asarray(time_s, dtype=np.float64),
        clock=Clock.OWN,
        position=np.asarray(position, dtype=np.float64),
        in_degrees=False,
        device=np.full(len(position), "track"),
    )
    return replace(made, **changes)  # type: ignore[arg-type]


def scored(track: Trajectory, alignment: Alignment, truth: Trajectory | None = None) -> TrajectoryScore:
    known = truth or trajectory()
    return score_trajectory(
        track_of_trajectory(track, track.time_s), true_positions_of(known, known.time_s), alignment
    )


def degrees_of(position_m: Array, origin: GeoOrigin = MUNICH) -> Array:
    from pymap3d import enu2geodetic

    east, north = position_m.T
    latitude, longitude, _ = enu2geodetic(
        east, north, np.zeros(len(east)), origin.latitude_deg, origin.longitude_deg, 0.0
    )
    return np.column_stack([latitude, longitude])


def test_a_shifted_track_has_its_shift_as_error_and_none_after_alignment() -> None:
    found = scored(trajectory(WALK_M + np.array([3.0, 4.0])), Alignment.NONE)
    assert found.metrics["error_map_m"] == pytest.approx(5.0)
    assert found.error_quantiles_m == pytest.approx({"mean": 5.0, "median": 5.0, "p90": 5.0, "max": 5.0})
    for name in ("error_open_m", "final_drift", "ate_rigid_m", "leg_length_mae_m", "leg_vector_mae_m"):
        assert found.metrics[name] == pytest.approx(0.0, abs=1e-9)
    assert found.metrics["length_ratio"] == pytest.approx(1.0)


def test_a_track_that_is_too_long_by_a_tenth() -> None:
    found = scored(trajectory(1.1 * WALK_M), Alignment.START)
    assert found.metrics["length_ratio"] == pytest.approx(1.1)
    assert found.metrics["final_drift"] == pytest.approx(0.1 * np.hypot(30.0, 25.0) / 55.0)
    assert found.metrics["leg_length_mae_m"] == pytest.approx(0.5)
    assert found.error_m[-1] == pytest.approx(0.1 * np.hypot(30.0, 25.0))


@settings(max_examples=40, deadline=None)
@given(
    st.floats(-np.pi, np.pi),
    st.tuples(st.floats(-500.0, 500.0), st.floats(-500.0, 500.0)),
    st.integers(0, 2**31),
)
def test_metrics_with_an_alignment_do_not_depend_on_the_frame(
    angle: float, shift: tuple[float, float], seed: int
) -> None:
    noisy = WALK_M + np.random.default_rng(seed).normal(0.0, 1.0, WALK_M.shape)
    moved = noisy @ rotation_matrix(angle).T + np.array(shift)
    for alignment in (Alignment.START, Alignment.RIGID):
        a, b = (scored(trajectory(points), alignment) for points in (noisy, moved))
        assert a.metrics == pytest.approx(b.metrics, abs=1e-6)
        np.testing.assert_allclose(a.error_m, b.error_m, atol=1e-6)


def test_the_truth_is_never_interpolated_and_the_track_is() -> None:
    track = trajectory(WALK_M[[0, 6, 11]], TIMES_S[[0, 6, 11]])
    assert scored(track, Alignment.NONE).metrics["error_map_m"] == pytest.approx(0.0, abs=1e-9)


def test_true_positions_beyond_the_track_are_counted_and_standing_covers_them() -> None:
    track = trajectory(WALK_M[:9], TIMES_S[:9])
    found = scored(track, Alignment.NONE)
    assert (len(found.pairs), found.pairs.not_scored) == (9, 3)
    stood = score_trajectory(
        track_of_trajectory(track, track.time_s), true_positions_of(trajectory(), TIMES_S), Alignment.NONE, 20.0
    )
    assert stood.pairs.not_scored == 0
    assert stood.error_m[-1] == pytest.approx(15.0)
    with pytest.raises(RecordingError, match=r"1 of 12 true positions lie within its time, 55\.000 to 59\.000 s"):
        scored(trajectory(WALK_M[:2], np.array([55.0, 59.0])), Alignment.NONE)


def test_no_covariance_means_no_coverage_and_says_so() -> None:
    found = scored(trajectory(), Alignment.NONE)
    assert not {"coverage95", "nees_mean"} & set(found.metrics)
    assert found.missing["coverage95"] == "the file of the track states no covariance"


def test_coverage_of_stated_deviations() -> None:
    error_m = 2.0
    sure, unsure = (
        scored(trajectory(WALK_M + np.array([error_m, 0.0]), sigma_m=np.full(12, sigma)), Alignment.NONE)
        for sigma in (0.1, 5.0)
    )
    assert (sure.metrics["coverage95"], unsure.metrics["coverage95"]) == (0.0, 1.0)
    assert sure.metrics["nees_mean"] == pytest.approx(error_m**2 / (0.1**2 + 0.7**2))
    aligned = scored(trajectory(WALK_M, sigma_m=np.ones(12)), Alignment.RIGID)
    assert "the track is aligned" in aligned.missing["coverage95"]
    covariance = np.array([[4.0, 1.0], [1.0, 9.0]]) * np.ones((12, 1, 1))
    track = track_of_trajectory(trajectory(covariance_m2=covariance), TIMES_S)
    np.testing.assert_allclose(radius95_m(track.covariance_m2), radius95_m(covariance))


def test_every_metric_is_explained() -> None:
    found = scored(trajectory(sigma_m=np.ones(12)), Alignment.NONE)
    assert set(found.metrics) == set(TRACK_METRICS)


def test_dense_truth_is_exact_and_waypoints_are_not() -> None:
    dense = true_positions_of(trajectory(), 0.1 * TIMES_S)
    assert (dense.source, dense.sigma_m) == ("poses", 0.0)
    assert true_positions_of(trajectory(format="GPX"), 0.1 * TIMES_S).source == "gps"
    sparse = true_positions_of(trajectory(), TIMES_S)
    assert (sparse.source, sparse.sigma_m) == ("waypoints", 0.7)
    stated = trajectory(sigma_m=np.array([3.0, 4.0] * 6))
    assert true_positions_of(stated, TIMES_S).sigma_m == pytest.approx(np.sqrt(12.5))
    assert true_positions_of(stated, TIMES_S, 0.2).sigma_m == 0.2


def test_one_clock_is_needed() -> None:
    unix = trajectory(time_s=TIMES_S + UNIX_S, clock=Clock.UNIX)
    require_one_clock(trajectory(), trajectory(), None)
    require_one_clock(unix, unix, None)
    with pytest.raises(
        RecordingError, match=r"Unix time, those of a\.csv are seconds from a start of its own: write"
    ):
        require_one_clock(unix, trajectory(), None)
    require_one_clock(unix, trajectory(), -UNIX_S)
    with pytest.raises(RecordingError, match=r"\(2024-06-10T14:47:36\+00:00\) to .* the clocks differ"):
        require_one_clock(unix, trajectory(time_s=unix.time_s + 120.0, clock=Clock.UNIX), None)
    require_one_clock(unix, trajectory(time_s=unix.time_s + 120.0, clock=Clock.UNIX), None, standing_s=70.0)


def test_degrees_and_metres_need_an_origin() -> None:
    geodetic = trajectory(degrees_of(WALK_M), in_degrees=True)
    with pytest.raises(RecordingError, match=r"give its latitude and longitude \(--origin LAT LON\)"):
        in_one_frame(geodetic, trajectory())
    track, truth, origin = in_one_frame(geodetic, trajectory(), MUNICH)
    assert origin == MUNICH
    np.testing.assert_allclose(track.position, truth.position, atol=1e-4)
    track, truth, origin = in_one_frame(
        geodetic, trajectory(degrees_of(WALK_M + np.array([3.0, 4.0])), in_degrees=True)
    )
    assert scored(track, Alignment.NONE, truth).metrics["error_map_m"] == pytest.approx(5.0, abs=1e-3)
    with pytest.raises(
        RecordingError, match=r"far from the origin at 11\.5000, 48\.1000: check whether they are swapped"
    ):
        in_metres(geodetic, GeoOrigin(11.5, 48.1))


def test_degrees_in_columns_of_metres_are_noticed() -> None:
    longitude_first = degrees_of(WALK_M)[:, ::-1]
    with pytest.raises(RecordingError, match=r"x = 11\.500000, y = 48\.100000 look like degrees"):
        in_one_frame(trajectory(longitude_first), trajectory())
    with pytest.raises(RecordingError, match="look like degrees"):
        in_one_frame(trajectory(degrees_of(WALK_M), in_degrees=True), trajectory(longitude_first))
    in_one_frame(trajectory(1e-5 * WALK_M), trajectory())  # a network that hardly moves
    in_one_frame(trajectory(WALK_M + np.array([5e5, 5.3e6])), trajectory())  # UTM


def test_the_person_of_several_devices() -> None:
    names = np.array(["a", "fused"] * 6)
    person = person_in(trajectory(device=names))
    assert person.devices == ("fused",)
    assert len(person) == 6
    with pytest.raises(RecordingError, match="several devices"):
        person_in(trajectory(device=np.array(["a", "b"] * 6)))


def recording(epoch_s: float | None = None, origin: GeoOrigin | None = None) -> Recording:
    time_s = np.arange(0.0, 60.0, 0.02)
    made = Recording.from_arrays(time_s, np.tile([0.0, 0.0, 9.8], (len(time_s), 1)))
    return replace(made, epoch_s=epoch_s, origin=origin)


def test_on_the_clock_of_a_recording() -> None:
    unix = trajectory(time_s=TIMES_S + UNIX_S, clock=Clock.UNIX)
    np.testing.assert_allclose(on_clock_of_recording(unix, recording(UNIX_S)), TIMES_S)
    np.testing.assert_allclose(on_clock_of_recording(trajectory(), recording(UNIX_S)), TIMES_S)
    with pytest.raises(
        RecordingError, match=r"the date of arrays is unknown: give seconds on its own clock, 0\.000 to"
    ):
        on_clock_of_recording(unix, recording())
    with pytest.raises(RecordingError, match=r"no time, 1000\.000 to 1055\.000 s, lies within the recording"):
        on_clock_of_recording(trajectory(time_s=TIMES_S + 1000.0), recording())


def test_truth_and_tracks_of_a_recording() -> None:
    geodetic = trajectory(degrees_of(WALK_M), in_degrees=True)
    with pytest.raises(RecordingError, match="the origin of arrays on the Earth is unknown: give x_m and y_m"):
        with_surveyed_truth(recording(), geodetic)
    truth = with_surveyed_truth(recording(origin=MUNICH), geodetic).truth.positions
    assert truth is not None
    np.testing.assert_allclose(truth.position_m, WALK_M, atol=1e-4)
    track = track_on_recording(geodetic, recording(origin=MUNICH))
    np.testing.assert_allclose(track.position_m, WALK_M, atol=1e-4)
    assert np.isnan(track.covariance_m2).all()
