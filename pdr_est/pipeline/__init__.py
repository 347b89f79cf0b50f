"""The pipeline: from a recording to measurements, and from measurements to a track with findings."""

import time
from collections.abc import Sequence
from dataclasses import replace

from pdr_est.clock_sync import align_device_clocks
from pdr_est.config import Config
from pdr_est.estimators.common.unknown_direction import with_unknown_direction
from pdr_est.parts import NO_PARTS, Parts
from pdr_est.pipeline.estimation import chosen_estimator, run_estimator, with_findings, with_height, with_person
from pdr_est.pipeline.front_end_chain import analyse_device, north_of
from pdr_est.pipeline.inputs import refuse_unusable_inputs, refuse_wrong_types
from pdr_est.pipeline.map_directions import along_map_directions, needs_whole_walk, with_plan_directions
from pdr_est.pipeline.measurements import measurements_of_all, refuse_without_heading, tethers_of
from pdr_est.pipeline.other_devices import with_turns_of_others
from pdr_est.pipeline.present_floors import plans_of_walk
from pdr_est.pipeline.warnings import doubts, mismatches, warnings_of
from pdr_est.preprocessing.gravity_stand_in import ready_for_steps
from pdr_est.types.analysis import DeviceWalk, SmoothedWalk
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import Recording
from pdr_est.types.track import Track

__all__ = ["DeviceWalk", "SmoothedWalk", "analyse_recording", "estimate_tracks", "smooth_recording"]


def smooth_recording(
    recording: Recording,
    config: Config,
    fixes: Sequence[PositionFix] = (),
    parts: Parts = NO_PARTS,
    plan: FloorPlan | BuildingPlan | None = None,
) -> SmoothedWalk:
    """Estimate the track of a recorded walk, and keep what a report needs.

    Raises
    ------
    RecordingError, FloorPlanError
        For a recording, fixes or a plan that cannot be used.
    ConfigError, EstimationError
        As `analyse_recording` and `estimate_tracks`.
    """
    refuse_unusable_inputs(recording, config, fixes, plan)
    estimator = chosen_estimator(config, parts, plan is not None)
    config = with_plan_directions(config, plan, estimator.spec)
    started = time.process_time()
    devices = analyse_recording(recording, config, parts, needs_whole_walk(config, estimator.spec))
    analysed = time.process_time()
    plans = plans_of_walk(plan, devices)
    track = estimate_tracks(devices, config, fixes, parts, plan)
    estimated = time.process_time()
    doubtful = mismatches(devices, config, estimator.spec, fixes, plan)
    return SmoothedWalk(
        track=track,
        devices=devices,
        fixes=tuple(fixes),
        timings_s={"front_end": analysed - started, "estimator": estimated - analysed},
        warnings=(*warnings_of(recording, devices), *doubtful, *plans.notes, *doubts(track, plans, estimator.spec)),
        fixes_used=estimator.spec.uses_fixes,
        plan=plans.main_plan([step.time_s for step in devices[0].steps]),
        floors=plans.floors if isinstance(plan, BuildingPlan) else (),
    )


def analyse_recording(
    recording: Recording, config: Config, parts: Parts = NO_PARTS, at_the_end: bool = True
) -> tuple[DeviceWalk, ...]:
    """Run the front end on every device, for filters not `at_the_end`; steps may be without heading.

    Raises
    ------
    RecordingError
        If a device has no accelerometer or no usable samples, or if devices or clocks do not belong together.
    ConfigError
        For a part that cannot be made.
    """
    refuse_wrong_types(recording, config)
    walks = []
    for device, clock in align_device_clocks(ready_for_steps(recording), config.devices.clock, config.devices.clocks):
        north = north_of(device, recording, config)
        walk = analyse_device(device, recording.place_of(device), config, parts, north, at_the_end)
        walks.append(replace(walk, clock=clock, warnings=device.warnings))
    return tuple(walks)


def estimate_tracks(
    walks: Sequence[DeviceWalk],
    config: Config,
    fixes: Sequence[PositionFix] = (),
    parts: Parts = NO_PARTS,
    plan: FloorPlan | BuildingPlan | None = None,
) -> Track:
    """Estimate the track of every device from its measurements, and of several devices the track of the person.

    Raises
    ------
    FloorPlanError, EstimationError
        For plans without the floor at the start, a device without gyroscope, and measurements that give no track.
    """
    refuse_without_heading(walks)
    estimator = chosen_estimator(config, parts, plan is not None)
    plans = plans_of_walk(plan, walks).measurements
    devices = with_turns_of_others(measurements_of_all(walks, config, fixes, estimator.spec, plans))
    tethers = tethers_of(walks, config, estimator.spec)
    tied = along_map_directions(devices, walks, tethers, estimator, config)
    track = run_estimator(tied, tethers, estimator, config)
    track = with_height(with_findings(track, walks, devices, tethers, estimator, config), walks)
    return with_unknown_direction(with_person(track, config), tied, config.start.pose())
