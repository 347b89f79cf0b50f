"""Replay a recording as if its phones were recording now."""

import time
from collections.abc import Sequence

from pdr_est.live.session import LiveSession
from pdr_est.online.recording_stream import stream_slices
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording

_MOST_WAITING = 200  # slices of a tenth of a second


def replay_into(session: LiveSession, recording: Recording, fixes: Sequence[PositionFix], speed: float) -> None:
    """Send the samples of a recording to a walk, and end the walk after the last one.

    Parameters
    ----------
    session
        The walk; its limits must allow the number of samples a second.
    recording
        Recording of all devices.
    fixes
        Known positions.
    speed
        How many times faster than the recording was made. The filter is waited for where it cannot follow.
    """
    phones = {device.name: session.join("replay", device.name) for device in recording.devices}
    begun_s: float | None = None
    for moment in stream_slices(recording.devices, fixes):
        begun_s = time.monotonic() - moment.time_s / speed if begun_s is None else begun_s
        late_s = time.monotonic() - begun_s - moment.time_s / speed
        if session.ended.wait(max(-late_s, 0.0)):
            return
        while session.waiting > _MOST_WAITING and not session.ended.wait(0.01):
            pass
        for fix in moment.fixes:
            session.put_fix(fix)
        for name, block in moment.blocks:
            session.take(phones[name], [block])
    session.stop()
