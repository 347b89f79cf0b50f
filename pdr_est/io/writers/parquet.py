"""Write and read tables of text and number columns as Parquet files."""

import io
from collections.abc import Mapping, Sequence
from pathlib import Path

import polars as pl
from polars.exceptions import PolarsError

from pdr_est.errors import RecordingError
from pdr_est.output.atomic_output import staged_file

Column = Sequence[str | None] | Sequence[float | None]


def write_parquet(path: Path, texts: Mapping[str, Sequence[str | None]], numbers: Mapping[str, Column]) -> None:
    """Write a table; equal columns give equal bytes.

    Parameters
    ----------
    path
        File to write.
    texts
        Text columns by name, which come first; None is a missing value.
    numbers
        Number columns by name, all of the same length; None is a missing value.
    """
    columns = [pl.Series(name, list(values), dtype=pl.String) for name, values in texts.items()]
    columns += [pl.Series(name, list(values), dtype=pl.Float64) for name, values in numbers.items()]
    content = io.BytesIO()
    pl.DataFrame(columns).write_parquet(content, statistics=False)
    with staged_file(path, overwrite=True) as staging:  # polars does not say when a disk is full
        staging.write_bytes(content.getbuffer())


def read_parquet(path: Path) -> dict[str, list[str | float | None]]:
    """Read the columns of a table by name.

    Raises
    ------
    RecordingError
        When the file cannot be read.
    """
    try:
        return pl.read_parquet(path).to_dict(as_series=False)
    except (OSError, PolarsError) as error:
        raise RecordingError(f"{path}: cannot be read as a Parquet table: write it again") from error
