"""A walker's profile: the personal constants that a calibration found, as a small YAML file."""

from collections.abc import Mapping
from dataclasses import asdict, fields, replace
from datetime import date as Date
from pathlib import Path
from typing import Annotated, Any

import yaml
from annotated_types import Ge
from pydantic import TypeAdapter, ValidationError

from pdr_est.config import Config, config_from_dict, config_to_dict
from pdr_est.config.yaml_lines import load_yaml
from pdr_est.errors import ConfigError
from pdr_est.front_end.step_length import StepLengthParams, WalkerParams
from pdr_est.front_end.steps import DETECTORS
from pdr_est.params import Positive, params
from pdr_est.parts import PartName

_HEADER = "# A walker's own step length, made by `pdr-est calibrate`. To use it: pdr-est smooth --profile FILE\n"
_SECTIONS = ("profile", "walker", "odometry")


@params
class ProfileNote:
    """Origin of a profile."""

    step_length: StepLengthParams
    """Step-length model whose lengths the constants correct."""

    detector: Annotated[str, PartName(DETECTORS)]
    """Step detector whose steps the constants correct."""

    recordings: Annotated[int, Ge(1)]
    """Number of walks of the calibration."""

    date: Date
    """Date of the calibration."""

    distances_m: tuple[Positive, ...] = ()
    """True lengths of the walks, m; empty when the scale comes from fixes."""


@params
class Profile:
    """Personal constants of a walker."""

    note: ProfileNote
    """Origin of the constants."""

    walker: WalkerParams
    """Height, gender and personal constants."""

    sigma_length_scale: Positive
    """Standard deviation of the length scale that remains for the next walk, over the scale."""


_NOTE = TypeAdapter(ProfileNote)


def profile_to_yaml(profile: Profile) -> str:
    """Write a profile as YAML text, which `load_profile` reads back to the same record.

    It is a fragment of a configuration with the sections `walker` and `odometry`, and its origin under `profile`.
    """
    note = asdict(profile.note)
    document = {
        "profile": note | {"distances_m": list(note["distances_m"])},
        **_settings(profile),
    }
    return _HEADER + str(yaml.safe_dump(document, sort_keys=False))


def load_profile(path: str | Path) -> Profile:
    """Read a profile from its file.

    Raises
    ------
    ConfigError
        If the file is no valid profile; the message names the file and the key.
    """
    data = load_yaml(path)
    if not isinstance(data, Mapping) or set(data) != set(_SECTIONS):
        raise ConfigError(
            f"{path}: is no profile: it must hold {', '.join(_SECTIONS)} and nothing else; make one with "
            "`pdr-est calibrate`"
        )
    settings = config_from_dict({"walker": data["walker"], "odometry": data["odometry"]}, str(path))
    foreign = set(data["odometry"]) - {"sigma_length_scale"}
    if foreign or "sigma_length_scale" not in data["odometry"]:
        raise ConfigError(f"{path}: odometry must hold sigma_length_scale and nothing else: set the rest by --config")
    if settings.odometry.sigma_length_scale == 0.0:
        raise ConfigError(f"{path}: odometry.sigma_length_scale = 0: no scale is known so well; calibrate again")
    return Profile(
        note=_note(data["profile"], path),
        walker=settings.walker,
        sigma_length_scale=settings.odometry.sigma_length_scale,
    )


def apply_profile(config: Config, profile: Profile) -> Config:
    """Return the configuration for this walker."""
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
    settings = config_to_dict(config)
    made_for = {"step_length": asdict(profile.note.step_length), "steps": {"detector": profile.note.detector}}
    for section, expected in {**made_for, **_settings(profile)}.items():
        for key, value in expected.items():
            if settings[section][key] != value:
                raise ConfigError(
                    f"{place}: made for {section}.{key} = {value}, but {settings[section][key]} is set: set it like "
                    "that or leave it out, or calibrate again"
                )


def _settings(profile: Profile) -> dict[str, dict[str, Any]]:
    """Return the settings of a profile as a fragment of a configuration."""
    return {"walker": asdict(profile.walker), "odometry": {"sigma_length_scale": profile.sigma_length_scale}}


def _note(data: Any, path: str | Path) -> ProfileNote:
    try:
        note: ProfileNote = _NOTE.validate_python(data)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in ("profile", *first["loc"]))
        raise ConfigError(f"{path}: {key}: {first['msg']}: correct it, or calibrate again") from error
    # What "auto" means may have changed since: a profile is only of use with the constants that it was made for.
    missing = sorted(field.name for field in fields(StepLengthParams) if field.name not in data["step_length"])
    if missing:
        raise ConfigError(
            f"{path}: profile.step_length: without {', '.join(missing)}: made by another version, whose step lengths "
            "differ: calibrate again"
        )
    return note
