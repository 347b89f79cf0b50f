"""Settings of the particle filter and smoother, in a module of their own because the estimator is slow to load."""

from typing import Annotated

from annotated_types import Ge, Gt, Le, Lt

from pdr_est.params import Fraction, Positive, params


@params
class ParticleParams:
    """Settings of the particle filter and smoother."""

    seed: Annotated[int, Ge(0)] = 0
    """Seed of the random numbers: equal seeds and measurements give equal tracks."""

    least_particles: Annotated[int, Ge(50), Le(200_000)] = 500
    """Least number of particles."""

    most_particles: Annotated[int, Ge(50), Le(200_000)] = 2_000
    """Largest number of particles of a walk whose start is known roughly; between the two, the number follows how
    far the particles are spread."""

    most_start_particles: Annotated[int, Ge(50), Le(1_000_000)] = 30_000
    """Largest number of particles of a walk that may begin anywhere on the plan."""

    paths: Annotated[int, Ge(10), Le(10_000)] = 200
    """Number of paths that the smoother draws from the posterior."""

    pass_probability: Annotated[float, Gt(0.0), Lt(1.0)] = 0.01
    """Probability with which a step goes through a wall of the plan, or onto ground that is not walkable there: the
    plan may be wrong, and doors are often not drawn (ours)."""

    stray_length_m: Positive = 6.0
    """Mean length, m, of ways off the walkable area before they return (ours)."""

    cell_m: Annotated[float, Gt(0.01), Le(5.0)] = 0.2
    """Size of the cells in which a plan is looked up, m: a third of a step and below the width of a door."""

    unrelated_plan: Fraction = 0.01
    """Probability, before the walk, that the plan has nothing to do with it; ours, chosen with all walks of ILC20 in
    view, because it costs tracks on the right plan least."""
