"""Say what of a recording a format has no place for, so that nothing is lost without a word."""

from collections.abc import Iterator, Sequence

from pdr_est.errors import OutputError
from pdr_est.types.recording import DeviceRecording, Recording
from pdr_est.types.sensors import AttitudeReference


def only_device(recording: Recording) -> DeviceRecording:
    """Return the device of a recording of one device.

    Raises
    ------
    OutputError
        For several devices.
    """
    if len(recording.devices) != 1:
        names = ", ".join(device.name for device in recording.devices)
        raise OutputError(
            f"{recording.name}: {len(recording.devices)} devices ({names}) do not fit into one file; write each into "
            "its own with --device NAME"
        )
    return recording.devices[0]


def left_out(recording: Recording, written: Sequence[str]) -> tuple[str, ...]:
    """List what a recording has and a format does not hold, in words.

    Parameters
    ----------
    recording
        Recording of one device.
    written
        Parts that the format holds: "date", "fixes", "waypoints", "positions", "pressure", "linear acceleration",
        "model", "platform", "axes", "reference".
    """
    return tuple(words for part, words in _parts(recording) if part not in written)


def _parts(recording: Recording) -> Iterator[tuple[str, str]]:
    truth = recording.truth
    if recording.epoch_s is not None:
        yield "date", "the date of time zero"
    if recording.fixes:
        yield "fixes", f"{len(recording.fixes)} position fixes"
    if recording.waypoints:
        yield "waypoints", f"{len(recording.waypoints)} marked positions"
    if truth.positions is not None:
        yield "positions", f"{len(truth.positions.time_s)} true positions ({truth.positions.source})"
    others = (
        truth.steps,
        truth.turns,
        truth.strides,
        truth.modes,
        truth.step_count,
        truth.distance_m,
        truth.speed_mps,
    )
    if any(one is not None for one in others):
        yield "truth", "reference data other than positions"
    for device in recording.devices:
        yield from _parts_of_device(device)
    if recording.messages:
        yield "messages", "clock messages"


def _parts_of_device(device: DeviceRecording) -> Iterator[tuple[str, str]]:
    if device.linear_acceleration is not None:
        yield "linear acceleration", "acceleration without gravity"
    if device.pressure is not None:
        yield "pressure", "air pressure"
    if device.model:
        yield "model", f"the model of the device, {device.model}"
    if device.platform:
        yield "platform", f"its platform, {device.platform}"
    if not device.usual_axes:
        yield "axes", "the statement that its axes are not those of a phone"
    if device.attitude is not None and device.attitude_reference is not AttitudeReference.UNKNOWN:
        yield "reference", f"what the yaw of its attitude counts from, {device.attitude_reference}"
