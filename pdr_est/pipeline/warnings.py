"""What makes a walk doubtful, in words."""

from collections import Counter
from collections.abc import Iterator, Sequence

from pdr_est.config import Config
from pdr_est.estimators import RECKONERS
from pdr_est.front_end.heading import IN_POCKETS, HeadingName
from pdr_est.preprocessing.quality.warnings import quality_warnings
from pdr_est.types.analysis import DeviceWalk
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording
from pdr_est.types.sensors import Gap
from pdr_est.types.steps import CarryingMode

_ELSEWHERE = (CarryingMode.HOLDING, CarryingMode.SWING)
_MOST_OUTSIDE = 0.25  # of the steps; the recogniser is seldom wrong for so many


def warnings_of(recording: Recording, walks: Sequence[DeviceWalk]) -> tuple[str, ...]:
    """What makes the walks of a recording's devices doubtful, in words: what the reader saw comes first."""
    found = []
    for device, walk in zip(recording.devices, walks, strict=True):
        words = [*walk.warnings, *quality_warnings(device)]
        if walk.gaps:
            words.append(f"{_gaps_in_words(walk.gaps)}, listed by `pdr-est inspect`")
        if not walk.steps:
            words.append("no step found")
        found += [f"{walk.device}: {text}" for text in words]
    return tuple(found)


def mismatches(walks: Sequence[DeviceWalk], config: Config, fixes: Sequence[PositionFix] = ()) -> tuple[str, ...]:
    """What was chosen that does not fit the walk or what is known of it, in words."""
    found = []
    name, start = config.estimator.name, config.start.pose()
    if fixes and name in RECKONERS:
        known = start.position_m is not None and start.heading_rad is not None
        use = "makes no use of the position fixes" if known else "only aligns the track with the position fixes"
        found.append(f"{name} {use}: choose the estimator factor-graph or ekf for a track that follows them")
    if config.heading.method in IN_POCKETS:
        found += [words for walk in walks for words in _outside_pockets(walk, config.heading.method)]
    return tuple(found)


def _outside_pockets(walk: DeviceWalk, method: HeadingName) -> Iterator[str]:
    """For a method that integrates the turns of a phone upright in a pocket."""
    modes = Counter(step.event.mode for step in walk.steps)
    outside = {mode: modes[mode] for mode in _ELSEWHERE if modes[mode]}
    if sum(outside.values()) > _MOST_OUTSIDE * len(walk.steps):
        share = sum(outside.values()) / len(walk.steps)
        names = " or ".join(mode.name for mode in outside)
        yield (
            f"{walk.device}: the heading method {method} is for a phone upright in a trouser pocket, but it was "
            f"{names} for {share:.0%} of the steps, where its headings mean nothing: choose --heading-method auto"
        )


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
