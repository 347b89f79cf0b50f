"""Parameters of the height of the walker and of the floors."""

from typing import Annotated

from annotated_types import Ge, Le

from pdr_est.params import Fraction, NonNegative, Positive, params


@params
class HeightParams:
    """Habits of walkers who change floors, and disturbances of the air pressure.

    Rates, durations and storeys are those of ordinary buildings, and none is fitted to recordings.
    """

    enabled: bool = True
    """Whether height and floor are estimated where the air pressure was recorded."""
    storey_m: Positive = 3.6
    """Usual height of a storey, m: dwellings have 2.8, offices 3.3 to 4, malls 4.5 to 6."""
    sigma_storey_m: Positive = 0.8
    """Standard deviation of the height of a storey between buildings, m."""
    sigma_within_m: Positive = 0.25
    """Standard deviation of the height of a storey within a building, m; ground floors are often higher."""
    time_between_moves_s: Annotated[float, Ge(10.0), Le(1e5)] = 300.0
    """Mean time between two changes of height, s."""
    sigma_height_m: Positive = 0.08
    """Least standard deviation of the mean height in a second by the air pressure, m: noise of phones' barometers."""
    drift_m_per_sqrt_s: Positive = 0.04
    """Random walk of the pressure, as height: m per root second. Weather changes it by 1 m in ten minutes."""
    jumps: Fraction = 0.01
    """Share of seconds in which the pressure jumps: doors, air conditioning, a phone put elsewhere or pressed."""
    sigma_jump_m: Positive = 0.5
    """Standard deviation of such a jump, as height, m."""
    great_jumps: Fraction = 0.001
    """Share of seconds in which it jumps farther, as in a pocket that a leg presses."""
    sigma_great_jump_m: Positive = 1.5
    """Standard deviation of such a jump, as height, m."""
    time_between_disturbances_s: Annotated[float, Ge(2.0), Le(1e5)] = 60.0
    """Mean time between two stretches of disturbed pressure, s: gusts, doors, a pocket that a leg presses."""
    disturbed_s: Annotated[float, Ge(1.0), Le(60.0)] = 4.0
    """Mean duration of such a stretch, s."""
    sigma_disturbed_m: Positive = 0.8
    """Standard deviation of the height by a disturbed pressure, m."""
    least_rise_m: Positive = 2.0
    """Change of height, m, that is as probably a change of floor as not; less is a ramp, a few steps or an error."""
    sigma_least_rise_m: Positive = 0.4
    """Standard deviation of the least change of height of a change of floor, m."""
    sigma_level_m: NonNegative = 0.3
    """Standard deviation of the height within a floor, m: ramps and single steps, which pressure does not tell."""
    sigma_air: NonNegative = 0.02
    """Relative standard deviation of the scale of heights: air that is warmer by 6 K is thinner by 2 %."""
