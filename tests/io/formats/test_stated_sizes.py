"""Files that state more numbers than they hold are refused before memory is taken for them."""

import io
import struct
import tracemalloc
import zipfile
import zlib
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


def hdf5_of_large_chunks(path: Path) -> None:
    """A chunk of 480 MB of which three rows belong to the array."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        for name, row in (("time", ()), ("acce", (3,)), ("gyro", (3,))):
            file.create_dataset(
                f"synced/{name}",
                shape=(3, *row),
                maxshape=(None, *row),
                chunks=(NUMBERS, *row),
                dtype="f8",
                compression="gzip",
            )


def new_mat(path: Path) -> None:
    pytest.importorskip("matio")
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512) as file:
        file.create_dataset("Acceleration", (NUMBERS, 3), dtype="f8", chunks=True, compression="gzip")
    with path.open("r+b") as stream:
        stream.write(mat_header(b"MATLAB 7.3 MAT-file", 0x0200))


def old_mat(path: Path) -> None:
    """Three elements of 32 MiB each, zeros in a variable that states their number."""
    pytest.importorskip("matio")
    size = 1 << 25
    about = (
        struct.pack("<4I", 6, 8, 6, 0)
        + struct.pack("<2I2i", 5, 8, size // 8, 1)
        + struct.pack("<2I8s", 1, 8, b"Position")
    )
    matrix = about + struct.pack("<2I", 9, size) + bytes(size)
    packed = zlib.compress(struct.pack("<2I", 14, len(matrix)) + matrix)
    element = struct.pack("<2I", 15, len(packed)) + packed
    path.write_bytes(mat_header(b"MATLAB 5.0 MAT-file", 0x0100) + 3 * element)


def mat_header(words: bytes, version: int) -> bytes:
    return words.ljust(124) + struct.pack("<H2s", version, b"IM")


BOMBS = [
    (npz, "npz"),
    (hdf5, "h5"),
    (hdf5_of_large_chunks, "h5"),
    (new_mat, "mat"),
    (old_mat, "mat"),
    (parquet, "parquet"),
]


@pytest.mark.parametrize(("make", "suffix"), BOMBS)
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


def test_values_of_another_file_are_not_read(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "walk.h5", "w") as file:
        file["synced/time"] = np.arange(10.0)
        file.create_dataset("synced/acce", (10, 3), dtype="f8", external=[(str(tmp_path / "other"), 0, 240)])
    (tmp_path / "other").write_bytes(bytes(240))
    with pytest.raises(RecordingError, match="the values of /synced/acce lie in another file"):
        read(tmp_path / "walk.h5")
