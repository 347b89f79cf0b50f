"""Magnetic declination at a place, by the World Magnetic Model."""

from calendar import isleap
from datetime import UTC, datetime, timedelta
from math import radians

from pygeomag import GeoMag

from pdr_est.types.clock import utc_date

SIGMA_MODEL_RAD = radians(0.5)
"""Standard deviation of the declination by the model at middle latitudes, rad; mostly of the rocks below."""

_OLDEST, _NEWEST = 2010.0, 2030.0  # years that the coefficients of the package cover
_SIGMA_UNDATED_RAD = radians(1.5)  # of a decade, in which the declination changes by 1 to 2 degrees
_YEAR_UNDATED = 2025.0


def magnetic_declination(latitude_deg: float, longitude_deg: float, epoch_s: float | None) -> tuple[float, float]:
    """Compute the magnetic declination at sea level.

    Parameters
    ----------
    latitude_deg, longitude_deg
        Place on the WGS 84 ellipsoid, degrees.
    epoch_s
        Unix time, s; None where it is not known. One that the model does not cover is moved to its nearest year.

    Returns
    -------
    declination_rad, sigma_rad
        Angle from true to magnetic north, rad, clockwise, and its standard deviation.
    """
    date = None if epoch_s is None else utc_date(epoch_s)
    year = _YEAR_UNDATED if date is None else _decimal_year(date)
    covered = min(max(year, _OLDEST), _NEWEST)
    sigma_rad = SIGMA_MODEL_RAD if date is not None and covered == year else _SIGMA_UNDATED_RAD
    model = GeoMag(base_year=int(min(covered, _NEWEST - 1.0)))
    field = model.calculate(glat=latitude_deg, glon=longitude_deg, alt=0.0, time=covered)
    return radians(float(field.d)), sigma_rad


def _decimal_year(date: datetime) -> float:
    begin = datetime(date.year, 1, 1, tzinfo=UTC)
    days = 366 if isleap(date.year) else 365
    return date.year + (date - begin) / timedelta(days=days)
