"""Tables as Parquet files: columns of texts and of numbers."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import polars as pl
from polars.exceptions import PolarsError

from pdr_est.errors import RecordingError

Column = Sequence[str | None] | Sequence[float | None]


def write_parquet(path: Path, texts: Mapping[str, Sequence[str | None]], numbers: Mapping[str, Column]) -> None:
    """Write the columns, texts first, all of one length; None is a missing value. Equal columns give equal bytes."""
    columns = [pl.Series(name, list(values), dtype=pl.String) for name, values in texts.items()]
    columns += [pl.Series(name, list(values), dtype=pl.Float64) for name, values in numbers.items()]
    pl.DataFrame(columns).write_parquet(path, statistics=False)


def read_parquet(path: Path) -> dict[str, list[str | float | None]]:
    """The columns of a table by name. Raises RecordingError when the file cannot be read."""
    try:
        return pl.read_parquet(path).to_dict(as_series=False)
    except (OSError, PolarsError) as error:
        raise RecordingError(f"{path}: is no Parquet table that can be read: write it again") from error
