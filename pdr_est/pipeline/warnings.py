"""Warnings about a walk and its settings."""

from collections import Counter
from collections.abc import Iterator, Sequence

from pdr_est.config import Config
from pdr_est.estimators import EstimatorSpec
from pdr_est.front_end.heading import IN_POCKETS
from pdr_est.pipeline.present_floors import PlansOfWalk
from pdr_est.preprocessing.quality.warnings import quality_warnings
from pdr_est.types.analysis import DeviceWalk
from pdr_est.types.findings import FindingKind
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording
from pdr_est.types.sensors import Gap
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

_ELSEWHERE = (CarryingMode.HOLDING, CarryingMode.SWING)
_MOST_OFF_PLAN = 0.25  # of the poses; on the plans of a competition no walk has more than a few percent (ours)
_MOST_OUTSIDE = 0.25  # of the steps; the recogniser is seldom wrong for so many


def warnings_of(recording: Recording, walks: Sequence[DeviceWalk]) -> tuple[str, ...]:
    """Collect what makes the walks of the devices doubtful; the warnings of the reader come first."""
    found = []
    for device, walk in zip(recording.devices, walks, strict=True):
        words = [*walk.warnings, *quality_warnings(device)]
        if walk.gaps:
            words.append(f"{_gaps_in_words(walk.gaps)}, listed by `pdr-est inspect`")
        if not walk.steps:
            words.append("no step found")
        found += [f"{walk.device}: {text}" for text in words]
    return tuple(found)


def mismatches(
    walks: Sequence[DeviceWalk],
    config: Config,
    spec: EstimatorSpec,
    fixes: Sequence[PositionFix] = (),
    plan: FloorPlan | BuildingPlan | None = None,
) -> tuple[str, ...]:
    """Warn of choices that do not fit the walk or what is known of it. spec: of the estimator."""
    found = []
    name, start = spec.name, config.start.pose()
    if fixes and not spec.uses_fixes:
        known = start.position_m is not None and start.heading_rad is not None
        use = "makes no use of the position fixes" if known else "only aligns the track with the position fixes"
        found.append(f"{name} {use}: choose the estimator factor-graph or ekf for a track that follows them")
    if plan is not None:
        found += notes_of_plan(plan)
        if not spec.uses_plan:
            takes = "only the directions of the walls from" if spec.smooths else "nothing from"
            found.append(f"{name} takes {takes} the floor plan: with `particle` the track stays on the floor")
    if config.heading.method in IN_POCKETS:
        found += [words for walk in walks for words in _outside_pockets(walk, config.heading.method)]
    return tuple(found)


def notes_of_plan(plan: FloorPlan | BuildingPlan) -> list[str]:
    """List what the reader of a plan remarked, of the building and of each floor."""
    floors = plan.plans if isinstance(plan, BuildingPlan) else ()
    return [f"plan {one.name}: {note}" for one in (plan, *floors) for note in one.notes]


def doubts(track: Track, plans: PlansOfWalk, spec: EstimatorSpec) -> tuple[str, ...]:
    """Put the doubtful findings of a track into words, and plans that its estimator, by its spec, did not keep to."""
    doubtful = [finding for finding in track.findings if finding.doubtful]
    told = any(finding.kind is FindingKind.PLAN for finding in doubtful)
    share = plans.share_outside(track.time_s, track.position_m) if spec.uses_plan and not told else 0.0
    words = (
        f"{share:.0%} of the poses lie off the floor plan, so that it does not fit this walk: check the floor, the "
        "scale and the frame of the plan, and the start"
    )
    return (*([words] if share > _MOST_OFF_PLAN else []), *(finding.words for finding in doubtful))


def _outside_pockets(walk: DeviceWalk, method: str) -> Iterator[str]:
    """Warn if a method for phones upright in a pocket was chosen and the phone was mostly elsewhere."""
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
    """Tell number and total length of the gaps; gaps of several channels that overlap count as one."""
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
