"""Online filter: samples of phones come in, estimates come out while the walk is recorded."""

from pdr_est.online.device_front_end import ExpectedDevice
from pdr_est.online.params import OnlineParams
from pdr_est.online.tracker import Tracker
from pdr_est.online.update import Update, track_of

__all__ = ["ExpectedDevice", "OnlineParams", "Tracker", "Update", "track_of"]
