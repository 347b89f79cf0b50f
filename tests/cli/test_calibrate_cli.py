"""`pdr-est calibrate` and `smooth --profile`: a profile there and back, and what is refused before one is written."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from cli_recordings import Walk, columns_of, lines_of, save
from cli_runs import refused, run, smoothed

from pdr_est.calibration.profile import Profile
from pdr_est.calibration.profile_file import load_profile
from pdr_est.calibration.step_length_fit import MEAN_EXPONENT
from pdr_est.config import Config
from pdr_est.front_end.step_length import LAW_OF_AUTO


def profile_of(*arguments: object, out: Path) -> Profile:
    result = run("calibrate", *arguments, "-o", out)
    assert result.exit_code == 0, result.output
    assert result.stdout.endswith(f"-> {out}\n")
    return load_profile(out)


def calibrate_refused(folder: Path, *arguments: object) -> str:
    folder.mkdir()
    line = refused("calibrate", *arguments, "-o", folder / "p.yaml")
    assert list(folder.iterdir()) == []
    return line


def summary(out: Path) -> dict:
    return json.loads((out / "summary.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def by_distance(good: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The profile of somebody whose 12 m of the tests are 15 m."""
    path = tmp_path_factory.mktemp("profile") / "p.yaml"
    profile_of(good, "--distance", 15.0, out=path)
    return path


def test_what_stands_in_the_profile(by_distance: Path) -> None:
    profile = load_profile(by_distance)
    assert [walk.distance_m for walk in profile.walks] == [15.0]
    assert (profile.note.step_length, profile.note.detector) == (Config().step_length, "auto")
    assert 1.05 < profile.walker.length_scale < 1.35
    assert profile.walker.cadence_exponent == pytest.approx(MEAN_EXPONENT)  # one walk does not tell it
    assert 1.0 < profile.walker.reference_cadence_hz < 2.5
    assert 0.05 < profile.sigma_length_scale < 0.11


def test_smooth_uses_the_profile_and_says_so(by_distance: Path, good: Path, tmp_path: Path) -> None:
    profile = load_profile(by_distance)
    smoothed(good, tmp_path / "plain")
    smoothed(good, tmp_path / "own", "--profile", by_distance)
    plain, own = summary(tmp_path / "plain"), summary(tmp_path / "own")
    assert own["distance_m"] == pytest.approx(profile.walker.length_scale * plain["distance_m"], rel=1e-3)
    assert own["length_scale"]["sigma"] == pytest.approx(profile.sigma_length_scale)
    assert "steps of the profile" in own["length_scale"]["meaning"]
    assert plain["profile"] is None
    assert own["profile"]["learnt"]["length_scale"] == profile.walker.length_scale
    assert own["profile"]["profile"]["date"] == profile.note.date.isoformat()
    report = (tmp_path / "own" / "report.html").read_text(encoding="utf-8")
    assert "profile of the walker" in report
    assert f"learnt from 1 recording, {profile.note.date}" in report
    assert "profile of the walker" not in (tmp_path / "plain" / "report.html").read_text(encoding="utf-8")


def test_calibration_forgets_an_earlier_one(by_distance: Path, good: Path, tmp_path: Path) -> None:
    config = save(tmp_path / "config.yaml", ["walker:", "  length_scale: 1.5", "  cadence_exponent: 0.7"])
    again = profile_of(good, "--distance", 15.0, "--config", config, out=tmp_path / "again.yaml")
    assert again.walker == load_profile(by_distance).walker


def test_more_walks_and_the_options_of_the_body(good: Path, tmp_path: Path) -> None:
    options = ("--length-model", "static", "--height", 1.6, "--gender", "female")
    out = tmp_path / "p.yaml"
    again = tmp_path / "again.csv"
    again.write_text("\n".join(good.read_text(encoding="utf-8").splitlines()[:-2]) + "\n", encoding="utf-8")
    profile = profile_of(good, again, "--distance", 14.0, "--distance", 14.0, *options, out=out)
    assert (profile.walker.height_m, profile.walker.gender, len(profile.walks)) == (1.6, "female", 2)
    assert profile.note.step_length.model == "static"
    one = profile_of(good, "--distance", 14.0, *options, out=tmp_path / "one.yaml")
    assert one.sigma_length_scale > profile.sigma_length_scale


@pytest.mark.usefixtures("without_report")
def test_fixes_give_the_scale_that_smoothing_with_them_finds(walk: Walk, good: Path, tmp_path: Path) -> None:
    at = np.linspace(0, len(walk.true_time_s) - 1, 5).astype(int)
    shift_s = walk.true_time_s[0]
    rows = [f"{walk.true_time_s[i] - shift_s},{1.2 * walk.true_m[i, 0]},{walk.true_m[i, 1]},0.05" for i in at]
    fixes = save(tmp_path / "fixes.csv", ["time_s,x_m,y_m,sigma_m", *rows])
    profile = profile_of(good, "--fixes", fixes, out=tmp_path / "p.yaml")
    assert [walk.distance_m for walk in profile.walks] == [None]
    smoothed(good, tmp_path / "out", "--fixes", fixes)
    scale = summary(tmp_path / "out")["length_scale"]
    assert scale["value"] == pytest.approx(profile.walker.length_scale, abs=0.06)
    assert scale["value"] > 1.05
    assert re.fullmatch(
        r"estimated from the fixes: steps \d+\.\d % longer than those of the length model, ± \d\.\d %",
        scale["meaning"],
    )


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "give either --distance or --fixes; see pdr-est calibrate --help"),
        (("--distance", 12, "--fixes", "recording"), "give either --distance or --fixes; see"),
        (
            ("--distance", 12, "--distance", 12),
            "--distance is given 2 times for 1 recording.s.: give it once for each",
        ),
        (("--fixes", "a.csv", "--fixes", "b.csv"), "--fixes is given 2 times for 1 recording"),
        (("--distance", 0), "walk.csv: a distance of 0 m: give the length of the way in metres"),
        (("--distance", 1200), "walk.csv: .* m by its steps and 1200 m as given, a scale of .* give metres"),
        (("--fixes", "recording"), "walk.csv: .* has no position fixes"),
        (("--distance", "12 m"), "'12 m' is not a valid float"),
        (("--distance", 12, "--height", 175), "--height: walker.height_m = 175.0: .* metres"),
    ],
    ids=str,
)
def test_what_is_refused(options: tuple[object, ...], message: str, good: Path, tmp_path: Path) -> None:
    line = calibrate_refused(tmp_path / "out", good, *options)
    assert re.search(message, line), line


def test_a_walk_counts_once(good: Path, tmp_path: Path) -> None:
    detour = good.parent / ".." / good.parent.name / good.name
    line = calibrate_refused(tmp_path / "out", good, detour, "--distance", 12, "--distance", 12)
    assert line.startswith(f"{detour}: the same RECORDING is given twice: give each walk once")
    copy = tmp_path / "copy.csv"
    copy.write_bytes(good.read_bytes())
    line = calibrate_refused(tmp_path / "out2", good, copy, "--distance", 12, "--distance", 12)
    assert line.startswith(f"{copy}: holds the same samples as a RECORDING before: give each walk once")


def test_somebody_who_stands_cannot_be_calibrated(walk: Walk, tmp_path: Path) -> None:
    force = np.tile([0.0, 0.0, 9.81], (len(walk.force), 1))
    still = save(tmp_path / "still.csv", lines_of(columns_of(walk, force=force, rate=np.zeros_like(force))))
    line = calibrate_refused(tmp_path / "out", still, "--distance", 12)
    assert line == f"{still}: no step found: nothing to calibrate with; leave this walk out"


def test_smooth_refuses_what_contradicts_the_profile(by_distance: Path, good: Path, tmp_path: Path) -> None:
    def line(*options: object) -> str:
        return refused("smooth", good, "-o", tmp_path / "out", "--profile", *options)

    assert "made for walker.height_m = 1.73, but 1.9 is set" in line(by_distance, "--height", 1.9)
    assert f"made for step_length.model = {LAW_OF_AUTO}, but kim is set" in line(by_distance, "--length-model", "kim")
    assert "made for steps.detector = auto, but zero-crossing is set" in line(
        by_distance, "--detector", "zero-crossing"
    )
    assert "cannot be read" in line(tmp_path / "missing.yaml")


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (["walker:", "  height_m: 1.95"], "--profile: made for walker.height_m = 1.73, but 1.95 is set"),
        (["walker:", "  gender: female"], "made for walker.gender = male, but female is set"),
        (["step_length:", "  range_power_k: 0.6"], "made for step_length.range_power_k = 0.55, but 0.6 is set"),
        (["odometry:", "  sigma_length_scale: 0.3"], "but 0.3 is set"),
    ],
    ids=str,
)
def test_a_file_of_settings_may_not_contradict_the_profile(
    settings: list[str], message: str, by_distance: Path, good: Path, tmp_path: Path
) -> None:
    config = save(tmp_path / "config.yaml", settings)
    line = refused("smooth", good, "-o", tmp_path / "out", "--profile", by_distance, "--config", config)
    assert message in line
    assert not (tmp_path / "out").exists()


@pytest.mark.usefixtures("without_report")
def test_a_file_of_other_settings_goes_with_the_profile(by_distance: Path, good: Path, tmp_path: Path) -> None:
    lines = ["walker:", "  height_m: 1.73", "odometry:", "  gap_speed_mps: 1.25", "estimator:", "  name: ekf"]
    config = save(tmp_path / "config.yaml", lines)
    smoothed(good, tmp_path / "own", "--profile", by_distance, "--config", config)
    used, profile = summary(tmp_path / "own")["config"], load_profile(by_distance)
    assert used["walker"]["length_scale"] == profile.walker.length_scale
    assert used["odometry"]["sigma_length_scale"] == profile.sigma_length_scale
    assert (used["odometry"]["gap_speed_mps"], used["estimator"]["name"]) == (1.25, "ekf")


def test_a_profile_replaces_nothing_unasked_and_never_an_input(good: Path, tmp_path: Path) -> None:
    profile = tmp_path / "me.yaml"
    profile.write_text("mine")
    options = (good, "--distance", 12, "-o")
    assert "exists already: allow overwriting (--overwrite)" in refused("calibrate", *options, profile)
    assert profile.read_text() == "mine"
    assert run("calibrate", *options, profile, "--overwrite").exit_code == 0
    assert profile.read_text() != "mine"
    before = good.read_bytes()
    assert "is the input" in refused("calibrate", *options, good, "--overwrite")
    assert good.read_bytes() == before
