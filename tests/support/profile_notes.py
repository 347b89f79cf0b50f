"""A note of a profile that was made with other settings than the defaults."""

from datetime import date

from pdr_est.calibration.profile import ProfileNote
from pdr_est.front_end.step_length import StepLengthParams

NOTE = ProfileNote(
    step_length=StepLengthParams(model="weinberg", weinberg_k2=0.5),
    law="weinberg",
    detector="local-variance",
    height_m=1.6,
    gender="female",
    date=date(2024, 2, 29),
)
