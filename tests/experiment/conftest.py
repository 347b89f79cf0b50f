"""Small logs of made-up walks in the ILC20 format."""

import gzip
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from small_sets import bouncing

_EPOCH_MS = 1_574_560_000_000
_SPEED_MPS = 1.3

WriteLog = Callable[..., Path]


@pytest.fixture
def write_ilc20() -> WriteLog:
    """Writer of a walk straight to the north with a waypoint every `every_s`, the first one at 1 s.

    The phone also records its attitude, by which it points `yaw_deg` to the left of north; None for none.
    """

    def write(
        path: Path,
        duration_s: float = 20.0,
        every_s: float = 3.0,
        bounce_mps2: float = 3.0,
        yaw_deg: float | None = 0.0,
    ) -> Path:
        rows = []
        for t, up in zip(*bouncing(50.0, bounce_mps2, duration_s), strict=True):
            ms = _EPOCH_MS + round(1e3 * t)
            rows.append(f"{ms}\tTYPE_ACCELEROMETER\t0.0\t0.0\t{up:.5f}\t3")
            rows.append(f"{ms}\tTYPE_GYROSCOPE\t0.0\t0.0\t0.0\t3")
            if yaw_deg is not None:
                rows.append(f"{ms}\tTYPE_ROTATION_VECTOR\t0.0\t0.0\t{np.sin(np.deg2rad(yaw_deg) / 2):.7f}\t3")
        for t in np.arange(1.0, duration_s, every_s):
            rows.append(f"{_EPOCH_MS + round(1e3 * t)}\tTYPE_WAYPOINT\t5.0\t{_SPEED_MPS * t:.3f}")
        text = "\n".join(rows) + "\n"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(gzip.compress(text.encode()) if path.suffix == ".gz" else text.encode())
        return path

    return write
