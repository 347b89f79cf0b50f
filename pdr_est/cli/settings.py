"""The configuration of a command: the defaults, the profile, the file and the options, in this order."""

import math
from pathlib import Path
from typing import TYPE_CHECKING

from pdr_est.cli.call_paths import note_input
from pdr_est.config import Config, config_with, external_files, load_config

if TYPE_CHECKING:
    from pdr_est.calibration.profile import Profile


def resolve_config(
    config_file: Path | None,
    *,
    estimator: str | None = None,
    detector: str | None = None,
    length_model: str | None = None,
    height_m: float | None = None,
    gender: str | None = None,
    start: tuple[float, float] | None = None,
    heading_deg: float | None = None,
    closed: bool | None = None,
    corridors_deg: float | None = None,
    heading_method: str | None = None,
    attitude: str | None = None,
    profile: "Profile | None" = None,
) -> Config:
    """Build the configuration of a command: defaults, then the walker's profile, then the file, then the options.

    Raises
    ------
    ConfigError
        If a value is wrong or contradicts the profile; the message names the file or the option.
    """
    config = Config()
    if profile is not None:
        from pdr_est.calibration.profile import apply_profile  # not for the commands that know no profile

        config = apply_profile(config, profile)
    if config_file is not None:
        config = load_config(config_file, base=config)
        for path in external_files(config):
            note_input(path)
        if config.gait.model is not None:
            note_input(Path(config.gait.model).expanduser())
    x_m, y_m = (None, None) if start is None else start
    heading_rad = None if heading_deg is None else math.radians(heading_deg)
    corridors = None if corridors_deg is None else {"direction_rad": math.radians(corridors_deg)}
    for option, section, values in (
        ("--estimator", "estimator", {"name": estimator}),
        ("--detector", "steps", {"detector": detector}),
        ("--length-model", "step_length", {"model": length_model}),
        ("--height", "walker", {"height_m": height_m}),
        ("--gender", "walker", {"gender": gender}),
        ("--start", "start", {"x_m": x_m, "y_m": y_m}),
        ("--heading", "start", {"heading_rad": heading_rad}),
        ("--closed", "start", {"closed": closed}),
        ("--corridors", "heading", {"dominant": corridors}),
        ("--heading-method", "heading", {"method": heading_method}),
        ("--attitude", "attitude", {"source": attitude}),
    ):
        given = {key: value for key, value in values.items() if value is not None}
        if given:
            config = config_with(config, {section: given}, option)
    if profile is not None:
        from pdr_est.calibration.profile import check_profile_matches

        check_profile_matches(config, profile, "--profile")
    return config
