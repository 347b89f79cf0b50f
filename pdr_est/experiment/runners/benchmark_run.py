"""Run of a benchmark suite."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from scipy.spatial.transform import Rotation

from pdr_est.errors import ConfigError, EstimationError, RecordingError
from pdr_est.experiment.config import DataParams, FixesParams
from pdr_est.experiment.held_out import HeldOutProtocol
from pdr_est.experiment.recording_files import folder_content
from pdr_est.experiment.results.benchmark_result import BenchmarkResult
from pdr_est.experiment.results.walk_result import Failure, WalkResult
from pdr_est.experiment.runners.processes import run_in_processes
from pdr_est.experiment.runners.scoring_job import scoring_job
from pdr_est.experiment.scoring.calibrated import with_calibrated
from pdr_est.experiment.scoring.profiles import with_profiles
from pdr_est.experiment.suite import Suite, WalkFile
from pdr_est.experiment.suites import suite_named
from pdr_est.experiment.variants.axes import Comparison
from pdr_est.experiment.walks import Walk, find_walks
from pdr_est.preprocessing.turned_device import rotation_named, turn_devices
from pdr_est.types.recording import Recording


def run_benchmark(
    suite: str,
    data: Path,
    comparison: Comparison,
    jobs: int = 1,
    limit: int | None = None,
    on_progress: Callable[[int, int], None] | None = None,
    turn_device: str | None = None,
) -> BenchmarkResult:
    """Score the walks of a suite with each variant of a comparison.

    The result does not depend on the number of processes.

    Parameters
    ----------
    suite : str
        Name of the suite.
    data : Path
        Folder that contains the folder of the suite, or that folder itself.
    comparison : Comparison
        Variants to run, from `variants.axes`.
    jobs : int
        Number of processes.
    limit : int, optional
        Number of walks, taken from the first one on.
    on_progress : Callable, optional
        Called with the number of finished walks and of all walks.
    turn_device : str, optional
        Turn of the device axes of every recording before any stage sees it, a name of `turned_device.rotation_named`.

    Raises
    ------
    ConfigError
        For an unknown suite or turn, a number out of range or settings that cannot be used.
    RecordingError
        If the folder contains no walk.
    EstimationError
        If a process dies. What goes wrong with a single walk is in the `failures` of the result.
    """
    chosen = suite_named(suite)
    if turn_device is not None:
        chosen = replace(chosen, prepare=TurnedPrepare(chosen.prepare, rotation_named(turn_device)))
    if jobs < 1 or (limit is not None and limit < 1):
        raise ConfigError(f"jobs = {jobs}, limit = {limit}: each must be at least 1")
    walks = find_walks(DataParams(suite=suite, limit=limit), data, chosen)
    if not walks:
        content = folder_content(chosen.folder)
        raise RecordingError(f"{data}: no walk of the suite {suite}: give the folder that holds {content}")
    protocol = HeldOutProtocol(FixesParams(protocol=chosen.fixes or "none"))
    job = scoring_job(chosen, protocol, comparison.variants, stop_on_fault=True)
    finished: dict[str, WalkResult] = {}
    for done in run_in_processes(job, walks, min(jobs, len(walks))):
        if not done.final:
            raise EstimationError(f"{done.walk.name}: {done.result.failures[0].reason}")
        finished[done.walk.name] = done.result
        if on_progress is not None:
            on_progress(len(finished), len(walks))
    result = _collected(chosen, comparison, walks, [finished[walk.name] for walk in walks])
    return replace(result, turn_device=turn_device)


@dataclass(frozen=True)
class TurnedPrepare:
    """The `prepare` of a suite, then a turn of the device axes; it can be sent to other processes.

    Attributes
    ----------
    prepare : Callable
        Change that the suite itself makes.
    rotation : Rotation
        Rotation from the old axes to the new ones.
    """

    prepare: Callable[[Recording], Recording]
    rotation: Rotation

    def __call__(self, recording: Recording) -> Recording:
        """Return the changed recording."""
        return turn_devices(self.prepare(recording), self.rotation)


def _collected(
    suite: Suite, comparison: Comparison, walks: Sequence[Walk], results: Sequence[WalkResult]
) -> BenchmarkResult:
    """Join the results of all walks, and add the metrics that need the other walks."""
    scored = [row for result in results for row in result.tracks]
    cases = [case for result in results for case in result.calibration_cases]
    if suite.profile_group is not None:
        rows, uncalibrated = with_profiles(scored, cases, suite.profile_group)
    else:
        rows, uncalibrated = with_calibrated(scored, cases, suite.calibrated_on, suite.calibrated)
    failures = [Failure(one.walk, _without_name(one)) for result in results for one in result.failures]
    failures += [Failure(walk, reason) for walk, reason in uncalibrated.items()]
    return BenchmarkResult(
        suite=suite,
        comparison=comparison,
        files={walk.name: walk.source for walk in walks if isinstance(walk.source, WalkFile)},
        rows=rows,
        failures=tuple(failures),
        seconds={(one.walk, variant): seconds for one in results for variant, seconds in one.seconds.items()},
    )


def _without_name(failure: Failure) -> str:
    """Return the reason without the name of the walk or its recording, which stands before it anyway."""
    reason = failure.reason
    for name in (failure.walk, failure.walk.rpartition("/")[2]):
        reason = reason.removeprefix(f"{name}: ")
    return reason
