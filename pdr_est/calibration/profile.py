"""A walker's profile: what walks have shown of the walker's own step length, and the constants that follow from it.

A profile keeps the observation of each walk, and computes the posterior from all of them
(`step_length_fit.fit_calibration`). It therefore does not depend on the order in which walks are learnt, a walk that
is learnt again replaces itself, and a walk can be left out again.
"""

from collections.abc import Collection
from dataclasses import asdict, replace
from datetime import UTC, datetime
from datetime import date as Date
from functools import cached_property
from typing import Annotated, Any

from annotated_types import Ge, Le
from pydantic import StringConstraints

from pdr_est.calibration.step_length_fit import Calibration, ScaleObservation, fit_calibration
from pdr_est.config import Config, config_to_dict
from pdr_est.errors import ConfigError, RecordingError
from pdr_est.front_end.step_length import Gender, StepLengthParams, WalkerParams, length_law
from pdr_est.front_end.step_length.walker import Height
from pdr_est.front_end.steps import DETECTORS
from pdr_est.params import NonNegative, Positive, params
from pdr_est.params.validation_messages import contradiction
from pdr_est.parts import PartName

Digest = Annotated[str, StringConstraints(pattern="^[0-9a-f]{64}$")]


@params
class LearntWalk:
    """Observation of the length of a walker's steps on one walk."""

    sha256: Digest
    """Checksum of the samples (`learning.recording_digest`), by which the walk is recognised."""

    name: str = ""
    """Name of the recording."""

    log_ratio: Annotated[float, Ge(-10.0), Le(10.0)]
    """Natural logarithm of the true length over the model's."""

    sigma: NonNegative
    """Standard deviation of log_ratio; 0 for a known distance."""

    log_cadence: Annotated[float, Ge(-1.0), Le(2.0)]
    """Mean logarithm of the steps per second, weighted by step length."""

    distance_m: Positive | None = None
    """True length of the walk, m; None where fixes told the scale."""

    devices: tuple[Digest, ...] = ()
    """Checksums of the single devices, in order, of a walk of several; each is that of a recording of it alone."""

    @property
    def checksums(self) -> frozenset[str]:
        """Return the checksums by which this walk, or a part of its devices, is recognised."""
        return frozenset((self.sha256, *self.devices))

    @property
    def observation(self) -> ScaleObservation:
        """Return the observation for the fit."""
        return ScaleObservation(self.log_ratio, self.sigma, self.log_cadence)


@params
class ProfileNote:
    """Model, detector and body that a profile was made with."""

    step_length: StepLengthParams
    """Step-length model whose lengths the constants correct."""

    law: str
    """Law of step length that the model stood for (`length_law`)."""

    detector: Annotated[str, PartName(DETECTORS)]
    """Step detector whose steps the constants correct."""

    height_m: Height
    """Height of the walker, m."""

    gender: Gender
    """Gender of the walker."""

    date: Date
    """Date of the last change."""


@params
class Profile:
    """A walker's own step length, as learnt from walks; without walks, what is expected of people in general."""

    note: ProfileNote
    """Settings that it was made with."""

    walks: tuple[LearntWalk, ...] = ()
    """The walks, in order of their checksums."""

    def __post_init__(self) -> None:
        digests = [walk.sha256 for walk in self.walks]
        if digests != sorted(set(digests)):
            raise contradiction("walks: must be in order of sha256, each walk once: use with_walk to add one")

    @cached_property
    def posterior(self) -> Calibration | None:
        """Posterior of the walker's constants; None without walks."""
        return fit_calibration([walk.observation for walk in self.walks]) if self.walks else None

    @property
    def walker(self) -> WalkerParams:
        """Height, gender and personal constants of the walker."""
        body = WalkerParams(height_m=self.note.height_m, gender=self.note.gender)
        return body if self.posterior is None else self.posterior.walker(body)

    @property
    def sigma_length_scale(self) -> float:
        """Standard deviation of the length scale that remains for the next walk, over the scale."""
        return Config().odometry.sigma_length_scale if self.posterior is None else self.posterior.sigma_next

    def known(self, checksums: Collection[str]) -> tuple[LearntWalk, ...]:
        """Return the walks learnt that share a checksum with these: the same walk by some or all of its devices."""
        return tuple(walk for walk in self.walks if not walk.checksums.isdisjoint(checksums))

    def with_walk(self, walk: LearntWalk) -> "Profile":
        """Return the profile with a walk more, or with a new observation of one that it knows.

        Raises
        ------
        RecordingError
            If no walker can have the constants that would follow.
        """
        if walk in self.walks:
            return self
        others = self.without(walk.checksums).walks
        walks = tuple(sorted((*others, walk), key=lambda one: one.sha256))
        learnt = replace(self, walks=walks, note=replace(self.note, date=datetime.now(UTC).date()))
        try:
            _ = learnt.walker
        except ConfigError as error:
            raise RecordingError(
                f"{walk.name}: with this walk the profile would get constants that nobody has ({error}): correct its "
                "fixes or its distance, or leave it out"
            ) from error
        return learnt

    def without(self, checksums: Collection[str]) -> "Profile":
        """Return the profile without a walk, as the prior of that walk itself: its fixes must not count twice."""
        known = self.known(checksums)
        return replace(self, walks=tuple(walk for walk in self.walks if walk not in known))

    def to_dict(self) -> dict[str, Any]:
        """Return what the profile holds and what follows from it, as numbers and texts by name."""
        learnt: dict[str, Any] = {"walks": len(self.walks), "sigma_next_walk": self.sigma_length_scale}
        if self.posterior is not None:
            learnt |= {
                "log_scale": float(self.posterior.mean[0]),
                "sigma_log_scale": float(self.posterior.covariance[0, 0] ** 0.5),
                "length_scale": self.walker.length_scale,
                "cadence_exponent": self.walker.cadence_exponent,
                "reference_cadence_hz": self.walker.reference_cadence_hz,
            }
        walks = [
            {key: value for key, value in asdict(walk).items() if value is not None and value != ()}
            for walk in self.walks
        ]
        return {"profile": asdict(self.note), "walks": walks, "learnt": learnt}


def new_profile(config: Config) -> Profile:
    """Make the profile of a walker of whom nothing is known but what the configuration says of body and model."""
    note = ProfileNote(
        step_length=config.step_length,
        law=length_law(config.step_length),
        detector=config.steps.detector,
        height_m=config.walker.height_m,
        gender=config.walker.gender,
        date=datetime.now(UTC).date(),
    )
    return Profile(note=note)


def apply_profile(config: Config, profile: Profile) -> Config:
    """Return the configuration for this walker: the constants, and how uncertain the scale of a next walk is."""
    odometry = replace(config.odometry, sigma_length_scale=profile.sigma_length_scale)
    return replace(config, walker=profile.walker, odometry=odometry)


def check_profile_matches(config: Config, profile: Profile, place: str) -> None:
    """Check that a configuration is the one that a profile was made for, and the one it makes.

    The constants of a profile correct the steps of one detector and the lengths of one model with its constants, for
    one height and gender.

    Parameters
    ----------
    config : Config
        Configuration to check.
    profile : Profile
        Profile of the walker.
    place : str
        Name of the profile in messages.

    Raises
    ------
    ConfigError
        If a setting differs.
    """
    check_model_matches(config, profile, place)
    expected = {"walker": asdict(profile.walker), "odometry": {"sigma_length_scale": profile.sigma_length_scale}}
    _compare(config_to_dict(config), expected, place)


def check_model_matches(config: Config, profile: Profile, place: str) -> None:
    """Check model, detector and body only, of a configuration without the walker's constants.

    Raises
    ------
    ConfigError
        If a setting differs from that of the profile.
    """
    note, law = profile.note, length_law(config.step_length)
    if law != note.law:
        auto = f" (for {config.step_length.model})" if law != config.step_length.model else ""
        raise ConfigError(
            f"{place}: made for step_length.model = {note.law}, but {law}{auto} is set: set it like that, or learn "
            "the walks again"
        )
    model = asdict(note.step_length) | {"model": config.step_length.model}  # two names of one law
    body = {"height_m": note.height_m, "gender": note.gender}
    expected = {"step_length": model, "steps": {"detector": note.detector}, "walker": body}
    _compare(config_to_dict(config), expected, place)


def _compare(settings: dict[str, Any], expected: dict[str, dict[str, Any]], place: str) -> None:
    for section, values in expected.items():
        for key, value in values.items():
            if settings[section][key] != value:
                raise ConfigError(
                    f"{place}: made for {section}.{key} = {value}, but {settings[section][key]} is set: set it like "
                    "that or leave it out, or calibrate again"
                )
