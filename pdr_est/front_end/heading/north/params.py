"""Parameters of the headings against north."""

from typing import Annotated, Literal

from annotated_types import Ge, Le

from pdr_est.params import NonNegative, Positive, params

NorthSource = Literal["auto", "device", "magnetometer", "none"]


@params
class NorthParams:
    """Choose what tells north, and its standard deviations.

    The error of a heading against north has a part that stays, a part that wanders as the walker passes iron, and
    the declination. The defaults of the first two come from the pooled variograms of the errors on ILC20's two malls
    and IPIN 2023's building. At the single sites the standard deviation of the part that stays is 6, 7 and 5 degrees,
    that of the wandering part 9, 9 and 14 degrees, and its correlation length is 6 to 8 m. No site was kept apart:
    what was measured with these defaults was measured on the same walks.
    """

    source: NorthSource = "auto"
    """Source of the direction: "device" takes the attitude that the device recorded, where the reader knows that its
    yaw counts from north; "magnetometer" takes the recorded magnetic field, levelled by the attitude filter; "auto"
    takes the first of the two that there is; "none" leaves every heading relative. Used with `heading.method: auto`.
    """
    sigma_hold_rad: Positive = 0.08
    """Standard deviation, rad, of the part that stays through a walk: of the way in which a phone is held in front of
    the body, and of the mean field of the building.
    """
    sigma_calibration_rad: NonNegative = 0.15
    """Standard deviation, rad, that the calibration of a magnetometer adds to the part that stays, for the source
    "magnetometer"; operating systems calibrate it for their own attitude. Chosen after three walks of
    phone-gps, by a phone whose field is a fifth too strong, which are turned by 7, 10 and 22 degrees.
    """
    sigma_disturbance_rad: Positive = 0.22
    """Standard deviation, rad, of the part that wanders, from iron in the building."""
    disturbance_length_m: Annotated[Positive, Le(1000.0)] = 8.0
    """Distance, m, over which the correlation of the wandering part falls to 1/e."""
    sigma_declination_rad: NonNegative = 0.09
    """Standard deviation, rad, of the direction of magnetic north where the declination is not known, because the
    position is not.
    """
    sigma_step_rad: Positive = 0.05
    """Standard deviation, rad, of the direction of a phone in the hand at a single step, independent from step to
    step.
    """
    least_steps: Annotated[int, Ge(1), Le(20)] = 4
    """Least number of steps in a row, phone in the hand, from which a heading is taken: a glance at the screen while
    the arm swings, and single steps whose carrying mode was mistaken, tell none. Chosen after a look at the walks of
    phone-gps.
    """
    spacing_m: Annotated[Positive, Le(100.0)] = 5.0
    """Distance, m, that is walked from one heading prior to the next; each is the mean of the steps between."""
    disturbed_sigmas: Positive = 3.0
    """Number of standard deviations beyond which a measurement is reported as disturbed."""
