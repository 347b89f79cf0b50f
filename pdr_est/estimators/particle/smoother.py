"""Estimator `particle`: smoothed tracks of all devices of a walk, on a floor plan if there is one."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.common.initial_state import start_prior, starts_of
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.common.tethers import NodeTether, PairTether, node_tethers_between
from pdr_est.estimators.common.timeline import Timeline, track_from_nodes
from pdr_est.estimators.particle.backward import Block, simulate_backward
from pdr_est.estimators.particle.initial_cloud import initial_cloud
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.plan_grid import PlanGrid
from pdr_est.estimators.particle.walk_filter import WalkFilter
from pdr_est.frames import Array
from pdr_est.types.measurements import DeviceTether, StartPose
from pdr_est.types.track import Track, concatenate

NAME = "particle"
_BLOCK_STEPS = 4


def filtered_blocks(timelines, tethers, start, sigma_length_scale, parameters, grid, rng):
    starts = starts_of(timelines, start)
    priors = [start_prior(t, s, sigma_length_scale) for t, s in zip(timelines, starts)]
    open_ = any(p.heading_open or p.position_open for p in priors)
    cloud = initial_cloud(priors, [t.nodes for t in timelines], parameters.most_particles * (2 if open_ else 1), rng)
    flt = WalkFilter(cloud, parameters, grid, rng)
    devices = len(timelines)
    for d, t in enumerate(timelines):
        flt.measure(d, t.nodes[0])
    blocks = [Block(flt.cloud, tuple((t.nodes[0],) for t in timelines), (False,)*devices)]
    events = sorted(((node.time_s, d, i) for d, t in enumerate(timelines) for i, node in enumerate(t.nodes) if i), key=lambda e: (e[0], e[1]))
    current = [[] for _ in range(devices)]
    for k, (time_s, d, i) in enumerate(events):
        node = timelines[d].nodes[i]
        flt.move(d, node)
        flt.measure(d, node)
        current[d].append(node)
        nxt = timelines[events[k+1][1]].nodes[events[k+1][2]] if k+1 < len(events) else None
        if nxt is None or node.fixes or nxt.turn_hypotheses or sum(map(len, current)) >= _BLOCK_STEPS*devices:
            blocks.append(Block(flt.cloud, tuple(map(tuple, current)), (True,)*devices))
            current = [[] for _ in range(devices)]
    return blocks, flt
