"""Walks that may begin anywhere on their plan."""

from collections.abc import Sequence
from dataclasses import replace

from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.types.measurements import StartPose

_STRAY_ANYWHERE_M = 2.0  # largest mean length of ways off the walkable area of a walk that may begin anywhere; ours


def begins_anywhere(timelines: Sequence[Timeline], start: StartPose) -> bool:
    """Tell whether a walk may begin anywhere on its plan, because nothing tells a position."""
    return start.position_m is None and not any(one.fixes for one in timelines)


def search_settings(parameters: ParticleParams) -> ParticleParams:
    """Return settings for a walk that may begin anywhere on its plan, with short ways off the walkable area.

    From a known start they let a walk pass a corridor that is not drawn. Of all starts, some would explain any walk.
    """
    return replace(parameters, stray_length_m=min(parameters.stray_length_m, _STRAY_ANYWHERE_M))
