"""Every settings file in configs/settings/ loads and gives a track; the default one says what the code says."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pdr_est import pipeline
from pdr_est.config import Config, config_from_dict, config_to_dict, config_to_yaml, load_config
from pdr_est.errors import ConfigError
from pdr_est.front_end.step_length import StepLengthParams
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
    track = pipeline.smooth(walk.recording, load_config(path)).track
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


def test_a_configuration_made_in_python_is_checked_before_use() -> None:
    config = Config(step_length=StepLengthParams(model="typo"))  # type: ignore[arg-type]
    walk = simulate_walk(Scenario(path=PathParams(vertices_m=((0.0, 0.0), (5.0, 0.0)))))
    with pytest.raises(ConfigError, match=r"step_length\.model"):
        pipeline.smooth(walk.recording, config)


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
