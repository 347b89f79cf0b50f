"""How much of a walk each carrying mode took."""

from dataclasses import dataclass

import numpy as np

from pdr_est.evaluate.carrying_modes import mode_shares
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.steps import CarryingMode


@dataclass(frozen=True)
class ModeUse:
    """A carrying mode of one device. walking_time_share: of the time its steps took, 0 to 1, NaN if they took none;
    mean_probability: how sure the recogniser was, averaged over the steps of this mode."""

    device: str
    mode: CarryingMode
    steps: int
    walking_time_share: float
    mean_probability: float


def mode_use(device: DeviceWalk) -> list[ModeUse]:
    """The modes that occur in the steps of a device, the most frequent first."""
    events = [step.event for step in device.steps]
    shares = mode_shares(device.steps)
    probability = np.array([event.mode_probability for event in events])
    mode = np.array([event.mode for event in events], dtype=np.int8)
    found = [
        ModeUse(
            device.device,
            CarryingMode(int(value)),
            int(of_mode.sum()),
            shares[CarryingMode(int(value))],
            float(probability[of_mode].mean()),
        )
        for value in np.unique(mode)
        for of_mode in [mode == value]
    ]
    return sorted(found, key=lambda use: -use.steps)
