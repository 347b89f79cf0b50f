"""The numbers that the scripts of the report draw, as columns for `inline_json`."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from pdr_est.frames import Array
from pdr_est.label_runs import label_runs
from pdr_est.pipeline import DeviceWalk, SmoothedWalk
from pdr_est.report.packed_columns import pack_column, pack_floats
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.finding_marks import marked_places
from pdr_est.report.plots.mode_style import MODE_DASHES, mode_runs
from pdr_est.report.plots.time_axis import time_axis
from pdr_est.report.walk.fix_residuals import FixResiduals
from pdr_est.report.walk.map_extras import MapExtras
from pdr_est.types.height import HeightProfile
from pdr_est.types.region import PoseRegion
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

Json = dict[str, Any]

TIME_STEP_S = 1e-3
PLACE_STEP_M = 1e-3
ANGLE_STEP_DEG = 0.1
ACCELERATION_STEP_MPS2 = 0.01
WEIGHT_STEP = 0.01
CADENCE_STEP_PER_MIN = 0.1
MOST_SAMPLES = 500_000  # of all devices, 1.3 MB: an hour of two phones has 360 000 at the usual 50 Hz


def explorer_data(
    walk: SmoothedWalk,
    residuals: Sequence[FixResiduals],
    truth_m: Array | None,
    north: bool,
    extras: MapExtras,
) -> Json:
    """Collect tracks, signals, fixes and truth of a walk.

    Parameters
    ----------
    walk
        Finished walk.
    residuals
        Known positions beside the track.
    truth_m
        (n, 2) true positions in the frame of the track, m; None without any.
    north
        True if the y axis points to north.
    extras
        Further parts of the map.
    """
    axis = time_axis(walk)
    samples = sum(len(block) for device in walk.devices for block in device.level)
    bin_size = 2 * -(-samples // MOST_SAMPLES)
    names = walk.track.devices
    return {
        "begin_s": axis.begin_s,
        "end_s": axis.end_s,
        "north": north,
        "modes": [_mode(mode) for mode in CarryingMode],
        "devices": [_device(walk.track.of_device(name), number, len(names)) for number, name in enumerate(names)],
        "signals": [_signals(device, number, bin_size) for number, device in enumerate(walk.devices)],
        "height": _height(walk.track.height),
        "fixes": [_fixes(one) for one in residuals],
        "truth": None if truth_m is None or not len(truth_m) else _places(truth_m),
        "doubts": [_places(points_m) for points_m in marked_places(walk.track)],
        "variants": [
            {"name": name, "colour": f"--{svg.css_name(svg.INK)}"} | _places(track.position_m)
            for name, track in extras.variants.items()
        ],
        "background": extras.background,
        "floors": list(extras.floors),
    }


def _mode(mode: CarryingMode) -> Json:
    colour = f"--{svg.css_name(svg.MODE_COLOURS[mode])}"
    return {"name": mode.name, "colour": colour, "dashes": MODE_DASHES.get(mode, ())}


def _colour(number: int) -> str:
    return f"--{svg.css_name(svg.device_colour(number))}"


def _device(track: Track, number: int, count: int) -> Json:
    covariance_m2 = track.covariance_m2
    poses = {
        "time_s": pack_column(track.time_s, TIME_STEP_S),
        "from_s": pack_column(track.moving_from_s, TIME_STEP_S),
        **_places(track.position_m),
        "cxx_m2": pack_floats(covariance_m2[:, 0, 0]),
        "cxy_m2": pack_floats(covariance_m2[:, 0, 1]),
        "cyy_m2": pack_floats(covariance_m2[:, 1, 1]),
        "heading_deg": pack_column(np.degrees(track.heading_rad), ANGLE_STEP_DEG),
        "sigma_heading_deg": pack_column(np.degrees(track.sigma_heading_rad), ANGLE_STEP_DEG),
        "mode": pack_column(track.mode, 1.0),
        "length_m": pack_column(track.step_length_m, PLACE_STEP_M),
    }
    return {
        "name": str(track.device[0]),
        "colour": _colour(number),
        "line": None if count == 1 else _colour(number),
        "poses": poses,
        "regions": None if track.region is None else _regions(track.region),
    }


def _regions(region: PoseRegion) -> Json:
    """Collect the ellipses of the poses that one ellipse does not describe: several rows for each of them."""
    several = np.flatnonzero(region.components > 1)
    ellipses = region.rows(several).ellipses()
    covariance_m2 = ellipses.covariance_m2
    return {
        "pose": pack_column(several[ellipses.pose], 1.0),
        "weight": pack_column(ellipses.weight, WEIGHT_STEP),
        **_places(ellipses.centre_m),
        "cxx_m2": pack_floats(covariance_m2[:, 0, 0]),
        "cxy_m2": pack_floats(covariance_m2[:, 0, 1]),
        "cyy_m2": pack_floats(covariance_m2[:, 1, 1]),
    }


def _signals(device: DeviceWalk, number: int, bin_size: int) -> Json:
    """Collect the vertical acceleration, which is evenly sampled in each segment, and the detected steps."""
    runs = mode_runs(device)
    return {
        "device": device.device,
        "colour": _colour(number),
        "segments": [_segment(*one, bin_size) for one in _segments(device)],
        "steps_s": pack_column([step.event.time_s for step in device.steps], TIME_STEP_S),
        "cadence_per_min": pack_column(
            [60.0 * step.frequency_hz or np.nan for step in device.steps], CADENCE_STEP_PER_MIN
        ),
        "runs": {
            "begin_s": pack_column([run.begin_s for run in runs], TIME_STEP_S),
            "end_s": pack_column([run.end_s for run in runs], TIME_STEP_S),
            "mode": pack_column([run.mode for run in runs], 1.0),
        },
        "gaps": {
            "begin_s": pack_column([gap.start_s for gap in device.gaps], TIME_STEP_S),
            "end_s": pack_column([gap.end_s for gap in device.gaps], TIME_STEP_S),
        },
    }


def _height(profile: HeightProfile | None) -> Json | None:
    """Collect height and floor of the walker, and the times of the moves; None where they are not known."""
    if profile is None:
        return None
    return {
        "columns": {
            "time_s": pack_column(profile.time_s, TIME_STEP_S),
            "height_m": pack_column(profile.height_m, PLACE_STEP_M),
            "sigma_m": pack_column(profile.sigma_m, PLACE_STEP_M),
            "floor": pack_column(profile.floor, 1.0),
        },
        "moves": {
            "begin_s": pack_column([move.begin_s for move in profile.moves], TIME_STEP_S),
            "end_s": pack_column([move.end_s for move in profile.moves], TIME_STEP_S),
        },
    }


def _segments(device: DeviceWalk) -> list[tuple[Array, Array]]:
    blocks = [block for block in device.level if len(block)]
    runs = label_runs(np.array([block.segment for block in blocks]))
    return [
        (
            np.concatenate([block.time_s for block in blocks[start:stop]]),
            np.concatenate([block.vertical_mps2 for block in blocks[start:stop]]),
        )
        for start, stop in runs
    ]


def _segment(time_s: Array, vertical_mps2: Array, bin_size: int) -> Json:
    """Describe a segment; bins of more than two samples are reduced to their least and greatest one."""
    begin_s, end_s = float(time_s[0]), float(time_s[-1])
    if bin_size > 2 and len(time_s) >= bin_size:
        starts = np.arange(0, len(time_s), bin_size)
        extremes = [part.reduceat(vertical_mps2, starts) for part in (np.fmin, np.fmax)]
        vertical_mps2 = np.column_stack(extremes).ravel()
    return {"begin_s": begin_s, "end_s": end_s, "values": pack_column(vertical_mps2, ACCELERATION_STEP_MPS2)}


def _fixes(one: FixResiduals) -> Json:
    return {
        "kind": one.kind,
        "columns": {
            "time_s": pack_column(one.time_s, TIME_STEP_S),
            **_places(one.position_m),
            "cxx_m2": pack_floats(one.covariance_m2[:, 0, 0]),
            "cxy_m2": pack_floats(one.covariance_m2[:, 0, 1]),
            "cyy_m2": pack_floats(one.covariance_m2[:, 1, 1]),
            "distance_m": pack_column(one.distance_m, PLACE_STEP_M),
            "bound_m": pack_column(one.bound_m, PLACE_STEP_M),
        },
    }


def _places(position_m: Array) -> Json:
    return {"x_m": pack_column(position_m[:, 0], PLACE_STEP_M), "y_m": pack_column(position_m[:, 1], PLACE_STEP_M)}
