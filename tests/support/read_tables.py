"""Reading of a table of the simulated walk, and what must come back."""

from pathlib import Path

import numpy as np
from table_walk import TableWalk

from pdr_est.io import read
from pdr_est.types.recording import DeviceRecording


def device_of(folder: Path, data: bytes) -> DeviceRecording:
    (folder / "walk.csv").write_bytes(data)
    return read(folder / "walk.csv").devices[0]


def assert_same_samples(device: DeviceRecording, walk: TableWalk) -> None:
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    np.testing.assert_allclose(device.specific_force.values, walk.force, atol=2e-5)
    np.testing.assert_allclose(device.rotation_rate.values, walk.rate, atol=2e-5)
