"""Regions of poses: mixtures, their 95 % regions, and how a track carries them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import pdr_est
from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.writers.standing_poses import with_standing_poses
from pdr_est.types.region import PoseRegion, ellipses_of_poses
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track, concatenate
from pdr_est.types.track_output.table import REGION_COLUMNS

UNUSED = np.full((2, 2), np.nan)


def mixture(*components: tuple[float, tuple[float, float], Array]) -> PoseRegion:
    """Region of one pose with these weights, means and covariances."""
    missing = 3 - len(components)
    weight = [one[0] for one in components] + [0.0] * missing
    mean = [one[1] for one in components] + [(np.nan, np.nan)] * missing
    covariance = [one[2] for one in components] + [UNUSED] * missing
    return PoseRegion(np.array([weight]), np.array([mean]), np.array([covariance]))


FORK = mixture((0.7, (0.0, 0.0), np.diag([4.0, 0.25])), (0.3, (10.0, 8.0), np.diag([0.25, 4.0])))
BEND = mixture((0.6, (-2.0, 0.0), np.diag([4.0, 0.3])), (0.4, (0.0, 2.0), np.diag([0.3, 4.0])))
TRACE = mixture((0.98, (0.0, 0.0), np.eye(2)), (0.02, (20.0, 0.0), np.eye(2)))


def track(count: int = 4, region: PoseRegion | None = None) -> Track:
    time_s = 2.0 * np.arange(count)
    return Track(
        time_s=time_s,
        moving_from_s=np.maximum(time_s - 0.5, 0.0),
        device=np.array(["phone"] * count),
        position_m=np.column_stack([time_s, np.zeros(count)]),
        heading_rad=np.zeros(count),
        covariance_m2=np.repeat(np.eye(2)[None], count, axis=0),
        sigma_heading_rad=np.full(count, 0.1),
        mode=np.full(count, CarryingMode.HOLDING, dtype=np.int8),
        step_length_m=np.full(count, 2.0),
        kind="smoothed",
        estimator="particle",
        region=region,
    )


def forked(count: int = 4) -> PoseRegion:
    """Region of poses of which the third lies at one of two places."""
    single = PoseRegion.of_gaussians(track(count).position_m, track(count).covariance_m2)
    for whole, part in zip(
        (single.weight, single.mean_m, single.covariance_m2),
        (FORK.weight, FORK.mean_m, FORK.covariance_m2),
        strict=True,
    ):
        whole[2] = part[0]
    return single


def sample(region: PoseRegion, count: int, sigma_m: float = 0.0) -> Array:
    """Points (count, 2) drawn from the mixture of the only pose."""
    rng = np.random.default_rng(1)
    which = rng.choice(3, size=count, p=region.weight[0])
    factors = np.linalg.cholesky(np.nan_to_num(region.covariance_m2[0]) + 1e-9 * np.eye(2))
    points = region.mean_m[0][which] + np.einsum("nij,nj->ni", factors[which], rng.normal(size=(count, 2)))
    return np.asarray(points + sigma_m * rng.normal(size=(count, 2)))


@pytest.mark.parametrize(
    ("region", "most"), [(FORK, 0.955), (BEND, 0.968), (TRACE, 0.955)], ids=["fork", "bend", "trace"]
)
@pytest.mark.parametrize("sigma_m", [0.0, 0.7])
def test_the_region_holds_95_percent(region: PoseRegion, most: float, sigma_m: float) -> None:
    points = sample(region, 40_000, sigma_m)
    share = region.rows(np.zeros(len(points), dtype=np.int64)).contains(points, sigma_m).mean()
    assert 0.945 < share < most


def test_a_single_component_has_the_usual_ellipse() -> None:
    region = PoseRegion.of_gaussians(np.zeros((1, 2)), 2.0 * np.eye(2)[None])
    assert region.squared_reach()[0] == pytest.approx([5.991, 0.0, 0.0], abs=1e-3)
    assert region.components.tolist() == [1]


def test_an_improbable_component_is_no_part_of_the_region() -> None:
    assert TRACE.squared_reach()[0, 1] == 0.0
    assert len(TRACE.ellipses().pose) == 1
    assert TRACE.contains(np.zeros((1, 2))).all()
    assert not TRACE.contains(np.array([[20.0, 0.0]])).any()


def test_a_covariance_that_is_not_finite_contains_nothing() -> None:
    region = PoseRegion.of_gaussians(np.zeros((2, 2)), np.array([np.eye(2), np.full((2, 2), np.nan)]))
    assert region.contains(np.zeros((2, 2))).tolist() == [True, False]


def test_ellipses_of_poses_without_a_region_are_those_of_the_covariance() -> None:
    plain = track()
    found = ellipses_of_poses(plain.position_m, plain.covariance_m2, None)
    assert found.pose.tolist() == [0, 1, 2, 3]
    assert found.covariance_m2 is plain.covariance_m2
    several = ellipses_of_poses(plain.position_m, plain.covariance_m2, forked())
    assert several.pose.tolist() == [0, 1, 2, 2, 3]
    assert several.weight.tolist() == [1.0, 1.0, 0.7, 0.3, 1.0]


def test_rows_and_shifts_of_a_track_are_those_of_its_region() -> None:
    whole = track(region=forked())
    late = whole.rows_where(whole.time_s > 3.0)
    assert late.region is not None
    assert late.region.components.tolist() == [2, 1]
    moved = late.moved(np.array([1.0, -1.0]))
    assert moved.region is not None
    assert moved.region.mean_m[0, :2] == pytest.approx(FORK.mean_m[0, :2] + [1.0, -1.0])
    assert moved.position_m == pytest.approx(late.position_m + np.array([1.0, -1.0]))
    standing = with_standing_poses(whole)
    assert standing.region is not None
    assert len(standing.region) == len(standing) == 7
    assert standing.region.components.tolist() == [1, 1, 1, 1, 2, 2, 1]


def test_joined_tracks_have_a_region_if_any_of_them_has() -> None:
    assert concatenate([track(), track()]).region is None
    both = concatenate([track(), track(region=forked())])
    assert both.region is not None
    assert both.region.components.tolist() == [1, 1, 1, 1, 1, 1, 2, 1]
    assert both.region.mean_m[1, 0].tolist() == [2.0, 0.0]


def test_a_region_written_and_read_back_is_the_same(tmp_path: Path) -> None:
    track(region=forked()).to_csv(tmp_path / "track.csv")
    again = Track.from_csv(tmp_path / "track.csv")
    again.to_csv(tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "track.csv").read_bytes()
    assert again.region is not None
    assert again.region.weight.tolist() == forked().weight.tolist()
    assert again.region.mean_m == pytest.approx(forked().mean_m, nan_ok=True)
    assert again.region.covariance_m2 == pytest.approx(forked().covariance_m2, nan_ok=True)
    header, *rows = (tmp_path / "track.csv").read_text().splitlines()
    assert header.endswith(",".join(REGION_COLUMNS))
    assert rows[0].endswith(",,,,,,,,,,,,")
    frame = track(region=forked()).to_polars()
    assert frame["region_2_weight"].is_nan().to_list() == [True, True, False, True]


def test_half_of_the_columns_of_a_region_is_refused(tmp_path: Path) -> None:
    track(region=forked()).to_csv(tmp_path / "track.csv")
    lines = (tmp_path / "track.csv").read_text().splitlines()
    (tmp_path / "track.csv").write_text("\n".join(",".join(line.split(",")[:-1]) for line in lines) + "\n")
    with pytest.raises(RecordingError, match="18 columns region_1_weight to region_3_cov_yy_m2"):
        Track.from_csv(tmp_path / "track.csv")


def test_the_file_is_still_a_trajectory_that_evaluate_reads(tmp_path: Path) -> None:
    from pdr_est.io.trajectories import read_trajectory

    track(region=forked()).to_csv(tmp_path / "track.csv")
    found = read_trajectory(tmp_path / "track.csv")
    assert found.position.tolist() == track().position_m.tolist()
    assert found.covariance_m2 is not None


def test_a_track_is_drawn_with_an_ellipse_for_each_place() -> None:
    from matplotlib.patches import Ellipse

    axes = pdr_est.Track.plot(track(region=forked()))
    assert sum(isinstance(patch, Ellipse) for patch in axes.patches) == 5
    assert track(region=forked())._repr_html_().count("<ellipse") == 5
    assert replace(track(), region=None)._repr_html_().count("<ellipse") == 4
