"""Parameters of the default heading."""

from typing import Annotated

from annotated_types import Ge, Le

from pdr_est.params import Fraction, Positive, params

_Angle = Annotated[float, Ge(0.05), Le(1.5)]


@params
class AutoHeadingParams:
    """Parameters of the default heading.

    All values are ours. Those of turns and of the principal axis are near those of the greatest likelihood of the
    true turns of 200 simulated walkers, of whose changes every other one is near a corner, but they leave more room
    for what is not simulated.
    """

    whole_walk: bool = True
    """True to estimate the turns while the phone was put elsewhere once more at the end of the walk, from all steps
    before and after. False leaves them as they are online.
    """
    moved_rad: _Angle = 0.7
    """Change of the direction of gravity in the phone, rad, mean over a step, beyond which it was put elsewhere."""
    moved_in_mode_rad: _Angle = 0.35
    """The same, rad, where the carrying mode is another one, too."""
    other_mode_steps: Annotated[int, Ge(1), Le(20)] = 2
    """Number of steps in a row in another carrying mode after which the phone was put elsewhere in any posture:
    a hand at the thigh and a trouser pocket may hold it alike.
    """
    flip: Annotated[float, Ge(0.0), Le(0.99)] = 0.7
    """Probability that another carrying mode in hardly another posture is an error of the recogniser, before anything
    else is known; each walk tells more. Of such changes, all of 80 or more in real walks whose phones stay in one
    place are errors, and none of 8 of simulated walkers who put the phone elsewhere one to four times.
    """
    sigma_flip_rad: Positive = 0.12
    """Standard deviation, rad, of the direction of gravity from step to step about each level axis in a phone that
    stays while the recogniser errs.
    """
    swung_rad: _Angle = 1.4
    """Change of the direction of gravity, rad, from one step to the next below which a phone in a swinging hand was
    not moved.
    """
    returned_rad: _Angle = 0.4
    """Posture change, rad, below which the phone counts as back in its old posture."""
    bend_rad: _Angle = 0.26
    """Turn within a stride, rad, beyond which steps are not averaged over it: the walker is turning."""
    training_steps: Annotated[int, Ge(2), Le(20)] = 4
    """Number of steps in a new place from which the heading offset is learnt."""
    straight: Fraction = 0.76
    """Probability that a walker who turns neither before nor after goes straight on meanwhile."""
    sigma_kept_rad: Positive = 0.04
    """Standard deviation, rad, of the heading of a walker who goes straight on."""
    any_turn: Fraction = 0.003
    """Probability of a turn by any angle."""
    sigma_axis_rad: Positive = 0.08
    """Standard deviation, rad, of the principal axis against the walking direction, by how the phone is worn."""
    same_place: Fraction = 0.8
    """Probability that a phone in the same carrying mode and posture as before has the same heading offset."""
    same_in_other_mode: Fraction = 0.3
    """Probability that a phone which is said to be in another mode now, in the same posture, was not moved at all."""
    sigma_posture_rad: Positive = 0.2
    """Standard deviation, rad, of the direction of gravity in a phone that is carried as before."""
    sigma_offset_rad: Positive = 0.15
    """Standard deviation, rad, of the heading offset of a phone that is carried as before."""
