"""Refuse inputs of the pipeline that cannot be used, before any work is done."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pdr_est.config import Config
from pdr_est.errors import ConfigError, FloorPlanError, RecordingError
from pdr_est.io.side_tables.position_fixes import require_fix_inside
from pdr_est.params.validation_messages import brief
from pdr_est.preprocessing.quality.requirements import require_track_sensors
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan
from pdr_est.types.measurements import PositionFix
from pdr_est.types.on_plan.sound_plans import require_sound_plan, same_origin
from pdr_est.types.recording import Recording

_FARTHEST_SIGMAS = 4.0  # of start and drawing that a start may lie off the floor: one in thousands is farther


def refuse_no_config(config: Any) -> None:
    """Raise ConfigError for something that is no configuration, such as the path of one."""
    if not isinstance(config, Config):
        remedy = "load it with load_config" if isinstance(config, str | Path) else "give a Config"
        raise ConfigError(f"config = {brief(config)}: is no configuration: {remedy}")


def refuse_settings_for_whole_walks(config: Any) -> None:
    """Raise ConfigError for something that is no configuration, and for settings that need the whole walk."""
    refuse_no_config(config)
    if config.heading.dominant.direction_rad is not None:
        raise ConfigError(
            "heading.dominant.direction_rad: the directions of a building are found from the whole walk: leave "
            "it out for tracking, or use `pdr-est smooth`"
        )


def refuse_wrong_types(recording: Any, config: Any) -> None:
    """Raise RecordingError or ConfigError for something that is no recording or no configuration."""
    refuse_no_config(config)
    if not isinstance(recording, Recording):
        remedy = "read it first: pdr_est.read(path)" if isinstance(recording, str | Path) else "give a Recording"
        raise RecordingError(f"recording = {brief(recording)}: is no recording: {remedy}")


def refuse_unusable_inputs(recording: Recording, config: Config, fixes: Any, plan: Any) -> None:
    """Refuse what no track can be made from.

    Raises
    ------
    ConfigError
        For something that is no configuration.
    RecordingError
        For something that is no recording, for a device without a sensor that a track needs, and for fixes that are
        no `PositionFix` or outside the time of the recording.
    FloorPlanError
        For something that is no plan, a plan in another map frame, and a start outside of its walkable area.
    """
    refuse_wrong_types(recording, config)
    for device in recording.devices:
        require_track_sensors(device, recording.place_of(device), one_of_several=len(recording.devices) > 1)
    _refuse_unusable_fixes(fixes, recording)
    refuse_unusable_plan(plan, config)
    if plan is not None:
        _refuse_other_frame(plan, recording)


def _refuse_unusable_fixes(fixes: Any, recording: Recording) -> None:
    """Check the fixes; the recorder's own may lie outside, for it may have received them before the first sample."""
    if not isinstance(fixes, Sequence) or isinstance(fixes, str):
        raise RecordingError(f"fixes = {brief(fixes)}: is no list: give a list of PositionFix")
    recorded = {id(fix) for fix in recording.fixes}
    for number, fix in enumerate(fixes):
        if not isinstance(fix, PositionFix):
            raise RecordingError(
                f"fixes[{number}] = {brief(fix)}: is no PositionFix: give PositionFix(time_s, position_m, "
                "covariance_m2)"
            )
        if id(fix) not in recorded:
            require_fix_inside(fix.time_s, f"fixes[{number}]", recording)


def refuse_unusable_plan(plan: Any, config: Config) -> None:
    """Raise FloorPlanError for something that is no plan, or none to use, and for a start off its walkable area."""
    if plan is None:
        return
    if not isinstance(plan, FloorPlan | BuildingPlan):
        raise FloorPlanError(f"plan = {brief(plan)}: is no FloorPlan: read it first: pdr_est.read_floor_plan(path)")
    require_sound_plan(plan)
    begins_on = plan.start_plan if isinstance(plan, BuildingPlan) else plan
    if begins_on is not None:
        _refuse_start_outside(begins_on, config)


def _refuse_other_frame(plan: FloorPlan | BuildingPlan, recording: Recording) -> None:
    """Raise FloorPlanError for a plan whose map frame has another place on the Earth than that of the recording."""
    here, there = recording.origin, plan.origin
    if here is not None and there is not None and not same_origin(here, there):
        raise FloorPlanError(
            f"plan {plan.name}: its origin is at latitude {there.latitude_deg:.6f}°, longitude "
            f"{there.longitude_deg:.6f}°, that of the recording at {here.latitude_deg:.6f}°, "
            f"{here.longitude_deg:.6f}°: read the plan with origin=recording.origin"
        )


def _refuse_start_outside(plan: FloorPlan, config: Config) -> None:
    """Raise FloorPlanError for a start that lies off the walkable area of the floor."""
    start = config.start.pose()
    if start.position_m is None:
        return
    off_m = float(plan.distance_outside_m(np.array([start.position_m]))[0])
    if off_m > _FARTHEST_SIGMAS * np.hypot(start.sigma_position_m, plan.sigma_m):
        x, y = start.position_m
        west, south, east, north = plan.bounds_m
        raise FloorPlanError(
            f"start ({x:g}, {y:g}) m lies {off_m:.1f} m outside of the walkable area of the plan {plan.name}, which "
            f"reaches from ({west:.1f}, {south:.1f}) to ({east:.1f}, {north:.1f}) m: correct the start, choose "
            "another floor, or state a larger start.sigma_position_m"
        )
