"""Every settings file in configs/settings/ loads and gives a track; the default one says what the code says."""

import pickle
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np
import pytest

from pdr_est import pipeline
from pdr_est.calibration.profile import Profile
from pdr_est.config import Config, StartParams, config_from_dict, config_to_dict, config_to_yaml, load_config
from pdr_est.errors import ConfigError
from pdr_est.experiment.config import ExperimentConfig
from pdr_est.experiment.json_schema import settings_schema
from pdr_est.front_end.step_length import StepLengthParams
from pdr_est.front_end.steps import StepsParams
from pdr_est.front_end.steps.bandpass_peaks import AutoStepParams
from pdr_est.online.params import OnlineParams
from pdr_est.params.field_docstrings import field_docstrings
from pdr_est.params.validation_messages import kinds_of
from pdr_est.preprocessing.resampling import ResampleParams
from pdr_est.simulate import DeviceParams, Scenario, SensorParams, simulate_walk
from pdr_est.simulate.walker.walking_path import PathParams

CONFIGS = sorted((Path(__file__).parents[1] / "configs" / "settings").glob("*.yaml"))


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_config_runs(path: Path) -> None:
    scenario = Scenario(
        path=PathParams(vertices_m=((0.0, 0.0), (25.0, 0.0))),
        devices=(DeviceParams(sensors=SensorParams(record_attitude=True)),),
    )
    walk = simulate_walk(scenario)
    track = pipeline.smooth_recording(walk.recording, load_config(path)).track
    assert abs(len(track) - 1 - walk.step_count) <= 1
    assert np.linalg.norm(track.position_m[-1] - track.position_m[0]) == pytest.approx(25.0, rel=0.15)


def test_default_file_is_the_default() -> None:
    path = next(path for path in CONFIGS if path.stem == "default")
    assert load_config(path) == Config()
    assert config_to_yaml(Config()) in path.read_text(encoding="utf-8")


def test_round_trip() -> None:
    config = Config().with_estimator("ekf")
    assert config_from_dict(config_to_dict(config), "test") == config


def test_unknown_key_names_the_nearest(tmp_path: Path) -> None:
    path = tmp_path / "typo.yaml"
    path.write_text("odometry:\n  sigma_lenght_drift: 0.1\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"typo.yaml.*odometry.sigma_lenght_drift.*sigma_length_drift"):
        load_config(path)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"resample": {"rate_hz": -50}}, "resample.rate_hz"),
        ({"walker": {"gender": "m"}}, "walker.gender"),
        ({"start": {"x_m": 1.0}}, "x_m and y_m belong together"),
        ({"odometry": {"sigma_length_scale": float("nan")}}, "odometry.sigma_length_scale"),
        ({"walker": {"length_scale": 2.1}}, "walker.length_scale = 2.1"),
        ({"walker": {"length_scale": 0.45}}, "walker.length_scale = 0.45"),
        ({"walker": {"reference_cadence_hz": 0.5}}, "walker.reference_cadence_hz = 0.5"),
        ({"walker": {"reference_cadence_hz": 100.0}}, "walker.reference_cadence_hz = 100.0: .* hertz"),
        (
            {"steps": {"auto": {"high_hz": 25.0}}},
            "steps.auto: high_hz = 25 is not below half of resample.rate_hz = 50",
        ),
        ({"steps": {"auto": {"low_hz": 3.0}}}, "steps.auto: low_hz = 3 is not below high_hz = 2: swap them"),
        ({"steps": {"auto": {"low_hz": 1e-6}}}, "steps.auto: low_hz = 1e-06 is below 0.001: .* raise it"),
        (
            {"steps": {"detector": "zero-crossing", "zero_crossing": {"cutoff_hz": 30}}},
            "steps.zero_crossing: cutoff_hz = 30 is not below half",
        ),
        (
            {"steps": {"detector": "local-variance", "local_variance": {"stance_mps2": 9.0}}},
            "steps.local_variance: stance_mps2 9.0 is above swing_mps2",
        ),
        (
            {"heading": {"method": "psp", "dominant": {"direction_rad": 0.5}}},
            r"heading.dominant.direction_rad = 0.5 \(--corridors 28.6479\): .* heading.method = psp .* no use",
        ),
        ({"heading": {"use": "increments", "dominant": {"direction_rad": 0.5}}}, "with heading.use = increments"),
        (
            {"heading": {"dominant": {"direction_rad": 0.5, "enabled": False}}},
            "dominant.enabled = false makes no use",
        ),
        ({"heading": {"dominant": {"straight": {"piece_steps": 0}}}}, "heading.dominant.straight.piece_steps = 0"),
        ({"heading": {"dominant": {"straight": {"turn_rad": -1.0}}}}, "heading.dominant.straight.turn_rad = -1.0"),
        ([1, 2], "top level"),
    ],
)
def test_bad_values_name_the_key(settings: object, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        config_from_dict(settings, "test")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ResampleParams(rate_hz=-1), r"^ResampleParams: rate_hz = -1: .* equal to 10; the unit is hertz$"),
        (lambda: ResampleParams(rat_hz=50), r"^ResampleParams: unknown key 'rat_hz': did you mean 'rate_hz'\?"),
        (lambda: ResampleParams(rate_hz=True), r"rate_hz = True: is true or false: give a number"),
        (lambda: ResampleParams(max_gap_s=np.inf), r"max_gap_s = inf"),
        (lambda: replace(ResampleParams(), rate_hz=2000.0), r"rate_hz = 2000.0: .* less than or equal to 1000"),
        (lambda: StepLengthParams(model="typo"), r"^StepLengthParams: model = 'typo': Input should be 'auto', .*"),
        (lambda: StartParams(x_m=1.0), r"^StartParams: x_m and y_m belong together"),
        (lambda: Config(resample={"rate_hz": 5}), r"^Config: resample.rate_hz = 5"),
        (
            lambda: Config(start=StartParams(closed=True)).with_estimator("fixed-lag"),
            r"start.closed: fixed-lag makes",
        ),
        (
            lambda: Config(steps=StepsParams(auto=AutoStepParams(high_hz=25.0))),
            r"^Config: steps.auto: high_hz = 25 is not below half of resample.rate_hz = 50",
        ),
    ],
)
def test_a_record_is_validated_when_it_is_made(make: Callable[[], object], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        make()


def test_numbers_of_other_kinds_are_taken() -> None:
    made = ResampleParams(rate_hz=np.float64(25.0), max_gap_s=1)
    assert made == ResampleParams(rate_hz=25.0, max_gap_s=1.0)
    assert {type(made.rate_hz), type(made.max_gap_s)} == {float}
    assert len({hash(Config()), hash(Config().replace({}))}) == 1
    assert pickle.loads(pickle.dumps(Config())) == Config()


def test_dotted_keys_replace_settings() -> None:
    config = Config().replace({"steps.detector": "mmpdr", "odometry": {"sigma_length_scale": 0.2}})
    assert (config.steps.detector, config.odometry.sigma_length_scale) == ("mmpdr", 0.2)
    assert config.replace({"steps.detector": "auto", "odometry.sigma_length_scale": 0.11}) == Config()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"steps.detctor": "mmpdr"}, r"unknown key 'steps.detctor': did you mean 'detector'\?"),
        ({"stepps.detector": "mmpdr"}, r"unknown key 'stepps': did you mean 'steps'\?"),
        ({"steps.detector.name": "mmpdr"}, r"steps.detector = \{'name': 'mmpdr'\}: is no text"),
        ({"steps.detector": "mmpdr", "steps": {"detector": "auto"}}, r"steps.detector stands twice"),
        ({"resample.rate_hz": 5}, r"^Config.replace: resample.rate_hz = 5: "),
        ({"steps.parameters": {"a": 1}}, r"steps.parameters: are for a part of your own, and steps.detector = auto"),
    ],
)
def test_dotted_keys_that_are_wrong_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        Config().replace(changes)


def test_changed_sections_are_validated_as_in_the_whole_configuration() -> None:
    changes = {
        "walker": {"height_m": "1.7"},
        "heading": {"dominant": {"direction_rad": 1}},
        "start": {"closed": True},
    }
    changed = Config().replace(changes)
    assert changed == config_from_dict(changes, "here")
    assert type(changed.walker.height_m) is float
    assert changed.replace({"walker.gender": "female"}).walker.height_m == 1.7
    message = "start.closed: .* makes no use of a walk that ends where it began"
    with pytest.raises(ConfigError, match=message):
        changed.replace({"estimator.name": "dead-reckoning"})
    with pytest.raises(ConfigError, match=message):
        replace(changed, estimator=replace(changed.estimator, name="dead-reckoning"))


def test_dotted_keys_in_a_file(tmp_path: Path) -> None:
    path = tmp_path / "dotted.yaml"
    path.write_text("steps.detector: mmpdr\nresample: {rate_hz: 40}\nheading.use: increments\n", encoding="utf-8")
    config = load_config(path)
    assert (config.steps.detector, config.resample.rate_hz, config.heading.use) == ("mmpdr", 40.0, "increments")
    path.write_text("title.x: 3\n\nsteps.detctor: mmpdr\n", encoding="utf-8")
    with pytest.raises(
        ConfigError, match=r"dotted.yaml: line 3: unknown key 'steps.detctor'.*; line 1: unknown key 'title'"
    ):
        load_config(path)
    path.write_text("steps.detector: mmpdr\nsteps:\n  detector: auto\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"line 2: steps.detector stands twice"):
        load_config(path)


def records(record: type) -> Iterator[type]:
    """Yield a parameter record and all records of its fields."""
    yield record
    for hint in get_type_hints(record, include_extras=True).values():
        for kind in kinds_of(hint):
            if is_dataclass(kind) and isinstance(kind, type):
                yield from records(kind)


def test_every_setting_has_a_docstring() -> None:
    missing = [
        f"{record.__name__}.{entry.name}"
        for top in (Config, ExperimentConfig, OnlineParams, Scenario, Profile)
        for record in dict.fromkeys(records(top))
        for entry in fields(record)
        if entry.name not in field_docstrings(record)
    ]
    assert missing == []


def test_the_schema_and_the_commented_settings_show_the_docstrings(tmp_path: Path) -> None:
    schema = settings_schema()
    words = schema["$defs"]["StartParams"]["properties"]["heading_rad"]["description"]
    assert words == "Heading at the start, rad, counter-clockwise from east; null if unknown."
    assert schema["properties"]["steps"]["description"] == "Detection of the steps."
    text = config_to_yaml(Config(), comments=True)
    assert f"  # {words}\n  heading_rad: null\n" in text
    path = tmp_path / "shown.yaml"
    path.write_text(text, encoding="utf-8")
    assert load_config(path) == Config()


def test_a_transition_has_one_length() -> None:
    sections = {"mode": {"method": "mmpdr", "mmpdr": {"window_s": 1.5}}, "steps": {"detector": "mmpdr"}}
    with pytest.raises(ConfigError, match=r"window_s = 1.5 and steps.mmpdr.transition_s = 2 .* give them one value"):
        config_from_dict(sections, "here")
    config_from_dict({**sections, "steps": {"detector": "auto"}}, "here")
    config_from_dict({**sections, "steps": {"detector": "mmpdr", "mmpdr": {"transition_s": 1.5}}}, "here")


@pytest.mark.parametrize(
    ("section", "values"),
    [
        ("steps", {"relative_threshold": {"pre_window_s": 61.0}}),
        ("steps", {"zero_crossing": {"mean_window_s": 1e6}}),
        ("mode", {"auto": {"hop_s": 10.0}}),
        ("mode", {"auto": {"moving_deg": 360.0}}),
    ],
)
def test_windows_of_minutes_are_refused(section: str, values: dict[str, Any]) -> None:
    """They would ask for gigabytes, or leave every recording too short to tell anything."""
    with pytest.raises(ConfigError, match="less than or equal to"):
        config_from_dict({section: values}, "here")
