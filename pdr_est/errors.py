"""The exceptions of the library, all derived from `PdrError`.

A message names the value that is wrong, the place where it stands and the remedy. Only the command line turns
exceptions into exit codes.
"""


class PdrError(Exception):
    """Base class of every error that the library raises on purpose."""


class RecordingError(PdrError):
    """A recording cannot be used: its format is unknown, its file is damaged, or a sensor is missing."""


class SeveralWalksError(RecordingError):
    """A folder or an archive holds several recordings where one was asked for.

    Attributes
    ----------
    walks
        Their names: files or folders inside, or what the format calls a walk.
    by_device
        True where one of them is chosen by its name, as a device is, and is no file or folder of its own.
    """

    def __init__(self, message: str, walks: tuple[str, ...] = (), *, by_device: bool = False) -> None:
        super().__init__(message)
        self.walks = walks
        self.by_device = by_device


class FloorPlanError(PdrError):
    """A floor plan cannot be used: its file is damaged, its polygons or units are wrong, or the floor is missing."""


class ConfigError(PdrError):
    """A configuration or an option has an unknown key or a value out of range."""


class EstimationError(PdrError):
    """An estimator cannot compute a track from the measurements that it was given."""


class OutputError(PdrError):
    """A result cannot be written or shown."""
