"""Read a recording and cut it, as the options `--from`, `--to`, `--device` and `--map` say."""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pdr_est.cli.error_context import prefix_errors
from pdr_est.errors import RecordingError
from pdr_est.io import read
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.preprocessing.merge import merge_recordings
from pdr_est.preprocessing.moments import Moment, cut_recording
from pdr_est.types.recording import DeviceRecording, Recording


@dataclass(frozen=True)
class RecordingPart:
    """Part of a recording that a command uses.

    Attributes
    ----------
    begin, end
        First and last moment; None for those of the recording.
    devices
        Names of the devices; empty for all.
    mapping
        What the columns of a table mean; None to find it out.
    """

    begin: Moment | None = None
    end: Moment | None = None
    devices: tuple[str, ...] = ()
    mapping: TableMapping | None = None

    @property
    def is_all(self) -> bool:
        """True where nothing is left out."""
        return self.begin is None and self.end is None and not self.devices

    def read(self, paths: Sequence[Path]) -> Recording:
        """Read the recordings of one walk, with the devices that are used, in full length.

        Raises
        ------
        RecordingError
            If one cannot be read, or has no device of that name.
        """
        return self.join(self.read_files(paths), paths)

    def join(self, recordings: Sequence[Recording], paths: Sequence[Path]) -> Recording:
        """Merge the recordings of one walk that were read from some paths, and keep the devices that are used."""
        merged = merge_recordings(recordings)
        with prefix_errors(", ".join(map(str, paths))):
            return select_devices(merged, self.devices)

    def cut(self, recording: Recording) -> Recording:
        """Keep the time that is used.

        Raises
        ------
        RecordingError
            If nothing is left, or the recording does not tell the clock time.
        """
        return cut_recording(recording, self.begin, self.end)

    def read_cut(self, paths: Sequence[Path]) -> Recording:
        """Read the recordings of one walk, with the devices and the time that are used."""
        recording = self.read(paths)
        with prefix_errors(", ".join(map(str, paths))):
            return self.cut(recording)

    def read_files(self, paths: Sequence[Path]) -> list[Recording]:
        """Read the recordings of one walk. A file that names one of its devices means this one.

        Other devices beside it are left out, and a warning of the device says so unless another of the files brings
        them.
        """
        whole = [read(path, self.mapping, self.devices) for path in paths]
        meant = [self._device_meant(path, recording) for path, recording in zip(paths, whole, strict=True)]
        pairs = list(zip(whole, meant, strict=True))
        used = {
            one.name for recording, device in pairs for one in (recording.devices if device is None else (device,))
        }
        return [recording if device is None else _with_only(recording, device, used) for recording, device in pairs]

    def _device_meant(self, path: Path, recording: Recording) -> DeviceRecording | None:
        """Find the one of several devices that the name of a file tells; None for all."""
        if self.devices or len(recording.devices) < 2 or not path.is_file():
            return None
        words = re.split(r"[^0-9A-Za-z]+", path.name)
        named = [device for device in recording.devices if device.name in words]
        return named[0] if len(named) == 1 else None


def _with_only(recording: Recording, device: DeviceRecording, used: Collection[str]) -> Recording:
    """Keep one device, and warn of the others unless they are used, too."""
    others = [one.name for one in recording.devices if one.name not in used]
    if others:
        note = (
            f"the file is of this device only; {', '.join(others)} of the same walk is left out: give its file, too, "
            "or --device"
        )
        device = replace(device, warnings=(*device.warnings, note))
    return replace(recording, devices=(device,))


WHOLE = RecordingPart()


def select_devices(recording: Recording, names: Sequence[str]) -> Recording:
    """Keep the devices of these names, in the order of the recording; all without names.

    Raises
    ------
    RecordingError
        For a name that no device has, or that is given twice; the message lists the devices.
    """
    if not names:
        return recording
    by_name = {device.name: device for device in recording.devices}
    for number, name in enumerate(names):
        if name not in by_name:
            raise RecordingError(f"{recording.name}: no device {name!r}: give one of {', '.join(by_name)}")
        if name in names[:number]:
            raise RecordingError(f"{recording.name}: the device {name!r} is given twice: give each once")
    return replace(recording, devices=tuple(device for device in recording.devices if device.name in names))
