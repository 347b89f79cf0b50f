"""The exceptions of the library, all derived from `PdrError`.

A message names the value that is wrong, the place where it stands and the remedy. Only the command line turns
exceptions into exit codes.
"""


class PdrError(Exception):
    """Base class of every error that the library raises on purpose."""


class RecordingError(PdrError):
    """A recording cannot be used: its format is unknown, its file is damaged, or a sensor is missing."""


class ConfigError(PdrError):
    """A configuration or an option has an unknown key or a value out of range."""


class EstimationError(PdrError):
    """An estimator cannot compute a track from the measurements that it was given."""


class OutputError(PdrError):
    """A result cannot be written or shown."""
