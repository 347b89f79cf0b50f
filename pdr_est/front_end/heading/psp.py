"""Headings from the y axis of a phone in a trouser pocket, after PSP.

The gyroscope's y axis is integrated over each stride. `gyro` adds up these increments and nothing else, `hde` adds
the compensation of the HDE controller, `psp` that of HDE and TIE controller, each as a feedback system:

    psi_i = dpsi_i + psi_{i-1} + P,    P from psi_{i-1} and psi_{i-2} (eqs. 2 to 5)

The phone has to stand nearly upright in the pocket; of a phone that lies flat the y axis knows no turns. Turns
between strides, of a walker who stands, are not integrated, as in the paper.

In pockets of OxIOD the y axis of a phone that circles with the leg gains 34 to 55 degrees a minute on the walker, far
more than the gyroscope's bias, while the yaw of the attitude does not. This is what the controllers have to remove.

Readings of the paper. (1) A stride is two steps: the y axis of a phone at a leg turns to and fro with each step, by
15 to 18 degrees in OxIOD, more than the threshold of a turn, and comes back after two. Both steps get the heading of
the stride. (2) Whether priors or increments come of it is not the paper's question: as priors, the headings are those
of the gyroscope alone, and straight strides (T = 0) have the dominant direction nearest to the compensated heading.

Deviations. (1) The paper's phones stand with their upper edge up; turns of phones that stand on their head are
counted with the other sign, by the mean direction of gravity of each stride. (2) The rotation rate is less the bias
that the attitude filter knows.

References
----------
PSP: Hong et al. 2013, section II-B.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.frames import wrap_angle
from pdr_est.front_end.heading.hde_controller import HdeController, HdeParams
from pdr_est.front_end.heading.stride_pairing import STRIDE_LATENCY_S, StridePairing
from pdr_est.front_end.heading.tie_controller import TieController, TieParams
from pdr_est.types.steps import Step


class PspHeading:
    """Stage Step -> Step that fills in the heading and, with `priors`, the directions of straight paths.

    The headings begin at 0 and go on over gaps of the recording, in which nothing is known of the turn.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the level samples.
    hde : HdeParams or None
        Parameters of the HDE controller; None for the gyroscope alone.
    tie : TieParams or None
        Parameters of the TIE controller; None for HDE alone.
    priors : bool
        True to give straight strides a `path_heading_rad` instead of correcting their headings.
    """

    latency_s = STRIDE_LATENCY_S

    def __init__(self, rate_hz: float, hde: HdeParams | None, tie: TieParams | None, priors: bool) -> None:
        self._rate_hz = rate_hz
        self._hde_parameters = hde
        self._priors = priors
        self._strides = StridePairing()
        self._segment: int | None = None
        self._hde = None if hde is None else HdeController(hde)
        self._tie = None if tie is None else TieController(tie)
        self._latest_rad = self._before_rad = 0.0  # psi_{i-1}, psi_{i-2}
        self._gyro_rad = 0.0

    def push(self, item: Step, /) -> list[Step]:
        """Take the next step and return those of a complete stride with their heading."""
        return [step for steps in self._strides.add(item) for step in self._stride(steps)]

    def flush(self) -> list[Step]:
        """Return the step that waits for the second of its stride."""
        return [step for steps in self._strides.flush() for step in self._stride(steps)]

    def _stride(self, steps: Sequence[Step]) -> list[Step]:
        if steps[0].event.segment != self._segment:  # a gap in which nothing is known of the turn
            self._segment, self._before_rad = steps[0].event.segment, self._latest_rad
        increment_rad = y_turn_rad(steps, self._rate_hz)
        duration_s = sum(len(step.samples) for step in steps) / self._rate_hz
        turn, compensation_rad = self._compensation(duration_s)
        heading_rad = increment_rad + self._latest_rad + compensation_rad
        self._latest_rad, self._before_rad = heading_rad, self._latest_rad
        self._gyro_rad += increment_rad
        if self._hde is None or self._hde_parameters is None or not self._priors:
            return [replace(step, heading_rad=float(wrap_angle(heading_rad))) for step in steps]
        path_heading_rad = self._hde.dominant_rad(heading_rad) if turn == 0 else np.nan
        sigma_rad = self._hde_parameters.sigma_straight_rad if turn == 0 else np.nan
        return [
            replace(
                step,
                heading_rad=float(wrap_angle(self._gyro_rad)),
                path_heading_rad=path_heading_rad,
                sigma_path_heading_rad=sigma_rad,
            )
            for step in steps
        ]

    def _compensation(self, duration_s: float) -> tuple[int, float]:
        """Compute T and P of the next stride."""
        if self._hde is None:
            return 0, 0.0
        turn, compensation_rad = self._hde.update(self._latest_rad, self._before_rad, duration_s)
        if self._tie is not None:
            return turn, self._tie.update(turn, compensation_rad)
        return turn, compensation_rad if turn == 0 else 0.0


def y_turn_rad(steps: Sequence[Step], rate_hz: float) -> float:
    """Compute the turn to the left over some steps by the y axis alone, rad; each sample lasts 1 / rate_hz."""
    rate_radps = np.concatenate([step.samples.rotation_rate_radps[:, 1] for step in steps])
    upright = np.concatenate([step.samples.up[:, 1] for step in steps])
    sign = -1.0 if np.mean(upright) < 0.0 else 1.0
    return sign * float(np.sum(rate_radps)) / rate_hz
