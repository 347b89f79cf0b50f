"""What makes a walk doubtful, in words."""

from collections.abc import Sequence

from pdr_est.device_walk import DeviceWalk
from pdr_est.io.doubts import doubts
from pdr_est.io.recording import Recording
from pdr_est.records import Gap


def warnings_of(recording: Recording, walks: Sequence[DeviceWalk]) -> tuple[str, ...]:
    """What makes the walks of a recording's devices doubtful, in words: what the reader saw comes first."""
    found = []
    for device, walk in zip(recording.devices, walks, strict=True):
        words = [*walk.warnings, *doubts(device)]
        if walk.gaps:
            words.append(f"{_gaps_in_words(walk.gaps)}, listed by `pdr-est inspect`")
        if not walk.steps:
            words.append("no step found")
        found += [f"{walk.device}: {text}" for text in words]
    return tuple(found)


def _gaps_in_words(gaps: Sequence[Gap]) -> str:
    """Their number and length; gaps of several channels that overlap are one."""
    ends: list[float] = []
    total_s = 0.0
    for gap in sorted(gaps, key=lambda gap: gap.start_s):
        latest_s = ends[-1] if ends else gap.start_s
        total_s += max(gap.end_s - max(gap.start_s, latest_s), 0.0)
        if ends and gap.start_s < latest_s:
            ends[-1] = max(latest_s, gap.end_s)
        else:
            ends.append(gap.end_s)
    what = "1 gap or clock jump" if len(ends) == 1 else f"{len(ends)} gaps or clock jumps"
    return f"{what}, {total_s:.1f} s in all"
