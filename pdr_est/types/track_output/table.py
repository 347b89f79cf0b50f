"""The table of a track: CSV files and data frames with one row for each pose.

polars and pandas are imported where they are used: `types` lies below everything, and most programs never ask for a
data frame.
"""

import csv
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import OutputError, RecordingError
from pdr_est.frames import wrap_angle
from pdr_est.output.atomic_output import text_output
from pdr_est.output.csv_cells import harmless_name
from pdr_est.types.height import HeightProfile
from pdr_est.types.region import MOST_COMPONENTS, PoseRegion
from pdr_est.types.steps import CarryingMode

if TYPE_CHECKING:
    import pandas
    import polars

    from pdr_est.types.track import Track

TRACK_COLUMNS = (
    "time_s",
    "device",
    "x_m",
    "y_m",
    "heading_rad",
    "cov_xx_m2",
    "cov_xy_m2",
    "cov_yy_m2",
    "sigma_heading_rad",
    "mode",
    "step_length_m",
)
"""Columns of `track.csv` and of the data frames, in order."""

HEIGHT_COLUMNS = ("height_m", "sigma_height_m", "floor", "floor_probability")
"""Columns that follow where height and floor are known."""

REGION_COLUMNS = tuple(
    f"region_{number}_{name}"
    for number in range(1, MOST_COMPONENTS + 1)
    for name in ("weight", "x_m", "y_m", "cov_xx_m2", "cov_xy_m2", "cov_yy_m2")
)
"""Columns that follow where the track has a region; they are empty for components that a pose does not need."""

_TEXT_COLUMNS = ("device", "mode")
_ROUNDING = {"time_s": ".6f", "x_m": ".4f", "y_m": ".4f", "heading_rad": ".6f", "step_length_m": ".4f"}
_ROUNDING |= {"height_m": ".3f", "sigma_height_m": ".3f", "floor": "d", "floor_probability": ".4f"}
_ROUNDING |= {name: ".9g" if "_cov_" in name else ".4f" for name in REGION_COLUMNS}
_ROUNDING |= dict.fromkeys(("cov_xx_m2", "cov_xy_m2", "cov_yy_m2"), ".9g") | {"sigma_heading_rad": ".6g"}


def columns_of(track: "Track") -> dict[str, NDArray[Any]]:
    """Compute the columns (n,) of the track table; headings are wrapped, modes are names."""
    names = np.array([CarryingMode(int(mode)).name for mode in track.mode], dtype=np.str_)
    values = (
        track.time_s,
        track.device,
        track.position_m[:, 0],
        track.position_m[:, 1],
        np.where(np.abs(track.heading_rad) <= math.pi, track.heading_rad, wrap_angle(track.heading_rad)),
        track.covariance_m2[:, 0, 0],
        track.covariance_m2[:, 0, 1],
        track.covariance_m2[:, 1, 1],
        track.sigma_heading_rad,
        names,
        track.step_length_m,
    )
    columns = dict(zip(TRACK_COLUMNS, values, strict=True))
    if track.height is not None:
        places, profile = track.height.nearest(track.time_s), track.height
        heights = (profile.height_m, profile.sigma_m, profile.floor, profile.floor_probability)
        columns |= {name: column[places] for name, column in zip(HEIGHT_COLUMNS, heights, strict=True)}
    if track.region is not None:
        columns |= _region_columns(track.region)
    return columns


def _region_columns(region: PoseRegion) -> dict[str, NDArray[Any]]:
    """Compute the columns (n,) of the region; NaN for components that a pose does not need."""
    covariance = region.covariance_m2.reshape(*region.weight.shape, 4)[..., [0, 1, 3]]
    weight = np.where(region.weight > 0.0, region.weight, np.nan)
    values = np.concatenate([weight[..., None], region.mean_m, covariance], axis=2).reshape(len(region), -1)
    return dict(zip(REGION_COLUMNS, values.T, strict=True))


def write_csv(track: "Track", path: str | Path) -> None:
    """Write the track table with its header, numbers rounded to 0.1 mm or finer."""
    columns = columns_of(track)
    texts = [
        [_number_text(name, value) for value in column.tolist()]
        if name in _ROUNDING
        else list(map(harmless_name, column.tolist()))
        for name, column in columns.items()
    ]
    with text_output(path) as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(zip(*texts, strict=True))


def _number_text(name: str, value: float) -> str:
    return "" if name in REGION_COLUMNS and math.isnan(value) else format(value, _ROUNDING[name])


def read_csv(path: str | Path) -> dict[str, Any]:
    """Read a track table into the fields of `Track` that it determines.

    Raises
    ------
    RecordingError
        If the file cannot be read or is no track table.
    """
    try:
        with Path(path).open(newline="", encoding="utf-8") as stream:
            header, *rows = list(csv.reader(stream)) or [[]]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise RecordingError(f"{path}: cannot be read as a track table: {error}") from error
    possible = [
        (*TRACK_COLUMNS, *heights, *regions) for heights in ((), HEIGHT_COLUMNS) for regions in ((), REGION_COLUMNS)
    ]
    if tuple(header) not in possible:
        raise RecordingError(
            f"{path}: not a track table: its first line is {','.join(header)[:80]!r}, but the columns must be "
            f"{','.join(TRACK_COLUMNS)}, and {','.join(HEIGHT_COLUMNS)} may follow, and the {len(REGION_COLUMNS)} "
            f"columns {REGION_COLUMNS[0]} to {REGION_COLUMNS[-1]}"
        )
    if not rows:
        raise RecordingError(f"{path}: the track table has no rows: a track has at least its start")
    columns = {name: _column(path, name, index, rows, len(header)) for index, name in enumerate(header)}
    time_s, device = columns["time_s"], columns["device"]
    first = np.concatenate([[True], device[1:] != device[:-1]])
    covariance = np.array(
        [[columns["cov_xx_m2"], columns["cov_xy_m2"]], [columns["cov_xy_m2"], columns["cov_yy_m2"]]]
    )
    # A rounded heading may lie just outside [-pi, pi]; it would be wrapped to the other end when written again.
    heading = np.clip(columns["heading_rad"], -math.pi, math.pi)
    return {
        "time_s": time_s,
        "moving_from_s": np.where(first, time_s, np.roll(time_s, 1)),
        "device": device,
        "position_m": np.column_stack([columns["x_m"], columns["y_m"]]),
        "heading_rad": heading,
        "covariance_m2": np.ascontiguousarray(covariance.transpose(2, 0, 1)),
        "sigma_heading_rad": columns["sigma_heading_rad"],
        "mode": columns["mode"],
        "step_length_m": columns["step_length_m"],
        "height": _height(columns),
        "region": _region(columns),
    }


def _height(columns: dict[str, NDArray[Any]]) -> HeightProfile | None:
    """Make the height of the walker from that of the poses, in order of time; None where it is not in the table."""
    if HEIGHT_COLUMNS[0] not in columns:
        return None
    time_s, first = np.unique(columns["time_s"], return_index=True)
    height_m, sigma_m, floor, probability = (columns[name][first] for name in HEIGHT_COLUMNS)
    return HeightProfile(time_s, height_m, sigma_m, floor, probability)


def _region(columns: dict[str, NDArray[Any]]) -> PoseRegion | None:
    """Make the region of the poses; None where it is not in the table."""
    if REGION_COLUMNS[0] not in columns:
        return None
    values = np.stack([columns[name] for name in REGION_COLUMNS], axis=1).reshape(-1, MOST_COMPONENTS, 6)
    covariance = values[..., [3, 4, 4, 5]].reshape(-1, MOST_COMPONENTS, 2, 2)
    return PoseRegion(np.nan_to_num(values[..., 0], nan=0.0), values[..., 1:3], covariance)


def _column(path: str | Path, name: str, index: int, rows: list[list[str]], count: int) -> NDArray[Any]:
    """Convert one column of text cells; modes become their numbers."""
    cells = []
    for line, row in enumerate(rows, start=2):
        if len(row) != count:
            raise RecordingError(f"{path}, row {line}: {len(row)} cells instead of {count}: the file is damaged")
        try:
            cells.append(_cell(name, row[index]))
        except (ValueError, KeyError) as error:
            wanted = {"mode": f"one of {', '.join(CarryingMode.__members__)}", "floor": "an integer"}.get(
                name, "a number"
            )
            raise RecordingError(f"{path}, row {line}: {name} is {row[index]!r}: it must be {wanted}") from error
    types: dict[str, type[Any]] = {"device": np.str_, "mode": np.int8, "floor": np.int64}
    return np.array(cells, dtype=types.get(name, np.float64))


def _cell(name: str, text: str) -> Any:
    if name == "device":
        return text
    if name == "floor":
        return int(text)
    if name in REGION_COLUMNS and not text:
        return math.nan
    return CarryingMode[text].value if name == "mode" else float(text)


def to_polars(track: "Track") -> "polars.DataFrame":
    """Return the track table as a polars data frame."""
    import polars

    return polars.DataFrame(
        {name: column.tolist() if name in _TEXT_COLUMNS else column for name, column in columns_of(track).items()}
    )


def to_pandas(track: "Track") -> "pandas.DataFrame":
    """Return the track table as a pandas data frame.

    Raises
    ------
    OutputError
        If pandas is not installed.
    """
    try:
        import pandas
    except ImportError as error:
        raise OutputError(
            "Track.to_pandas needs pandas, which is not installed: `pip install pandas`, or use Track.to_polars"
        ) from error
    return pandas.DataFrame(columns_of(track))
