"""The numbers that the scripts of an evaluation's page draw, as columns for `inline_json`."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pdr_est.frames import Array
from pdr_est.report.evaluation.document import Evaluation
from pdr_est.report.packed_columns import PackedColumn, pack_column
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.track import DENSE_POINTS
from pdr_est.types.track import Track

_STEP_S, _STEP_M = 1e-3, 1e-3


def evaluation_data(evaluation: Evaluation, tracks: Sequence[Track]) -> dict[str, Any]:
    """Collect the aligned tracks, the true positions and the errors at them.

    Parameters
    ----------
    evaluation : Evaluation
        The evaluation.
    tracks : sequence of Track
        Track of each scored device after the alignment.
    """
    scores = evaluation.scores
    pairs = scores[0].pairs
    first_s = [float(track.time_s[0]) for track in tracks] + [float(score.pairs.time_s[0]) for score in scores]
    last_s = [float(track.time_s[-1]) for track in tracks] + [float(score.pairs.time_s[-1]) for score in scores]
    dense = len(pairs) > DENSE_POINTS
    return {
        "begin_s": min(first_s),
        "end_s": max(last_s),
        "north": evaluation.origin is not None,
        "devices": [
            {
                "name": score.device,
                "colour": f"--{svg.css_name(svg.device_colour(number))}",
                "poses": _timed(track.time_s, track.position_m),
                "errors": {"time_s": _seconds(score.pairs.time_s), "error_m": pack_column(score.error_m, _STEP_M)},
            }
            for number, (score, track) in enumerate(zip(scores, tracks, strict=True))
        ],
        "truth": _places(evaluation.truth.position_m),
        "points": None if dense else _timed(pairs.time_s, pairs.truth_m),
    }


def _timed(time_s: Array, position_m: Array) -> dict[str, PackedColumn]:
    return {"time_s": _seconds(time_s), **_places(position_m)}


def _places(position_m: Array) -> dict[str, PackedColumn]:
    return {name: pack_column(column, _STEP_M) for name, column in zip(("x_m", "y_m"), position_m.T, strict=True)}


def _seconds(time_s: ArrayLike) -> PackedColumn:
    return pack_column(np.asarray(time_s), _STEP_S)
