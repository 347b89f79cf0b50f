"""Sound recordings of real phones raise no alarm, and the faults that are put into them do."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pdr_est.io import read
from pdr_est.io.conversion.rotation_unit import detect_rotation_unit
from pdr_est.preprocessing.quality.consistency import consistency_warnings
from pdr_est.types.recording import DeviceRecording, Signal

PATTERNS = (
    "ilc20/*/*/*.txt*",
    "ipin2023/*.txt*",
    "known-distance/[A-G].csv*",
    "motionsense/wlk_7/*.csv*",
    "motionsense/jog_9/*.csv*",
    "motionsense/std_6/*.csv*",
    "oxford-steps/Pixel*",
    "oxiod/large-scale/floor1/syn/imu*",
    "phone-gps/*swing*",
    "phone-gps/*looking*",
    "sensor-logger/*-steps-*",
    "sisfall/SA*/D0*",
    "stride-length/PDR_Raw*",
    "walks/dsads/*.csv*",
    "walks/geotec/*.csv*",
    "walks/ridi/*.csv*",
    "walks/oxiod-vicon/*.csv*",
    "weallwalk/sensor/*",
)
OF_EACH = 4


def devices(data: Path, pattern: str) -> list[DeviceRecording]:
    paths = [path for path in sorted(data.glob(pattern)) if ".truth." not in path.name]
    chosen = paths[:: max(len(paths) // OF_EACH, 1)][:OF_EACH]
    return [device for path in chosen for device in read(path).devices]


@pytest.mark.slow
@pytest.mark.parametrize("pattern", PATTERNS)
def test_no_alarm_and_every_unit_right(shared_data: Path, pattern: str) -> None:
    found = devices(shared_data, pattern)
    if not found:
        pytest.skip(f"no {pattern} in {shared_data}")
    for device in found:
        assert consistency_warnings(device) == ()
        force, rate = device.specific_force, device.rotation_rate
        if force is None or rate is None:
            continue
        for factor in (1.0, 180.0 / np.pi, 180e3 / np.pi):
            conversion = detect_rotation_unit(Signal(rate.time_s, factor * rate.values), force)
            assert conversion.factor * factor == pytest.approx(1.0)
            assert conversion.warning == "" or factor != 1.0  # degrees may be doubted: revolutions are near


@pytest.mark.slow
@pytest.mark.parametrize("pattern", ["ipin2023/*.txt*", "phone-gps/*swing*"])
def test_swapped_axes_of_phones_that_turn_over_are_told(shared_data: Path, pattern: str) -> None:
    for device in devices(shared_data, pattern):
        assert device.rotation_rate is not None
        swapped = Signal(device.rotation_rate.time_s, device.rotation_rate.values[:, [2, 0, 1]])
        (words,) = consistency_warnings(replace(device, rotation_rate=swapped))
        assert "(y, z, x)" in words
