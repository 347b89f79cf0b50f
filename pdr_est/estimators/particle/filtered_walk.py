"""A whole walk filtered by particles, with the particles at the ends of blocks of a few steps."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.common.initial_state import late_start_donor, start_prior, starts_of
from pdr_est.estimators.common.nodes import SAME_S, Node
from pdr_est.estimators.common.tethers import NodeTether, PairTether
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.particle.backward import Block, thinned_cloud
from pdr_est.estimators.particle.cloud import Cloud
from pdr_est.estimators.particle.initial_cloud import initial_cloud, spread_over_plan, turned_anywhere
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.places.modes import places_at
from pdr_est.estimators.particle.places.open_start import begins_anywhere
from pdr_est.estimators.particle.places.start_region import particles_in_region
from pdr_est.estimators.particle.plan.plan_grid import PlanGrid, Window
from pdr_est.estimators.particle.plan.plan_model import PlanModel
from pdr_est.estimators.particle.plan.plans_in_time import PlansInTime
from pdr_est.estimators.particle.walk_filter import WalkEvidence, WalkFilter
from pdr_est.types.measurements import LATE_START_S, StartPose
from pdr_est.types.on_plan.places import PlacesAt

_BLOCK_NODES = 4  # of each device in a block
_SURELY = 1.3  # of the length of a walk, beyond which no particle gets
_FIX_ERROR_M = 30.0  # beyond which no particle is from the first fix


@dataclass(frozen=True)
class WalkInput:
    """Inputs of a walk.

    Attributes
    ----------
    timelines
        Measurements of each device.
    tethers
        Tethers between nodes of the devices, in order of time.
    start
        Start pose of the walk as far as it is known.
    sigma_length_scale
        Standard deviation of the walker's length scale.
    parameters
        Settings.
    """

    timelines: tuple[Timeline, ...]
    tethers: tuple[NodeTether, ...]
    start: StartPose
    sigma_length_scale: float
    parameters: ParticleParams


@dataclass(frozen=True)
class ParticleWalk:
    """Filtered walk.

    Attributes
    ----------
    blocks
        Blocks, the start first. Of a walk that may begin anywhere they hold few of the particles, except the last.
    evidence
        How probable its measurements are, and its ways on the plans.
    places
        Places on the plan after each block of a walk that may begin anywhere on it; none of others.
    """

    blocks: tuple[Block, ...]
    evidence: WalkEvidence
    places: tuple[PlacesAt, ...] = ()


def filter_by_particles(walk: WalkInput, plans: PlansInTime | None, begun: PlanGrid | None = None) -> ParticleWalk:
    """Filter a walk from its start to its end, on the plan of the floor of each time.

    Parameters
    ----------
    walk
        The walk.
    plans
        Plans of the floors, or None.
    begun
        Where a walk that may begin anywhere on the plan can have begun, if that is known; None for the whole plan.
    """
    rng = np.random.default_rng(walk.parameters.seed)
    events, begun_s = _events(walk.timelines)
    plan = None if plans is None else plans.at(begun_s)
    anywhere = plan is not None and begins_anywhere(walk.timelines, walk.start)
    own = WalkFilter(_start(walk, plan, begun, rng), walk.parameters, plan, rng, anywhere)
    tethers = list(walk.tethers)
    maker = _BlockMaker(len(walk.timelines))
    places, walked_m = [], 0.0
    for number, (device, index) in enumerate(events):
        node = walk.timelines[device].nodes[index]
        if plans is not None and plans.at(node.time_s) is not own.plan:
            own.change_floor(plans.at(node.time_s), sorted(maker.begun))
        if index:
            own.move(device, node)
            walked_m += node.length_m / len(walk.timelines)
        else:
            donor = late_start_donor(0, node.time_s, begun_s, maker.begun)
            if donor is not None:
                own.enter(device, donor)
            own.begin(device)
        own.measure(device, node)
        if index == len(walk.timelines[device].nodes) - 1 and walk.timelines[device].closure_sigma_m is not None:
            own.close(device, walk.timelines[device].closure_sigma_m or 0.0)
        maker.add(device, node)
        following = events[number + 1] if number + 1 < len(events) else None
        until_s = np.inf if following is None else walk.timelines[following[0]].nodes[following[1]].time_s
        due = [one for one in tethers if one.time_s + SAME_S < until_s]
        own.tether([PairTether(t.device_a, t.device_b, t.max_distance_m, t.sigma_m) for t in due])
        del tethers[: len(due)]
        after = None if following is None else walk.timelines[following[0]].nodes[following[1]]
        changes = plans is not None and after is not None and plans.at(after.time_s) is not own.plan
        if maker.ends(node, after, following, bool(due) or changes):
            if anywhere:
                places.append(places_at(own.cloud, node.time_s, walked_m))
            maker.close(thinned_cloud(own.cloud, rng) if anywhere and following is not None else own.cloud, own.plan)
    return ParticleWalk(tuple(maker.blocks), own.evidence, tuple(places))


def window_of(walk: WalkInput) -> Window | None:
    """Return the part of the map that a walk cannot leave: its length around its start or first fix.

    None where neither is known.
    """
    start_m = walk.start.position_m
    longest_m, places = 0.0, [] if start_m is None else [np.array(start_m)]
    for timeline in walk.timelines:
        longest_m = max(longest_m, sum(node.length_m for node in timeline.nodes))
        places += [np.asarray(fix.position_m, dtype=np.float64) for fix in timeline.fixes]
    if not places:
        return None
    reach_m = _SURELY * longest_m + _FIX_ERROR_M
    return places[0] - reach_m, places[0] + reach_m


def _start(walk: WalkInput, plan: PlanModel | None, begun: PlanGrid | None, rng: np.random.Generator) -> Cloud:
    """Draw the particles at the start, on a part of the plan where the walk can have begun, if that is known."""
    starts = starts_of(walk.timelines, walk.start)
    priors = [
        start_prior(one, start, walk.sigma_length_scale) for one, start in zip(walk.timelines, starts, strict=True)
    ]
    nodes = [one.nodes for one in walk.timelines]
    count = walk.parameters.most_particles
    known = walk.start.heading_rad is not None or any(one.observes_heading for one in walk.timelines)
    any_direction = plan is not None and not known  # without a plan, the direction of the walk defines the frame
    anywhere = plan is not None and begins_anywhere(walk.timelines, walk.start)
    if anywhere and plan is not None:
        count = plan.particles_anywhere(walk.parameters)
        if begun is not None:
            count = particles_in_region(begun, walk.parameters)
    elif any_direction or any(one.heading_open or one.position_open for one in priors):
        count *= 2
    cloud = initial_cloud(priors, nodes, count, rng)
    cloud = turned_anywhere(cloud, rng) if any_direction else cloud
    return spread_over_plan(cloud, begun or plan.grid, rng) if anywhere and plan is not None else cloud


def _events(timelines: Sequence[Timeline]) -> tuple[list[tuple[int, int]], float]:
    """Return device and number of all nodes in order of time, and the time at which the walk begins.

    Devices that begin with the walk begin at the same time, so that a fix or tether finds all of them.
    """
    begun_s = min(one.nodes[0].time_s for one in timelines)
    keys = []
    for device, timeline in enumerate(timelines):
        with_walk = timeline.nodes[0].time_s <= begun_s + LATE_START_S
        for index, node in enumerate(timeline.nodes):
            keys.append((begun_s if index == 0 and with_walk else node.time_s, index > 0, device, index))
    return [(device, index) for _, _, device, index in sorted(keys)], begun_s


class _BlockMaker:
    """Collects nodes into blocks.

    Parameters
    ----------
    devices
        Number of devices.
    """

    def __init__(self, devices: int) -> None:
        self.blocks: list[Block] = []
        self.begun: set[int] = set()
        self._present = (False,) * devices
        self._nodes: list[list[Node]] = [[] for _ in range(devices)]

    def add(self, device: int, node: Node) -> None:
        """Add the next node of a device."""
        self._nodes[device].append(node)
        self.begun.add(device)

    def ends(self, node: Node, after: Node | None, following: tuple[int, int] | None, changes: bool) -> bool:
        """Tell whether a block ends at a node, of which `after`, that of `following`, is the next one.

        It does where something `changes`: a tether was applied there, or another floor begins.
        """
        if after is None or following is None or following[1] == 0:
            return after is None or following is None or bool(self.blocks)
        if not self.blocks or changes or node.fixes or after.turn_hypotheses or len(self.begun) > sum(self._present):
            return True
        return sum(map(len, self._nodes)) >= _BLOCK_NODES * len(self.begun)

    def close(self, cloud: Cloud, plan: PlanModel | None) -> None:
        """End a block with the particles there, and the plan of its floor."""
        self.blocks.append(Block(cloud, tuple(map(tuple, self._nodes)), self._present, plan))
        self._present = tuple(device in self.begun for device in range(len(self._nodes)))
        self._nodes = [[] for _ in self._nodes]
