"""Files that state more numbers than they hold are refused before memory is taken for them."""

import io
import tracemalloc
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import polars as pl
import pytest

from pdr_est.errors import RecordingError
from pdr_est.io import read

NUMBERS = 40_000_000
TITLES = ("time_s", "acc_x_mps2", "acc_y_mps2", "acc_z_mps2")


def npz(path: Path) -> None:
    with zipfile.ZipFile(path, "w") as archive:
        for name, shape in (("time", (NUMBERS,)), ("acce", (NUMBERS, 3)), ("gyro", (NUMBERS, 3))):
            content = io.BytesIO()
            header = {"descr": "<f8", "fortran_order": False, "shape": shape}
            np.lib.format.write_array_header_1_0(content, header)
            archive.writestr(f"synced/{name}.npy", content.getvalue())


def hdf5(path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        for name, shape in (("time", (NUMBERS,)), ("acce", (NUMBERS, 3)), ("gyro", (NUMBERS, 3))):
            file.create_dataset(f"synced/{name}", shape=shape, dtype="f8", chunks=True, compression="gzip")


def parquet(path: Path) -> None:
    frame = pl.DataFrame({title: np.zeros(NUMBERS // 4) for title in TITLES})
    frame.write_parquet(path, statistics=False, compression="zstd")


@pytest.mark.parametrize(("make", "suffix"), [(npz, "npz"), (hdf5, "h5"), (parquet, "parquet")])
def test_what_is_not_there_takes_no_memory(make: Callable[[Path], None], suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"bomb.{suffix}"
    make(path)
    assert path.stat().st_size < 1e6
    tracemalloc.start()
    try:
        with pytest.raises(RecordingError, match=r"its header states|unpacks to more than"):
            read(path)
        assert tracemalloc.get_traced_memory()[1] < 20e6
    finally:
        tracemalloc.stop()
