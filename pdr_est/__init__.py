"""pdr_est: the track of a walking person, with honest uncertainty, from the inertial recordings of phones."""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pdr_est.config import Config, load_config
    from pdr_est.errors import PdrError
    from pdr_est.io.formats.registry import read
    from pdr_est.online import Tracker
    from pdr_est.types.measurements import PositionFix
    from pdr_est.types.recording import Recording
    from pdr_est.types.track import Track

try:
    __version__ = version("pdr-est")
except PackageNotFoundError:  # run from a source tree that is not installed
    __version__ = "0+unknown"

__all__ = [
    "Config",
    "PdrError",
    "PositionFix",
    "Recording",
    "Track",
    "Tracker",
    "__version__",
    "load_config",
    "read",
    "smooth",
]

_HOMES = {
    "Config": "pdr_est.config",
    "PdrError": "pdr_est.errors",
    "PositionFix": "pdr_est.types.measurements",
    "Recording": "pdr_est.types.recording",
    "Track": "pdr_est.types.track",
    "Tracker": "pdr_est.online",
    "load_config": "pdr_est.config",
    "read": "pdr_est.io.formats.registry",
}


def __getattr__(name: str) -> Any:
    """Load a name at its first use: the libraries behind it take seconds, during which Ctrl-C must work."""
    if name not in _HOMES:
        raise AttributeError(f"module 'pdr_est' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def smooth(recording: Recording, config: Config | None = None, fixes: Sequence[PositionFix] = ()) -> Track:
    """Track of a recorded walk by the configured estimator (default: factor graph).

    fixes: known positions, in the map frame. Use `pdr_est.pipeline.smooth` for the steps and timings as well.
    Raises PdrError subclasses for recordings and settings that give no track.
    """
    from pdr_est import config as configuration
    from pdr_est import pipeline

    return pipeline.smooth(recording, config or configuration.Config(), fixes).track
