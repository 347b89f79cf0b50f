"""Poses of a live walk as a page gets them, and all of them so far for a page that opens later."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from pdr_est.frames import Array
from pdr_est.online import Update
from pdr_est.types.height import WalkerHeight
from pdr_est.types.steps import CarryingMode

MODES = tuple(mode.name for mode in sorted(CarryingMode))
"""Names of the carrying modes by their number."""

# Of each device; beyond, every second one of the older half is left out, which a line on a map does not show.
_MOST_KEPT = 4000
_MODE = 9  # place of the mode in a row without the device


def pose_row(update: Update) -> list[Any]:
    """Return a pose as a row for a page.

    Returns
    -------
    list
        Device, time s, begin of the step s, east m, north m, covariance xx, xy, yy m², heading deg, its standard
        deviation deg, number of the mode, step length m.
    """
    covariance = update.covariance_m2
    return [
        update.device,
        round(update.time_s, 6),
        round(update.moving_from_s, 3),
        *np.round(update.position_m, 4).tolist(),
        *(float(f"{value:.4g}") for value in (covariance[0, 0], covariance[0, 1], covariance[1, 1])),
        round(float(np.degrees(update.heading_rad)), 2),
        round(float(np.degrees(update.sigma_heading_rad)), 2),
        int(update.mode),
        round(update.step_length_m, 3),
    ]


def height_row(height: WalkerHeight | None) -> dict[str, float] | None:
    """Return floor, height m and its standard deviation m for a page; None where they are not known."""
    if height is None:
        return None
    return {"floor": height.floor, "height_m": round(height.height_m, 2), "sigma_m": round(height.sigma_m, 2)}


class PoseHistory:
    """Latest pose of every device and time, of one kind; the oldest ones are thinned so that memory stays bounded."""

    def __init__(self) -> None:
        self._rows: dict[str, dict[float, Array]] = {}
        self._steps: dict[str, int] = {}

    def add(self, updates: Iterable[Update]) -> list[list[Any]]:
        """Take filtered updates; return their rows. Of several for one device and time the last one counts."""
        found = []
        for update in updates:
            if update.kind != "filtered":
                continue
            row, rows = pose_row(update), self._rows.setdefault(update.device, {})
            if row[1] in rows and rows[row[1]].tolist() == row[1:]:
                continue  # only the height was revised
            if row[1] not in rows and update.step_length_m > 0.0:
                self._steps[update.device] = self._steps.get(update.device, 0) + 1
            rows[row[1]] = np.array(row[1:])
            found.append(row)
            if len(rows) > _MOST_KEPT:
                self._rows[update.device] = _thinned(rows)
        return found

    def steps(self, device: str) -> int:
        """Return the number of steps of a device."""
        return self._steps.get(device, 0)

    def rows(self) -> list[list[Any]]:
        """Return the rows of all poses that are kept, device by device in order of time."""
        return [
            [device, *rows[time_s].tolist()[:_MODE], int(rows[time_s][_MODE]), float(rows[time_s][-1])]
            for device, rows in list(self._rows.items())
            for time_s in sorted(rows)
        ]


def _thinned(rows: dict[float, Array]) -> dict[float, Array]:
    times = sorted(rows)
    half = len(times) // 2
    return {time_s: rows[time_s] for time_s in (*times[:half:2], *times[half:])}
