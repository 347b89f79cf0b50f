"""The options `--profile`, `--learn` and `--distance` of `pdr-est smooth`."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import click

from pdr_est.calibration.learning import device_digests, learnt_walk, recording_digest, walk_record
from pdr_est.calibration.profile import LearntWalk, Profile, new_profile
from pdr_est.calibration.profile_file import load_profile, profile_to_yaml
from pdr_est.calibration.scale_by_fixes import without_personal_constants
from pdr_est.calibration.step_length_fit import NotLearnt
from pdr_est.config import Config
from pdr_est.output.atomic_output import staged_file
from pdr_est.output.file_lock import locked
from pdr_est.pipeline import DeviceWalk, analyse_recording
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording

Save = Callable[[LearntWalk | NotLearnt | None], list[str]]
"""Puts what a walk tells into the profile, and returns lines that say so."""


@dataclass(frozen=True)
class WalkersProfile:
    """Profile of the walker in a run of `smooth`.

    Attributes
    ----------
    profile : Profile or None
        What is known of the walker before; None without a profile, and without a file of one that is to learn.
    path : Path or None
        File of the profile.
    learns : bool
        True if the profile learns the walk.
    distance_m : float or None
        True length of the way, m, to learn from.
    """

    profile: Profile | None = None
    path: Path | None = None
    learns: bool = False
    distance_m: float | None = None

    @classmethod
    def of_options(cls, path: Path | None, learn: bool, distance_m: float | None) -> "WalkersProfile":
        """Load the profile that the options name.

        Raises UsageError for options that need another one, and ConfigError for a file that is no profile.
        """
        if learn and path is None:
            raise click.UsageError("--learn needs --profile FILE.yaml, the profile that learns this walk")
        if distance_m is not None and not learn:
            raise click.UsageError("--distance is for --learn: give both, or leave the distance out")
        if path is None or (learn and not path.exists()):
            return cls(None, path, learn, distance_m)
        return cls(load_profile(path), path, learn, distance_m)

    def require_outside(self, output: Path) -> None:
        """Check that a profile that learns is not in the folder of the results, which is replaced as a whole.

        Raises UsageError if it is.
        """
        if self.learns and self.path is not None and output.resolve() in self.path.resolve().parents:
            raise click.UsageError(
                f"--profile {self.path} lies in {output}, the folder of the results, which is replaced as a whole: "
                "keep the profile elsewhere"
            )

    def prior_of(self, recording: Recording, fixes: Sequence[PositionFix]) -> Profile | None:
        """Return what is known of the walker before the walk.

        A walk that was learnt from its fixes is left out where fixes are given again, as they must not count twice.
        One that is being learnt is always left out, so that the result is the same each time.
        """
        if self.profile is None:
            return None
        checksums = {recording_digest(recording), *device_digests(recording)}
        own = self.profile.known(checksums)
        twice = self.learns or (bool(fixes) and any(walk.distance_m is None for walk in own))
        return self.profile.without(checksums) if own and twice else self.profile

    def learnt_from(
        self,
        whole: Recording,
        recording: Recording,
        devices: Sequence[DeviceWalk],
        config: Config,
        fixes: Sequence[PositionFix],
    ) -> LearntWalk | NotLearnt | None:
        """Find what the walk tells a profile that learns, or why it tells nothing; None if no profile learns.

        Parameters
        ----------
        whole
            The whole recording, by which the walk is recognised: two parts of it do not count as two walks.
        recording, fixes
            The part of it that is the walk.
        devices
            Result of the front end with `config`. It is used unless the profile had an influence on it.
        config
            Settings of the walk, with the constants of the profile.
        """
        if not self.learns:
            return None
        plain = without_personal_constants(config)
        if plain.walker != config.walker and (fixes or self.distance_m is not None):
            devices = analyse_recording(recording, plain)
        learnt = learnt_walk(recording, devices, plain, fixes, self.distance_m)
        if whole is recording or isinstance(learnt, NotLearnt):
            return learnt
        return walk_record(whole, learnt.observation, self.distance_m)

    @contextmanager
    def saved(self, config: Config, inputs: Sequence[Path]) -> Iterator[Save]:
        """Provide a function that puts what a walk tells into the file of the profile, at the end of the block.

        Parameters
        ----------
        config : Config
            Settings of the walk, for a new profile.
        inputs : sequence of Path
            Files and folders that are read and never overwritten.
        """
        if not self.learns or self.path is None:
            yield lambda _walk: []
            return
        path = self.path
        with ExitStack() as lock, staged_file(path, overwrite=True, inputs=inputs) as file:

            def save(walk: LearntWalk | NotLearnt | None) -> list[str]:
                # Another run may have learnt in the meantime, and none may until this one has written.
                lock.enter_context(locked(path))
                before = load_profile(path) if path.exists() else new_profile(config)
                after = before.with_walk(walk) if isinstance(walk, LearntWalk) else before
                file.write_text(profile_to_yaml(after), encoding="utf-8")
                return [_learnt_words(walk, before), f"{describe_profile(after)} -> {path}"]

            yield save


NO_PROFILE = WalkersProfile()


def describe_profile(profile: Profile) -> str:
    """Describe a profile in one line."""
    percent = f"the next walk's length is known to {100.0 * profile.sigma_length_scale:.1f} %"
    if not profile.walks:
        return f"no walk learnt: {percent}"
    walker, number = profile.walker, len(profile.walks)
    words = f"length scale {walker.length_scale:.3f} from {number} walk{'s' if number > 1 else ''}"
    words += f" at {walker.reference_cadence_hz:.2f} steps/s, cadence exponent {walker.cadence_exponent:+.2f}"
    return f"{words}; {percent}"


def _learnt_words(walk: LearntWalk | NotLearnt | None, before: Profile) -> str:
    if not isinstance(walk, LearntWalk):
        return f"nothing learnt: {'' if walk is None else walk.reason}"
    again = " (known already, in place of the earlier time)" if before.known(walk.checksums) else ""
    return f"learnt from this walk: length scale {math.exp(walk.log_ratio):.3f} ± {100.0 * walk.sigma:.1f} %{again}"
