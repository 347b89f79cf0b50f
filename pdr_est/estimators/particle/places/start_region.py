"""Places where a walk can have begun, by the particles at its end."""

from dataclasses import replace

import numpy as np
from scipy import ndimage

from pdr_est.estimators.particle.cloud import DEVICE_ROWS, START_EAST, Cloud
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.plan.plan_grid import PlanGrid

_AROUND_M = 1.5  # around the starts of particles
_LEAST = 1e-6  # weight of a particle that counts
_PER_M2 = 20.0  # particles; ours


def start_region(grid: PlanGrid, end: Cloud) -> PlanGrid:
    """Return the raster of a plan with the part walkable where particles of the end of the walk began."""
    east, north = end.state[START_EAST:DEVICE_ROWS, end.weights >= _LEAST]
    rows, columns = grid.walkable.shape
    column = ((east - grid.origin_m[0]) / grid.cell_m).astype(np.int64)
    row = ((north - grid.origin_m[1]) / grid.cell_m).astype(np.int64)
    begun = np.zeros((rows, columns), dtype=np.bool_)
    begun[np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)] = True
    around = ndimage.maximum_filter(begun, size=2 * int(np.ceil(_AROUND_M / grid.cell_m)) + 1)
    return replace(grid, walkable=np.where(around, grid.walkable, np.float32(0.0)))


def particles_in_region(region: PlanGrid, parameters: ParticleParams) -> int:
    """Return the number of particles of a walk that began in a region."""
    count = int(np.ceil(_PER_M2 * float(region.walkable.sum()) * region.cell_m**2))
    return min(max(count, 2 * parameters.most_particles), parameters.most_start_particles)
