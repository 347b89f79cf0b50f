"""Sizes that MAT and HDF5 files unpack to, found before a package takes memory for them."""

import math
import struct
import zlib
from collections.abc import Iterable, Iterator
from typing import Any

from pdr_est.errors import RecordingError
from pdr_est.io.text.archives.inflating import Deflate, inflate, refuse_large

_HEADER_BYTES, _TAG_BYTES = 128, 8
_COMPRESSED = 15  # type of the elements of a MAT file that are packed by zlib
_PIECE_BYTES = 1 << 16
_MOST_DATASETS = 20_000  # the timetables of MATLAB Mobile are some hundred


def refuse_large_mat(data: bytes, limit_bytes: int, place: str) -> None:
    """Raise RecordingError for a MAT file of version 5 whose compressed elements unpack to too much.

    The limits are those of `refuse_large`. What is damaged is left to the package that reads the file.
    """
    unpacked = 0
    for begin, end in _compressed_elements(data):
        taken = _Taken(data, begin, end)
        try:
            for piece in inflate(Deflate(zlib.MAX_WBITS), taken):
                unpacked += len(piece)
                refuse_large(taken.end, unpacked, limit_bytes, place)
        except (zlib.error, EOFError):
            return


def refuse_large_hdf5(datasets: Iterable[Any], packed_bytes: int, limit_bytes: int, place: str) -> None:
    """Raise RecordingError for an HDF5 file whose datasets unpack to too much, or lie in other files.

    A chunk is unpacked as a whole, however little of it belongs to the dataset.

    Parameters
    ----------
    datasets
        Datasets of h5py.
    packed_bytes
        Size of the file.
    limit_bytes, place
        As for `refuse_large`.
    """
    unpacked = 0
    for number, dataset in enumerate(datasets):
        if number == _MOST_DATASETS:
            raise RecordingError(f"{place}: has more than {_MOST_DATASETS} arrays: give one recording a file")
        if dataset.is_virtual or dataset.external:
            raise RecordingError(
                f"{place}: the values of {dataset.name} lie in another file: copy them into this one"
            )
        chunk = 0 if dataset.chunks is None else math.prod(dataset.chunks) * dataset.dtype.itemsize
        unpacked += max(dataset.nbytes, chunk)
        refuse_large(packed_bytes, unpacked, limit_bytes, place)


def datasets_of(file: Any) -> list[Any]:
    """List the datasets of a file that h5py has opened; those behind links to other files are left out."""
    found: list[Any] = []

    def add(_name: str, member: Any) -> object:
        if hasattr(member, "nbytes"):
            found.append(member)
        return True if len(found) > _MOST_DATASETS else None  # anything but None ends the visit

    file.visititems(add)
    return found


class _Taken:
    """Pieces of an element. end: position behind the last piece that was taken."""

    def __init__(self, data: bytes, begin: int, end: int) -> None:
        self._data, self._last = data, end
        self.end = begin

    def __iter__(self) -> Iterator[bytes]:
        while self.end < self._last:
            piece = self._data[self.end : min(self.end + _PIECE_BYTES, self._last)]
            self.end += len(piece)
            yield piece


def _compressed_elements(data: bytes) -> Iterator[tuple[int, int]]:
    """Yield where each compressed element of a MAT file begins and ends, up to the first that is cut off."""
    order = ">" if data[_HEADER_BYTES - 2 : _HEADER_BYTES] == b"MI" else "<"
    at = _HEADER_BYTES
    while at + _TAG_BYTES <= len(data):
        kind, n_bytes = struct.unpack_from(f"{order}II", data, at)
        at += _TAG_BYTES
        if kind == _COMPRESSED:
            yield at, min(at + n_bytes, len(data))
        at += n_bytes
