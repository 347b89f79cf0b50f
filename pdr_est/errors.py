"""The exceptions of the project.

Every message names the value, the place and the remedy. Only the command line turns them into exit codes.
"""


class PdrError(Exception):
    """Base of everything that this package raises on purpose."""


class RecordingError(PdrError):
    """A recording cannot be used: unknown format, damaged file, missing sensor."""


class ConfigError(PdrError):
    """A configuration or an option has an unknown key or a value out of range."""


class EstimationError(PdrError):
    """An estimator cannot give a track from the measurements it was given."""


class OutputError(PdrError):
    """A result cannot be written."""
