"""The work of `pdr-est smooth` on one walk: read, smooth, learn, write."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pdr_est import pipeline
from pdr_est.calibration.profile import LearntWalk, apply_profile
from pdr_est.calibration.step_length_fit import NotLearnt
from pdr_est.cli.clock_options import apply_clock_messages
from pdr_est.cli.error_context import prefix_errors
from pdr_est.cli.fix_options import (
    NO_FLOOR_PLAN,
    PlanChoice,
    load_fixes,
    placed_by_plan,
    without_used_truth,
)
from pdr_est.cli.many_walks import Done
from pdr_est.cli.profile_options import NO_PROFILE, WalkersProfile
from pdr_est.cli.progress import ProgressBar, progress_bar
from pdr_est.cli.recording_part import WHOLE, RecordingPart
from pdr_est.cli.walk_list import NamedPath
from pdr_est.config import Config
from pdr_est.errors import OutputError
from pdr_est.evaluate.trajectories.on_recording import with_surveyed_truth
from pdr_est.io.side_tables.position_fixes import fixes_within
from pdr_est.io.trajectories import read_trajectory
from pdr_est.io.writers.checksums import file_digests
from pdr_est.output.atomic_output import staged_folder

if TYPE_CHECKING:
    from pdr_est.report.background.kinds import Background

REPORT = "report.html"


@dataclass(frozen=True)
class SmoothRequest:
    """Options of `pdr-est smooth` about the work on a walk.

    Attributes
    ----------
    config : Config
        Configuration, with the constants of the profile.
    fixes : str or None
        Value of the option `--fixes`.
    part : RecordingPart
        Part of the recordings that is used.
    messages : Path or None
        Table of messages by which the devices compared their clocks.
    own : WalkersProfile
        Profile of the walker, and whether it learns.
    overwrite : bool
        True if results of an earlier run may be replaced.
    inputs : tuple of Path
        Files and folders that are read and never overwritten.
    report : bool
        True to write the page with the pictures, which takes longer than all the rest.
    truth : Path or None
        File of true positions, which measure the errors.
    formats : tuple of str or None
        Formats of the track for other programs; None for the default.
    background : Background or None
        What lies below the track on the map of the report.
    plan : PlanChoice
        Floor plan of the walk.
    """

    config: Config
    fixes: str | None = None
    part: RecordingPart = WHOLE
    messages: Path | None = None
    own: WalkersProfile = NO_PROFILE
    overwrite: bool = False
    inputs: tuple[Path, ...] = ()
    report: bool = True
    truth: Path | None = None
    formats: tuple[str, ...] | None = None
    background: "Background | None" = None
    plan: PlanChoice = NO_FLOOR_PLAN


@dataclass(frozen=True)
class SmoothedFolder:
    """Result of a walk.

    Attributes
    ----------
    summary : dict
        Content of `summary.json`.
    learnt : LearntWalk, NotLearnt or None
        What the profile got from the walk; None if no profile learns.
    words : tuple of str
        Lines about the profile.
    """

    summary: dict[str, Any]
    learnt: LearntWalk | NotLearnt | None
    words: tuple[str, ...]

    @property
    def left_out(self) -> tuple[str, ...]:
        """Lines about formats that were left out although the recording has positions on the Earth."""
        reasons: dict[str, str] = self.summary["formats"]["left_out"]
        if not reasons or self.summary["recording"]["origin"] is None:
            return ()
        return (f"not written: {', '.join(reasons)}; {next(iter(reasons.values()))}",)

    @property
    def found_place(self) -> tuple[str, ...]:
        """Line about the place of a walk on its plan, where it was found without a start."""
        search = self.summary["place_search"]
        return () if search is None or search["unique_since"] is None else (search["words"],)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Doubts about the walk, in words."""
        doubtful = isinstance(self.learnt, NotLearnt) and self.learnt.doubtful
        return (*self.summary["warnings"], *((self.words[0],) if doubtful else ()))


def smooth_to_folder(
    output: Path, paths: Sequence[Path], request: SmoothRequest, quiet: bool = True
) -> SmoothedFolder:
    """Smooth the recordings of one walk into a folder, which appears completely or not at all.

    Parameters
    ----------
    output : Path
        Folder of the results.
    paths : sequence of Path
        Recordings of the walk.
    request : SmoothRequest
        The options.
    quiet : bool
        True to show no progress bar.
    """
    with (
        request.own.saved(request.config, request.inputs) as save,
        progress_bar("reading", total=4, quiet=quiet) as bar,
        staged_folder(output, request.overwrite, request.inputs) as folder,
    ):
        summary, learnt = _smooth_into(folder, paths, request, bar)
        words = save(learnt)  # before the results appear, so that there are none if the profile refuses the walk
    return SmoothedFolder(summary, learnt, tuple(words))


def smooth_one_of_many(request: SmoothRequest, output: Path, walk: NamedPath) -> Done:
    """Smooth one of several walks into the folder of its name below `output`."""
    target = output / walk.name
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{target}: cannot be written ({error.strerror}): choose another output folder") from error
    result = smooth_to_folder(target, [walk.path], request)
    summary = result.summary
    row = {key: summary[key] for key in ("steps", "distance_m", "duration_s", "frame")}
    errors = summary["errors_against_truth"] or {}
    row |= {key: errors[key] for key in ("ate_rigid_m", "length_ratio") if key in errors}
    return Done({**row, "warnings": len(result.warnings), "folder": str(target)}, result.warnings)


def _smooth_into(
    folder: Path, paths: Sequence[Path], request: SmoothRequest, bar: ProgressBar
) -> tuple[dict[str, Any], LearntWalk | NotLearnt | None]:
    """Read, smooth and write a walk into an existing folder; return the summary, and what a profile learns."""
    from pdr_est.report.walk.result_files import write_results  # matplotlib is slow to load
    from pdr_est.report.walk.track_formats import require_possible_formats

    part, own, config = request.part, request.own, request.config
    surveyed = None if request.truth is None else read_trajectory(request.truth)  # before the long work
    whole = apply_clock_messages(part.read(paths), request.messages)
    plan = request.plan.load(whole.origin)
    whole = placed_by_plan(whole, plan)
    known = load_fixes(request.fixes, whole, paths[0])
    prior = own.prior_of(whole, known)
    config = config if prior is None else apply_profile(config, prior)
    bar.start_part("smoothing")
    with prefix_errors(", ".join(map(str, paths))):
        recorded = without_used_truth(part.cut(whole), request.fixes)
        if surveyed is not None:  # after the fixes, so that it never becomes one
            recorded = with_surveyed_truth(recorded, surveyed)
        require_possible_formats(request.formats, recorded)
        known = known if part.is_all else fixes_within(known, recorded)
        walk = pipeline.smooth_recording(recorded, config, known, plan=plan)
        learnt = own.learnt_from(whole, recorded, walk.devices, config, known)
    bar.start_part("writing")
    digests = {name: digest for path in paths for name, digest in _digests(path, len(paths) > 1).items()}
    digests |= request.plan.digests()
    digests |= {} if request.truth is None else {str(request.truth): file_digests(request.truth)[request.truth.name]}
    summary = write_results(
        folder,
        walk,
        recorded,
        config,
        digests,
        prior,
        with_report=request.report,
        formats=request.formats,
        background=request.background,
    )
    return summary, learnt


def _digests(path: Path, several: bool) -> dict[str, str]:
    """Compute checksums by file; of several recordings by their paths, since files of one app have the same names."""
    digests = file_digests(path)
    if not several:
        return digests
    return {str(path) if path.is_file() else str(path / name): digest for name, digest in digests.items()}
