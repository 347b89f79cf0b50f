"""A walker's profile: there and back, what a file must hold, and which configurations it fits."""

from dataclasses import replace
from datetime import date
from pathlib import Path

import pytest

from pdr_est.calibration.profile import (
    Profile,
    ProfileNote,
    apply_profile,
    check_profile_matches,
    load_profile,
    profile_to_yaml,
)
from pdr_est.config import Config, config_to_dict
from pdr_est.errors import ConfigError
from pdr_est.front_end.step_length import StepLengthParams, WalkerParams
from pdr_est.front_end.steps import StepsParams

PROFILE = Profile(
    note=ProfileNote(
        step_length=StepLengthParams(model="weinberg", weinberg_k2=0.5),
        detector="local-variance",
        recordings=2,
        date=date(2024, 2, 29),
        distances_m=(31.91, 100.0),
    ),
    walker=WalkerParams(
        height_m=1.6, gender="female", length_scale=1.0791, cadence_exponent=-0.05, reference_cadence_hz=1.47
    ),
    sigma_length_scale=0.0636,
)
CONFIG = Config(step_length=PROFILE.note.step_length, steps=StepsParams(detector="local-variance"))


def saved(folder: Path, text: str) -> Path:
    path = folder / "profile.yaml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("profile", [PROFILE, replace(PROFILE, note=replace(PROFILE.note, distances_m=()))])
def test_there_and_back(profile: Profile, tmp_path: Path) -> None:
    text = profile_to_yaml(profile)
    assert text.startswith("# A walker's own step length")
    assert load_profile(saved(tmp_path, text)) == profile


def test_it_sets_the_walker_and_the_uncertainty_and_nothing_else() -> None:
    config = apply_profile(CONFIG, PROFILE)
    assert config.walker == PROFILE.walker
    assert config.odometry.sigma_length_scale == 0.0636
    back = replace(
        config,
        walker=CONFIG.walker,
        odometry=replace(config.odometry, sigma_length_scale=CONFIG.odometry.sigma_length_scale),
    )
    assert config_to_dict(back) == config_to_dict(CONFIG)


@pytest.mark.parametrize(
    ("section", "key", "value", "message"),
    [
        ("step_length", "model", "static", "made for step_length.model = weinberg, but static is set"),
        ("step_length", "weinberg_k2", 0.48, "made for step_length.weinberg_k2 = 0.5, but 0.48 is set"),
        ("steps", "detector", "auto", "made for steps.detector = local-variance, but auto is set"),
        ("walker", "height_m", 1.9, "made for walker.height_m = 1.6, but 1.9 is set"),
        ("walker", "length_scale", 1.0, "made for walker.length_scale = 1.0791, but 1.0 is set"),
        ("odometry", "sigma_length_scale", 0.11, "made for odometry.sigma_length_scale = 0.0636, but 0.11 is set"),
    ],
)
def test_a_configuration_must_be_the_one_of_the_calibration(section, key, value, message) -> None:
    config = apply_profile(CONFIG, PROFILE)
    check_profile_matches(config, PROFILE, "p.yaml")
    other = replace(config, **{section: replace(getattr(config, section), **{key: value})})
    with pytest.raises(ConfigError, match=rf"p\.yaml: {message}: set it like that"):
        check_profile_matches(other, PROFILE, "p.yaml")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("walker:", "runner:", "is no profile: it must hold profile, walker, odometry"),
        ("model: weinberg", "model: telepathy", "profile.step_length.model: Input should be 'auto'"),
        ("recordings: 2", "recordings: 0", "profile.recordings: Input should be greater than or equal to 1"),
        ("date: 2024-02-29", "date: yesterday", "profile.date: "),
        ("- 31.91", "- -1.0", "profile.distances_m.0: Input should be greater than 0"),
        ("height_m: 1.6", "height_m: 160", "walker.height_m = 160: .* the unit is metres"),
        ("length_scale: 1.0791", "length_scal: 1.0791", "unknown key 'walker.length_scal': did you mean"),
        ("sigma_length_scale: 0.0636", "sigma_length_scale: 0.0", "sigma_length_scale = 0: .* calibrate again"),
        ("sigma_length_scale: 0.0636", "sigma_heading_rad_per_sqrt_s: 0.1", "odometry must hold sigma_length_scale"),
        ("odometry:\n  sigma_length_scale: 0.0636", "odometry: 0.1", "odometry"),
        ("profile:", "profile: [", "is not valid YAML"),
    ],
)
def test_a_damaged_file_is_refused_in_one_line(old: str, new: str, message: str, tmp_path: Path) -> None:
    text = profile_to_yaml(PROFILE)
    assert old in text
    path = saved(tmp_path, text.replace(old, new))
    with pytest.raises(ConfigError, match=message) as caught:
        load_profile(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["", "[]", "walker: {height_m: 1.7}"])
def test_other_files_are_no_profiles(text: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="is no profile"):
        load_profile(saved(tmp_path, text))
    with pytest.raises(ConfigError, match="cannot be read"):
        load_profile(tmp_path / "missing.yaml")


def test_a_profile_of_a_version_with_other_lengths_is_refused(tmp_path: Path) -> None:
    """`auto` meant another model when the constants of `harmonic` were not yet there."""
    lines = profile_to_yaml(PROFILE).splitlines()
    first = next(number for number, line in enumerate(lines) if line == "    harmonic:")
    last = next(number for number, line in enumerate(lines) if number > first and not line.startswith("      "))
    path = saved(tmp_path, "\n".join(lines[:first] + lines[last:]))
    with pytest.raises(ConfigError, match=r"profile\.step_length: without harmonic: .*calibrate again"):
        load_profile(path)
