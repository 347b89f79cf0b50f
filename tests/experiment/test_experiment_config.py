"""An experiment file is checked before anything runs: messages name file, line and remedy."""

import json
import re
from itertools import pairwise
from pathlib import Path

import pytest
import yaml
from experiment_files import SMALL, experiment_file

from pdr_est.errors import ConfigError
from pdr_est.experiment import load_experiment
from pdr_est.experiment.json_schema import experiment_schema, settings_schema
from pdr_est.experiment.runners.scoring_job import experiment_job
from pdr_est.experiment.variants.axes import same_front_end
from pdr_est.simulate import psp_walks, robust_dr_trials

BARE = "data:\n  simulated:\n    number: 1\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (SMALL.replace("seed: 7", "sede: 7"), r"line 12: unknown key 'sede': did you mean 'seed'"),
        (
            SMALL.replace("number: 3", "numbr: 3"),
            r"line 3: unknown key 'data.simulated.numbr': did you mean 'number'",
        ),
        (SMALL.replace("45.0", "5.0"), r"line 5: data.simulated.duration_s = 5.0: .*; the unit is seconds"),
        (SMALL.replace("[[HOLDING]", "[[HAND]"), r"line 6: data.simulated.carrying.0.0 = 'HAND'"),
        (SMALL.replace("heldout", "all"), r"line 10: fixes.protocol = 'all'"),
        (SMALL.replace("heldout", "every\n  sigma_m: 700"), r"line 11: fixes.sigma_m = 700: .*; the unit is metres"),
        (
            SMALL.replace("[carrying]", "[carying]"),
            r"line 11: unknown key to group by 'carying': did you mean",
        ),
        (SMALL + "metrics: [error_opn_m]\n", r"line 13: unknown metric 'error_opn_m': did you mean 'error_open_m'"),
        (SMALL + "seed: 8\n", r"line 13: is not valid YAML \('seed' stands twice\)"),
        (BARE + "metrics: [coverage95]\n", r"line 4: metric coverage95 needs fixes: set fixes.protocol"),
        (
            BARE + "settings:\n  odometry:\n    sigma_lenght_drift: 1\n",
            r"variant 'default': line 6: unknown key 'odometry.sigma_lenght_drift': did you mean",
        ),
        (
            BARE + "variants:\n  fine:\n  fast:\n    resample.rate_hz: -50\n",
            r"variant 'fast': line 7: resample.rate_hz = -50: .*; the unit is hertz",
        ),
        (
            BARE + "sweep:\n  estimator.name: [ekf, kalman]\n",
            r"variant 'kalman': line 5: estimator.name = 'kalman'",
        ),
        (
            BARE + "sweep:\n  steps.detector:\n  - auto\n  - yes\n",
            r"line 7: steps.detector = True: is true or false: give a number or a word",
        ),
        (BARE + "sweep:\n  steps.detector: []\n", r"line 5: sweep steps.detector: no value to sweep over"),
        (BARE + "variants:\n  a: {settings_file: gone.yaml}\n", r"line 5: settings_file = 'gone.yaml': no such file"),
        (
            BARE + "settings: {steps: {detector: auto}, steps.detector: mmpdr}\n",
            r"line 4: steps.detector stands twice",
        ),
        (BARE + "variants:\n  ekf: 3\n", r"line 5: variants.ekf"),
        (BARE + "sweep:\n  estimatr.name: [ekf]\n", r"line 5: unknown key 'estimatr': did you mean 'estimator'"),
        (BARE + "sweep:\n  estimator: [ekf]\n", r"line 5: estimator = 'ekf': is a section, give it keys"),
        (BARE + "sweep:\n  resample.rate_hz: 50\n", r"line 5: sweep.resample.rate_hz = 50: is no list: write its"),
        (BARE + "sweep:\n  estimator.name: [ekf, ekf]\n", r"line 5: two variants are called 'ekf': rename one"),
        (BARE + "sweep: [ekf]\n", r"line 4: sweep = \['ekf'\]: is no section: write keys"),
        (BARE + "variants:\n  1: {}\n", r"line 5: variants.1 = 1: is no text: put it in quotes"),
        (BARE + "variants:\n  a: {}\n  a: {}\n", r"line 6: is not valid YAML \('a' stands twice\)"),
        (BARE + "variants:\n  a: {'': 3}\n", r"line 5: unknown key ''"),
        (BARE + "settings: {estimator: ekf}\n", r"line 4: estimator = 'ekf': is a section"),
        (
            BARE + "settings: {estimator.name: ekf, estimator: {name: ekf}}\n",
            r"line 4: estimator.name stands twice: remove one",
        ),
        (BARE + "settings:\n  start.x_m: 1.0\n", r"line 5: start: x_m and y_m belong together"),
        (BARE + "settings: {walker.height_m: 173}\n", r"line 4: walker.height_m = 173: .*; the unit is metres"),
        (BARE + "settings_file: other.yaml\n", r"line 4: settings_file = 'other.yaml': no such file"),
        (BARE + "seed: -1\n", r"line 4: seed = -1: Input should be greater than or equal to 0"),
        (BARE + "metrics: [count_error, count_error]\n", r"line 4: count_error stands twice: remove one"),
        (BARE + "metrics: count_error\n", r"line 4: metrics = 'count_error': is no list: write its values in"),
        (BARE + "group_by: [person, person]\n", r"line 4: person stands twice"),
        ("data:\n  simulated: {seed: -3}\n", r"line 2: data.simulated.seed = -3"),
        ("data:\n  simulated: {carrying: []}\n", r"line 2: data.simulated.carrying = \[\]: is empty: give at least"),
        ("data:\n  simulated:\n", r"line 1: data: none is given, or nothing below it: name one of"),
        ("data:\n  simulated: {series: [psp-I, psp-I]}\n", r"line 1: series psp-I, psp-I: .* use number instead"),
        ("data:\n  simulated: {series: [psp-I], presets: [straight]}\n", r"line 1: presets and series are given"),
        ("data:\n  simulated: {series: [psp]}\n", r"line 2: data.simulated.series.0 = 'psp': Input should be"),
        ("data:\n  suite: ilc2\n", r"line 2: unknown suite 'ilc2': did you mean 'ilc20'"),
        (
            "data:\n  suite: ilc20\n  folder: nowhere\n",
            r"line 3: data folder .*nowhere: no such folder: .* --data",
        ),
        ("data:\n  suite: ilc20\n", r"line 1: data: no walk found"),
        ("data:\n  recordings: ['*.csv']\n", r"line 1: recordings: nothing in .* matches '\*.csv'"),
        (
            "data:\n  recordings: ['../*.csv']\n",
            r"line 1: recordings: '../\*.csv' is no pattern inside",
        ),
        ("data:\n  simulated: {presets: [straight, straight]}\n", r"line 1: presets straight, straight: one stands"),
        ("data: {}\n", r"line 1: data: none is given, or nothing below it: name one of suite, recordings, simulated"),
        ("data:\n  suite: ilc20\n  simulated: {}\n", r"suite and simulated are given"),
        (
            "data:\n  simulated: {presets: [office]}\n",
            r"line 2: unknown simulated walk 'office': did you mean",
        ),
        (
            "data:\n  suite: weallwalk\nfixes:\n  protocol: heldout\n",
            r"line 4: fixes.protocol = 'heldout': suite weallwalk knows no true positions",
        ),
        ("seed: 1\n", r"is no experiment: it needs a section `data`"),
    ],
)
def test_what_is_wrong_is_told_with_file_line_and_remedy(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ConfigError, match=rf"small\.yaml.*{message}") as caught:
        load_experiment(experiment_file(tmp_path, text))
    assert "\n" not in str(caught.value)


def test_variants_are_every_combination_named_by_what_differs(tmp_path: Path) -> None:
    text = BARE + (
        "settings: {walker: {height_m: 1.8}}\n"
        "variants:\n  plain:\n  taught:\n    walker.length_scale: 1.1\n    steps: {detector: mmpdr}\n"
        "sweep:\n  estimator.name: [ekf, dead-reckoning]\n  odometry.sigma_length_scale: [0.1, 0.2]\n"
    )
    variants = load_experiment(experiment_file(tmp_path, text)).variants
    assert [variant.name for variant in variants] == [
        f"{name} {estimator} sigma_length_scale={scale}"
        for name in ("plain", "taught")
        for estimator in ("ekf", "dead-reckoning")
        for scale in (0.1, 0.2)
    ]
    last = variants[-1].config
    assert (last.walker.height_m, last.walker.length_scale, last.steps.detector) == (1.8, 1.1, "mmpdr")
    assert (last.estimator.name, last.odometry.sigma_length_scale) == ("dead-reckoning", 0.2)
    assert variants[0].config.walker.length_scale == 1.0


def test_settings_files_lie_beside_the_experiment_and_come_before_its_settings(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("walker: {height_m: 1.6}\nsteps: {detector: mmpdr}\n", encoding="utf-8")
    text = BARE + "settings: {steps.detector: auto}\nvariants:\n  mine: {settings_file: mine.yaml}\n  other:\n"
    mine, other = load_experiment(experiment_file(tmp_path, text)).variants
    assert (mine.config.walker.height_m, mine.config.steps.detector) == (1.6, "auto")
    assert other.config.walker.height_m != 1.6


def test_two_variants_of_one_name_are_refused(tmp_path: Path) -> None:
    text = BARE + "variants:\n  a ekf:\n  a:\nsweep:\n  estimator.name: [ekf]\n"
    load_experiment(experiment_file(tmp_path, text))
    text = BARE + "sweep:\n  estimator.name: [ekf, ekf]\n"
    with pytest.raises(ConfigError, match="two variants are called 'ekf': rename one"):
        load_experiment(experiment_file(tmp_path, text))


def test_the_resolved_file_is_an_experiment_with_the_same_variants_and_walks(tmp_path: Path) -> None:
    first = load_experiment(experiment_file(tmp_path))
    again = load_experiment(experiment_file(tmp_path, first.to_yaml(), "resolved.yaml"))
    assert again.variants == first.variants
    assert again.walks == first.walks
    assert again.to_yaml() == first.to_yaml()
    assert yaml.safe_load(first.to_yaml())["variants"]["ekf"]["resample"]["rate_hz"] == 50.0


def test_variants_that_share_a_front_end_are_worked_on_in_a_row(tmp_path: Path) -> None:
    text = BARE + "sweep:\n  estimator.name: [ekf, dead-reckoning]\n  steps.detector: [auto, mmpdr]\n"
    variants = experiment_job(load_experiment(experiment_file(tmp_path, text))).variants
    changes = sum(not same_front_end(a.config, b.config) for a, b in pairwise(variants))
    assert changes == 1


def test_recordings_that_would_be_one_walk_are_refused(tmp_path: Path) -> None:
    for name in ("walk.csv", "walk.txt"):
        (tmp_path / name).write_text("x", encoding="utf-8")
    text = "data:\n  recordings: ['*.csv', '*.txt']\n"
    with pytest.raises(ConfigError, match=r"walk.csv and walk.txt would both be the walk 'walk': rename one"):
        load_experiment(experiment_file(tmp_path, text))


def test_the_limit_takes_the_first_walks_and_leaves_them_as_they_are(tmp_path: Path) -> None:
    path = experiment_file(tmp_path)
    assert load_experiment(path, limit=2).walks == load_experiment(path).walks[:2]


def test_the_walks_of_a_paper(tmp_path: Path) -> None:
    text = "data:\n  simulated: {series: [psp-I, robust-dr], number: 3}\nseed: 4\n"
    walks = load_experiment(experiment_file(tmp_path, text)).walks
    assert [walk.labels["series"] for walk in walks] == ["psp-I"] * 3 + ["robust-dr"] * 3
    assert [walk.source for walk in walks] == [*psp_walks("I", 3, 4), *robust_dr_trials(4, 3)]


def test_a_limit_spares_the_rest_of_a_population(tmp_path: Path) -> None:
    text = BARE.replace("number: 1", "number: 100000")
    assert len(load_experiment(experiment_file(tmp_path, text), limit=2).walks) == 2


def test_schemas_know_the_keys() -> None:
    schema = experiment_schema()
    assert set(schema["properties"]) >= {"data", "variants", "sweep", "fixes", "metrics", "group_by", "seed"}
    assert schema["additionalProperties"] is False
    used = set(re.findall(r'"#/\$defs/([^"]+)"', json.dumps(schema)))
    assert {"Settings", "Variant", "DataParams", "ResampleParams"} <= used <= set(schema["$defs"])
    assert "resample" in settings_schema()["properties"]
