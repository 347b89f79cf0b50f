"""`pdr-est smooth --learn`: a profile grows with the walks, and each of them counts once."""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from cli_recordings import Walk, save
from cli_runs import refused, run, smoothed

from pdr_est.calibration.profile import Profile
from pdr_est.calibration.profile_file import load_profile
from pdr_est.calibration.step_length_fit import SIGMA_LOG_SCALE
from pdr_est.errors import RecordingError

pytestmark = pytest.mark.usefixtures("without_report")


@pytest.fixture(scope="module")
def fixes(walk: Walk, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Positions of somebody whose steps are a fifth longer."""
    at = np.linspace(0, len(walk.true_time_s) - 1, 5).astype(int)
    rows = [
        f"{walk.true_time_s[i] - walk.true_time_s[0]},{1.2 * walk.true_m[i, 0]},{walk.true_m[i, 1]},0.1" for i in at
    ]
    return save(tmp_path_factory.mktemp("fixes") / "fixes.csv", ["time_s,x_m,y_m,sigma_m", *rows])


def learnt(recording: Path, out: Path, profile: Path, *options: object) -> str:
    result = run("smooth", recording, "-o", out, "--profile", profile, "--learn", *options)
    assert result.exit_code == 0, result.output
    return result.stdout


def test_a_walk_with_fixes_makes_a_profile_that_serves_others(good: Path, fixes: Path, tmp_path: Path) -> None:
    profile = tmp_path / "me.yaml"
    said = learnt(good, tmp_path / "a", profile, "--fixes", fixes)
    assert "learnt from this walk: length scale 1." in said
    assert "from 1 walk at" in said
    known = load_profile(profile)
    assert 1.05 < known.walker.length_scale < 1.3
    assert known.sigma_length_scale < SIGMA_LOG_SCALE
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "me.yaml"]
    other = tmp_path / "other.csv"
    other.write_text("\n".join(good.read_text(encoding="utf-8").splitlines()[:-2]) + "\n", encoding="utf-8")
    smoothed(other, tmp_path / "b", "--profile", profile)
    summary = json.loads((tmp_path / "b" / "summary.json").read_text(encoding="utf-8"))
    assert summary["config"]["walker"]["length_scale"] == known.walker.length_scale
    assert summary["profile"]["learnt"]["walks"] == 1


def test_a_walk_counts_once_and_is_no_prior_of_itself(good: Path, fixes: Path, tmp_path: Path) -> None:
    profile = tmp_path / "me.yaml"
    learnt(good, tmp_path / "a", profile, "--fixes", fixes)
    once = profile.read_bytes()
    said = learnt(good, tmp_path / "b", profile, "--fixes", fixes)
    assert "known already" in said
    assert profile.read_bytes() == once
    tracks = [(tmp_path / name / "track.csv").read_bytes() for name in "ab"]
    assert tracks[0] == tracks[1]
    smoothed(good, tmp_path / "c", "--profile", profile, "--fixes", fixes)
    assert (tmp_path / "c" / "track.csv").read_bytes() == tracks[0]
    smoothed(good, tmp_path / "d", "--profile", profile)  # without its fixes, what they taught is news
    summary = json.loads((tmp_path / "d" / "summary.json").read_text(encoding="utf-8"))
    assert summary["profile"]["learnt"]["walks"] == 1


LEARNER = """
import sys
from pathlib import Path
from pdr_est.calibration.profile import LearntWalk
from pdr_est.cli.profile_options import WalkersProfile
from pdr_est.config import Config
path, first = Path(sys.argv[1]), int(sys.argv[2])
for number in range(first, first + 12):
    with WalkersProfile.of_options(path, True, None).saved(Config(), []) as save:
        save(LearntWalk(sha256=f"{number:064x}", log_ratio=0.1, sigma=0.03, log_cadence=0.6))
"""


@pytest.mark.slow
def test_no_walk_is_lost_when_several_processes_learn(tmp_path: Path) -> None:
    profile = tmp_path / "me.yaml"
    learners = [subprocess.Popen((sys.executable, "-c", LEARNER, str(profile), str(100 * i))) for i in range(3)]
    assert [learner.wait(timeout=120) for learner in learners] == [0, 0, 0]
    assert len(load_profile(profile).walks) == 36
    assert [path.name for path in tmp_path.iterdir()] == ["me.yaml"]


def test_the_front_end_runs_once_for_a_new_profile(good: Path, fixes: Path, tmp_path: Path, monkeypatch) -> None:
    def refuse(*_: object) -> None:
        raise AssertionError("the front end runs a second time")

    monkeypatch.setattr("pdr_est.cli.profile_options.analyse_recording", refuse)
    learnt(good, tmp_path / "a", tmp_path / "me.yaml", "--fixes", fixes)


@pytest.mark.slow
def test_fixes_that_disagree_are_told_and_not_learnt(walk: Walk, good: Path, tmp_path: Path) -> None:
    at = np.linspace(0, len(walk.true_time_s) - 1, 6).astype(int)
    rows = [
        f"{walk.true_time_s[i] - walk.true_time_s[0]},{walk.true_m[i, 0] + (9 if k % 2 else -9)},{k % 3 * 7},0.1"
        for k, i in enumerate(at)
    ]
    wrong = save(tmp_path / "wrong.csv", ["time_s,x_m,y_m,sigma_m", *rows])
    result = run(
        "smooth", good, "-o", tmp_path / "a", "--profile", tmp_path / "me.yaml", "--learn", "--fixes", wrong, "-q"
    )
    assert result.exit_code == 0
    assert "warning: nothing learnt: its fixes disagree with its steps or with each other" in result.stderr
    assert load_profile(tmp_path / "me.yaml").walks == ()


def test_a_distance_and_a_recording_that_is_mostly_missing_teach_nothing(lines, tmp_path: Path) -> None:
    header, *rows = lines
    torn = save(tmp_path / "torn.csv", [header, *rows[: len(rows) // 3], *rows[-len(rows) // 12 :]])
    options = ("--profile", tmp_path / "me.yaml", "--learn", "--distance", 12)
    result = run("smooth", torn, "-o", tmp_path / "a", *options)
    assert result.exit_code == 0
    assert "warning: nothing learnt: up to " in result.stderr
    assert load_profile(tmp_path / "me.yaml").walks == ()
    line = refused("calibrate", torn, "--distance", 12, "-o", tmp_path / "c.yaml")
    assert re.search(r"torn.csv: up to \d\d % of the way lie in its gaps, so that the distance of 12 m", line), line


def test_a_pair_and_one_phone_of_it_count_once(good: Path, tmp_path: Path) -> None:
    profile, other = tmp_path / "me.yaml", tmp_path / "other.csv"
    other.write_text("\n".join(good.read_text(encoding="utf-8").splitlines()[:-2]) + "\n", encoding="utf-8")
    learnt(good, tmp_path / "a", profile, "--distance", 13)
    said = run("smooth", good, other, "-o", tmp_path / "b", "--profile", profile, "--learn", "--distance", 13).stdout
    assert "known already" in said
    (walk,) = load_profile(profile).walks
    assert len(walk.devices) == 2
    assert "known already" in learnt(other, tmp_path / "c", profile, "--distance", 13)
    assert len(load_profile(profile).walks) == 1


def test_two_parts_of_a_recording_are_one_walk(good: Path, tmp_path: Path) -> None:
    profile = tmp_path / "me.yaml"
    learnt(good, tmp_path / "a", profile, "--distance", 6, "--to", 8)
    assert "known already" in learnt(good, tmp_path / "b", profile, "--distance", 6, "--from", 7)
    assert len(load_profile(profile).walks) == 1


def test_nothing_is_learnt_without_fixes(good: Path, fixes: Path, tmp_path: Path) -> None:
    profile = tmp_path / "me.yaml"
    assert "nothing learnt" in learnt(good, tmp_path / "a", profile, "--closed")
    assert load_profile(profile).walks == ()
    learnt(good, tmp_path / "b", profile, "--fixes", fixes)
    once = profile.read_bytes()
    assert "nothing learnt" in learnt(good, tmp_path / "c", profile)
    assert profile.read_bytes() == once


def test_a_known_length_is_learnt_as_calibrate_does(good: Path, tmp_path: Path) -> None:
    learnt(good, tmp_path / "a", tmp_path / "me.yaml", "--distance", 15)
    assert run("calibrate", good, "--distance", 15, "-o", tmp_path / "c.yaml").exit_code == 0
    assert load_profile(tmp_path / "me.yaml") == load_profile(tmp_path / "c.yaml")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--learn",), "--learn needs --profile FILE.yaml"),
        (("--distance", 12), "--distance is for --learn: give both"),
        (("--learn", "--profile", "new.yaml", "--distance", -1), "a distance of -1 m: give the length"),
        (("--learn", "--profile", "new.yaml", "--distance", 500), "a scale of .* that is not between 0.5 and 2"),
        (("--profile", "new.yaml"), "new.yaml: cannot be read"),
        (("--learn", "--profile", "out/me.yaml", "--distance", 12), "lies in .*, the folder of the results"),
    ],
    ids=str,
)
def test_what_is_refused_leaves_nothing(options, message, good: Path, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    line = refused("smooth", good, "-o", tmp_path / "out", *options)
    assert re.search(message, line), line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("text", ["profile: [", "format: 9\nprofile: {}\n", "walker: {height_m: 1.7}\n", ""])
def test_a_damaged_profile_stays_as_it_is(text: str, good: Path, fixes: Path, tmp_path: Path) -> None:
    profile = tmp_path / "me.yaml"
    profile.write_text(text, encoding="utf-8")
    for options in ((), ("--learn", "--fixes", fixes)):
        result = run("smooth", good, "-o", tmp_path / "out", "--profile", profile, *options)
        assert result.exit_code == 2
        assert str(profile) in result.stderr
    assert profile.read_text(encoding="utf-8") == text
    assert not (tmp_path / "out").exists()


def test_a_profile_is_never_an_input(good: Path, tmp_path: Path) -> None:
    before = good.read_bytes()
    result = run("smooth", good, "-o", tmp_path / "out", "--profile", good, "--learn")
    assert result.exit_code == 2
    assert good.read_bytes() == before


def test_a_profile_of_another_model_does_not_learn(good: Path, fixes: Path, tmp_path: Path) -> None:
    profile = tmp_path / "me.yaml"
    learnt(good, tmp_path / "a", profile, "--fixes", fixes)
    options = ("--profile", profile, "--learn", "--fixes", fixes, "--length-model", "kim")
    line = refused("smooth", good, "-o", tmp_path / "b", *options)
    assert "made for step_length.model = " in line


def test_a_walk_that_the_profile_refuses_has_no_results(good: Path, fixes: Path, tmp_path: Path, monkeypatch) -> None:
    def refuse(*_: object) -> None:
        raise RecordingError("with this walk the profile would get constants that nobody has")

    monkeypatch.setattr(Profile, "with_walk", refuse)
    options = ("--profile", tmp_path / "me.yaml", "--learn", "--fixes", fixes)
    assert "constants that nobody has" in refused("smooth", good, "-o", tmp_path / "out", *options)
    assert list(tmp_path.iterdir()) == []
