"""The file of a profile: there and back, and what is refused, in one line that names the place."""

from dataclasses import replace
from pathlib import Path

import pytest
from profile_notes import NOTE

from pdr_est.calibration.profile import LearntWalk, Profile
from pdr_est.calibration.profile_file import load_profile, profile_to_yaml, save_profile
from pdr_est.errors import ConfigError, OutputError

WALK = LearntWalk(sha256="a" * 64, name="w1", log_ratio=0.0791, sigma=0.0, log_cadence=0.47, distance_m=31.91)
PROFILE = Profile(
    note=NOTE,
    walks=(WALK, LearntWalk(sha256="b" * 64, name="w2", log_ratio=0.05, sigma=0.02, log_cadence=0.6)),
)


def saved(folder: Path, text: str) -> Path:
    path = folder / "profile.yaml"
    path.write_text(text, encoding="utf-8")
    return path


PAIR = replace(WALK, devices=("1" * 64, "2" * 64))


@pytest.mark.parametrize("profile", [PROFILE, replace(PROFILE, walks=()), replace(PROFILE, walks=(PAIR,))])
def test_there_and_back(profile: Profile, tmp_path: Path) -> None:
    assert profile_to_yaml(profile).startswith("# A walker's own step length")
    save_profile(profile, tmp_path / "p.yaml")
    assert load_profile(tmp_path / "p.yaml") == profile
    save_profile(PROFILE, tmp_path / "p.yaml")
    assert load_profile(tmp_path / "p.yaml") == PROFILE
    assert [path.name for path in tmp_path.iterdir()] == ["p.yaml"]


def test_what_follows_from_the_walks_may_be_empty(tmp_path: Path) -> None:
    text = profile_to_yaml(PROFILE)
    assert load_profile(saved(tmp_path, text[: text.index("\nlearnt:")] + "\nlearnt:\n")) == PROFILE


def test_a_place_that_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="cannot be written"):
        save_profile(PROFILE, tmp_path / "missing" / "p.yaml")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("profile:", "runner:", "is no profile: it must hold format, learnt, profile, walks"),
        ("format: 2\n", "", "format of an earlier version, without its walks: calibrate again"),
        ("format: 2", "format: 3", "format = 3 is newer than 2, which this version reads: use a newer pdr-est"),
        ("format: 2", "format: two", "format = 'two' is unknown: this version reads 2"),
        ("format: 2", "format: 2\nother: 1", "other: a profile must hold"),
        ("walks:\n", "wolks:\n", "walks: a profile must hold|wolks: a profile must hold"),
        ("model: weinberg", "model: telepathy", "profile.step_length.model: Input should be 'auto'"),
        ("    kim_k:", "    # kim_k:", "profile.step_length: without kim_k: made by another version"),
        ("date: 2024-02-29", "date: yesterday", "profile.date: "),
        ("height_m: 1.6", "height_m: 160", "profile.height_m: Input should be less than or equal to 2.6"),
        ("distance_m: 31.91", "distance_m: -1.0", "walks.0.distance_m: Input should be greater than 0"),
        ("log_ratio: 0.0791", "log_ratio: .nan", "walks.0.log_ratio: "),
        ("log_ratio: 0.0791", "log_ratio: 0.2", r"learnt.log_scale = .* does not follow from the walks"),
        ("sigma: 0.02", "sigma: -0.02", "walks.1.sigma: Input should be greater than or equal to 0"),
        ("sigma: 0.02", "sigm: 0.02", "walks.1.sigm"),
        ("a" * 64, "b" * 64, "walks: must be in order of sha256, each walk once"),
        ("a" * 64, "a" * 63, "walks.0.sha256: String should match"),
        ("  walks: 2", "  walks: 3", "learnt.walks = 3 does not follow from the walks, which give 2"),
        ("  walks: 2", "  walked: 2", "learnt: must hold walks, "),
        ("profile:", "profile: [", "is not valid YAML"),
    ],
)
def test_a_damaged_file_is_refused_in_one_line(old: str, new: str, message: str, tmp_path: Path) -> None:
    text = profile_to_yaml(PROFILE)
    assert old in text
    path = saved(tmp_path, text.replace(old, new, 1))
    with pytest.raises(ConfigError, match=message) as caught:
        load_profile(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_walks_that_nobody_walks_are_refused_with_the_name_of_the_file(tmp_path: Path) -> None:
    text = profile_to_yaml(PROFILE)
    text = text[: text.index("\nlearnt:")].replace("log_ratio: 0.0791", "log_ratio: 9.0") + "\nlearnt:\n"
    path = saved(tmp_path, text)
    with pytest.raises(ConfigError, match=r"length_scale = .*: remove the walks that are wrong, and leave") as caught:
        load_profile(path)
    assert str(caught.value).startswith(str(path))


@pytest.mark.parametrize("cut", [0.2, 0.5, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 0.99])
def test_a_file_cut_short_is_refused(cut: float, tmp_path: Path) -> None:
    text = profile_to_yaml(PROFILE)
    path = saved(tmp_path, text[: int(cut * len(text))])
    with pytest.raises(ConfigError) as caught:
        load_profile(path)
    assert str(caught.value).startswith(str(path))


@pytest.mark.parametrize("text", ["", "[]", "walker: {height_m: 1.7}"])
def test_other_files_are_no_profiles(text: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="is no profile"):
        load_profile(saved(tmp_path, text))
    with pytest.raises(ConfigError, match="cannot be read"):
        load_profile(tmp_path / "missing.yaml")
