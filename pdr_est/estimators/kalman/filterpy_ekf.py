"""The extended Kalman filter of the estimator `ekf`: that of filterpy, with the arithmetic of `NodeFilter`.

filterpy takes most of a second to load, because it loads all of scipy. Estimators that only weigh hypotheses about
a walk use `NodeFilter` alone.
"""

from filterpy.kalman import ExtendedKalmanFilter

from pdr_est.estimators.common.motion_model import STATES
from pdr_est.estimators.kalman.predict_and_update import NodeFilter


class MultiDeviceEkf(NodeFilter, ExtendedKalmanFilter):  # type: ignore[misc]
    """Extended Kalman filter of filterpy, whose predictions and updates are those of `NodeFilter`.

    They have filterpy's products in its order, without the copies that it keeps.

    Parameters
    ----------
    devices
        Number of devices.
    """

    def __init__(self, devices: int = 1) -> None:
        ExtendedKalmanFilter.__init__(self, dim_x=STATES * devices, dim_z=2)
        super().__init__(devices)
