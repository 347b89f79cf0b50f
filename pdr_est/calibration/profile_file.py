"""The file of a profile: YAML that a person can read, correct and keep."""

import math
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import yaml
from pydantic import TypeAdapter, ValidationError

from pdr_est.calibration.profile import LearntWalk, Profile, ProfileNote
from pdr_est.errors import ConfigError
from pdr_est.front_end.step_length import StepLengthParams
from pdr_est.output.atomic_output import staged_file
from pdr_est.params.yaml_lines import load_yaml

FORMAT = 2
"""Version of the file format; 1 held the constants without the walks that they followed from."""

_HEADER = (
    "# A walker's own step length, made by `pdr-est calibrate` or `pdr-est smooth --learn`.\n"
    "# To use it: pdr-est smooth --profile FILE. The section `learnt` follows from the walks: empty it\n"
    "# after a change of the walks, such as the removal of one.\n"
)
_SECTIONS = {"format", "learnt", "profile", "walks"}
_AGREEMENT = 1e-6  # of a number that is written and computed again


def profile_to_yaml(profile: Profile) -> str:
    """Write a profile as YAML text, which `load_profile` reads back to the same record."""
    return _HEADER + str(yaml.safe_dump({"format": FORMAT, **profile.to_dict()}, sort_keys=False))


def save_profile(profile: Profile, path: str | Path) -> None:
    """Write a profile to its file, which appears or changes completely or not at all.

    Raises
    ------
    OutputError
        If it cannot be written there.
    """
    with staged_file(Path(path), overwrite=True) as file:
        file.write_text(profile_to_yaml(profile), encoding="utf-8")


def load_profile(path: str | Path) -> Profile:
    """Read a profile from its file.

    Raises
    ------
    ConfigError
        If the file is no valid profile; the message names the file and the key.
    """
    data = load_yaml(path)
    if not isinstance(data, Mapping) or not {"profile"} <= set(data):
        raise ConfigError(
            f"{path}: is no profile: it must hold {', '.join(sorted(_SECTIONS))}; make one with `pdr-est calibrate` "
            "or `pdr-est smooth --learn`"
        )
    _check_format(data, path)
    unknown = sorted(str(key) for key in set(data) ^ _SECTIONS)
    if unknown:
        raise ConfigError(
            f"{path}: {unknown[0]}: a profile must hold {', '.join(sorted(_SECTIONS))} and "
            "nothing else: correct it, or calibrate again"
        )
    note = _validated(TypeAdapter(ProfileNote), data["profile"], "profile", path)
    # A constant that an earlier version did not have would silently get the default of this one.
    written = data["profile"]["step_length"]
    missing = sorted(field.name for field in fields(StepLengthParams) if field.name not in written)
    if missing:
        raise ConfigError(
            f"{path}: profile.step_length: without {', '.join(missing)}: made by another version, whose step lengths "
            "may differ: calibrate again"
        )
    walks = _validated(TypeAdapter(tuple[LearntWalk, ...]), data["walks"], "walks", path)
    try:
        profile = Profile(note=note, walks=tuple(sorted(walks, key=lambda walk: walk.sha256)))
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from error
    try:
        _ = profile.walker
    except ConfigError as error:
        raise ConfigError(
            f"{path}: walks: together they give constants that nobody has ({error}): remove the walks that are "
            "wrong, and leave the section learnt empty"
        ) from error
    _check_learnt(data["learnt"], profile, path)
    return profile


def _check_format(data: Mapping[Any, Any], path: str | Path) -> None:
    version = data.get("format")
    if version == FORMAT and not isinstance(version, bool):
        return
    if version is None:
        words = "has the format of an earlier version, without its walks: calibrate again"
    elif isinstance(version, int) and version > FORMAT:
        words = f"format = {version} is newer than {FORMAT}, which this version reads: use a newer pdr-est"
    else:
        words = f"format = {version!r} is unknown: this version reads {FORMAT}; calibrate again"
    raise ConfigError(f"{path}: {words}")


def _validated(adapter: TypeAdapter[Any], data: Any, section: str, path: str | Path) -> Any:
    try:
        return adapter.validate_python(data)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in (section, *first["loc"]))
        raise ConfigError(f"{path}: {key}: {first['msg']}: correct it, or calibrate again") from error


def _check_learnt(written: Any, profile: Profile, path: str | Path) -> None:
    """Check that the numbers written for the reader follow from the walks, which a damaged file contradicts."""
    computed = profile.to_dict()["learnt"]
    if written is None:
        return
    if not isinstance(written, Mapping) or set(written) != set(computed):
        raise ConfigError(
            f"{path}: learnt: must hold {', '.join(computed)}: leave the section empty to have it computed"
        )
    for key, value in computed.items():
        found = written[key]
        number = isinstance(found, int | float) and not isinstance(found, bool)
        if not number or not math.isclose(found, value, rel_tol=_AGREEMENT, abs_tol=_AGREEMENT):
            raise ConfigError(
                f"{path}: learnt.{key} = {found} does not follow from the walks, which give {value:g}: the file was "
                "changed or is not complete; remove walks that are wrong, and leave the section learnt empty"
            )
