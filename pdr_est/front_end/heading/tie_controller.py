"""TIE controller of PSP: compensation of the Turn Insufficient Effect.

A phone that swings in a pocket has its y axis out of the vertical, so that its gyroscope shows too little of every
turn (eq. 1). What HDE has to add on straight paths is taken for a measure of the swing, and its average is added in
turns, in the sense of the turn: P = T * mean(I).

Reading of the paper. "The average of all I_i values" cannot be the signed mean. In the closed loop the signed mean
balances the drift of the gyroscope and has the opposite sign, so that T * mean(I) would take away from every turn to
one side, and add the drift once more. The effect is a shortfall of every turn, and what increases every turn is a
positive mean: that of the magnitudes, zeros of eq. 4 included. `average` = "corrections" leaves these zeros out: a
stride for which eq. 4 has set I to 0 was not corrected, and says nothing of the swing. "signed" gives the literal
mean. Drift and swing remain one number in it, as the paper has it: a larger drift makes it compensate for more than
there is.

References
----------
PSP: Hong et al. 2013, eqs. 1 and 5.
"""

from typing import Literal

from pdr_est.params import params


@params
class TieParams:
    """Parameters of PSP's TIE controller."""

    average: Literal["magnitude", "corrections", "signed"] = "magnitude"
    """Average of the compensations that HDE made on straight paths: "magnitude" of |I|, "corrections" of |I| where it
    is not 0, "signed" of I.
    """


class TieController:
    """Record HDE's compensation on straight paths and put its mean in its place in turns.

    Parameters
    ----------
    parameters : TieParams
        Kind of average.
    """

    def __init__(self, parameters: TieParams) -> None:
        self._average = parameters.average
        self._sum_rad = 0.0
        self._count = 0

    def update(self, turn: int, compensation_rad: float) -> float:
        """Compute P (eq. 5) from T and I_i; 0 in turns before the first straight stride."""
        if turn != 0:
            return turn * self._sum_rad / self._count if self._count else 0.0
        self._sum_rad += compensation_rad if self._average == "signed" else abs(compensation_rad)
        self._count += self._average != "corrections" or compensation_rad != 0.0
        return compensation_rad
