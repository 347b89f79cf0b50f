"""pdr_est: the track of a walking person, with honest uncertainty, from the inertial recordings of phones."""

from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version

from pdr_est import pipeline
from pdr_est.config import Config, load_config
from pdr_est.errors import PdrError
from pdr_est.io.readers import read
from pdr_est.io.recording import Recording
from pdr_est.records import PositionFix
from pdr_est.track import Track

try:
    __version__ = version("pdr-est")
except PackageNotFoundError:  # run from a source tree that is not installed
    __version__ = "0+unknown"

__all__ = ["Config", "PdrError", "PositionFix", "Recording", "Track", "__version__", "load_config", "read", "smooth"]


def smooth(recording: Recording, config: Config | None = None, fixes: Sequence[PositionFix] = ()) -> Track:
    """Track of a recorded walk by the configured estimator (default: factor graph).

    fixes: known positions, in the map frame. Use `pdr_est.pipeline.smooth` for the steps and timings as well.
    Raises PdrError subclasses for recordings and settings that give no track.
    """
    return pipeline.smooth(recording, config or Config(), fixes).track
