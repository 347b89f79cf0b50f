"""Tiny made-up walks laid out and written as the data sets of the suites are: two steps a second, straight ahead."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array

STEP_HZ = 2.0
DURATION_S = 20.0
N_STEPS = 40
_METRES_PER_DEGREE = 111_195.0


def bouncing(rate_hz: float = 50.0, bounce_mps2: float = 3.0, duration_s: float = DURATION_S) -> tuple[Array, Array]:
    """Times (n,) and upward specific force (n,) of somebody who walks all the time, or stands with no bounce."""
    time_s = np.arange(0.0, duration_s, 1.0 / rate_hz)
    phase = 2.0 * np.pi * STEP_HZ * time_s
    return time_s, STANDARD_GRAVITY_MPS2 + bounce_mps2 * (np.sin(phase) + np.sin(2.0 * phase) / 3.0)


def crests_s() -> Array:
    """(N_STEPS,) when the force is greatest in each step."""
    time_s, force = bouncing(rate_hz=1000.0)
    return np.arange(N_STEPS) / STEP_HZ + time_s[np.argmax(force[: int(1000.0 / STEP_HZ)])]


def write(path: Path, lines: Sequence[str]) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def oxford_walk(folder: Path, contacts_s: Array) -> None:
    """A phone with an accelerometer, and a contact of 0.2 s of alternating feet at each of some times."""
    start_ns = 584_065_454_762_638
    time_s, up = bouncing(100.0)
    rows = (f"{start_ns + round(1e9 * t)},3,0.1,0.2,{a:.4f}" for t, a in zip(time_s, up, strict=True))
    write(folder / "accelerometer.csv", [*rows])
    states = [(-0.1, 0, 0)]
    for number, t in enumerate(contacts_s):
        left = number % 2 == 0
        states += [(t, int(left), int(not left)), (t + 0.2, 0, 0)]
    write(folder / "stepcounter.csv", [f"{start_ns + round(1e9 * t)},{left},{right}" for t, left, right in states])


def weallwalk_table(path: Path, turning_until_s: float = 0.0) -> None:
    """An iPhone lying flat: gravity down, the bounce as user acceleration, in g, at first perhaps turning 0.5 rad/s.

    The device's own attitude does not turn; the front end makes its own.
    """
    rows = []
    for t, up in zip(*bouncing(25.0), strict=True):
        user = -(up / STANDARD_GRAVITY_MPS2 - 1.0)
        attitude = [0.0] * 12 + [0.0, 0.0, 0.0, 1.0]  # angles, matrix, quaternion x y z w
        motion = [0.0, 0.0, 0.5 if t < turning_until_s else 0.0, 0.0, 0.0, user, 0.0, 0.0, -1.0]
        rest = [0.0] * 10 + [5.0, 6.0, 7.0] + [0.0] * 2
        rows.append([t, *attitude, *motion, *rest])
    write(path, [",".join(f"{value:.6f}" for value in row) for row in rows])


def weallwalk_annotation(path: Path, steps_s: Array, turns: Sequence[tuple[float, float]]) -> None:
    """turns: time in s, degrees."""
    steps = [f"<Step><WhichFoot>{'LR'[i % 2]}</WhichFoot><Time>{t:.4f}</Time></Step>" for i, t in enumerate(steps_s)]
    corners = [
        f"<PathSegment><TurnTime>{t:.4f}</TurnTime><TurnInDegrees>{angle:g}</TurnInDegrees></PathSegment>"
        for t, angle in turns
    ]
    write(path, ["<root><PathSegment><Steps>", *steps, "</Steps></PathSegment>", *corners, "</root>"])


def plain_table(path: Path, speed_mps: float | None = None) -> None:
    """A held phone; with a speed, a GPS position each second of somebody who walks north so fast."""
    place = "" if speed_mps is None else ",latitude,longitude"
    rows = [f"time_s,acc_x_mps2,acc_y_mps2,acc_z_mps2,gyr_x_radps,gyr_y_radps,gyr_z_radps{place}"]
    for t, up in zip(*bouncing(), strict=True):
        row = f"{t:.3f},0,0,{up:.4f},0,0,0"
        if speed_mps is not None:
            row += f",{48.0 + speed_mps * np.floor(t) / _METRES_PER_DEGREE:.8f},11.0"
        rows.append(row)
    write(path, rows)


def motionsense_table(path: Path, bounce_mps2: float = 3.0) -> None:
    """An iPhone lying flat, the bounce as user acceleration, in g."""
    names = [f"attitude.{angle}" for angle in ("roll", "pitch", "yaw")]
    names += [f"{vector}.{axis}" for vector in ("gravity", "rotationRate", "userAcceleration") for axis in "xyz"]
    rows = [",".join(["", *names])]
    for i, up in enumerate(bouncing(bounce_mps2=bounce_mps2)[1]):
        rows.append(f"{i},0,0,0,0,0,-1,0,0,0,0,0,{1.0 - up / STANDARD_GRAVITY_MPS2:.6f}")
    write(path, rows)


def sisfall_table(path: Path, bounce_mps2: float = 3.0) -> None:
    """A box at the belt that hangs upside down: gravity and bounce along -y, 256 bits a g."""
    rows = []
    for up in bouncing(200.0, bounce_mps2)[1]:
        bits = round(-256.0 * up / STANDARD_GRAVITY_MPS2)
        rows.append(f"{0:4d},{bits:4d},{0:4d}" + ",   0" * 6 + ";")
    write(path, rows)
