"""Sections of an experiment file."""

from dataclasses import field
from typing import Annotated, Any, Literal

from annotated_types import Ge, Gt, Le

from pdr_est.evaluate.held_out_fixes import EVERY, WAYPOINT_SIGMA_M
from pdr_est.params import params
from pdr_est.simulate.people.population import PopulationParams

Count = Annotated[int, Ge(1), Le(1_000_000)]
FixesProtocol = Literal["none", "heldout", "every"]
Series = Literal["robust-dr", "psp-I", "psp-II"]


@params
class SimulatedParams(PopulationParams):
    """Simulated walks with exact ground truth: the walks of `series` or `presets`, else a population of people."""

    series: tuple[Series, ...] = ()
    """Walks of the experiments of papers, `number` of each: two pocket phones in a laboratory (`robust-dr`), or a
    pocket phone on a closed path of straight legs (`psp-I`) or with a circle (`psp-II`). Of the keys of a population,
    only `number` and `seed` apply."""
    presets: tuple[str, ...] = ()
    """Names of simulated walks. Of the keys of a population, only `seed` applies."""
    repeats: Count = 1
    """Number of times that each preset is walked, every time with other sensor errors."""
    truth_every_s: Annotated[float, Ge(0.1), Le(600.0)] = 5.0
    """Time between the true positions that score the tracks and are given as fixes, s."""


@params
class DataParams:
    """Walks of the experiment: one of `suite`, `recordings` and `simulated`."""

    suite: str | None = None
    """Name of a benchmark suite, whose metrics are computed."""
    recordings: tuple[str, ...] = ()
    """Patterns, such as `office/**/*.csv`, of recordings that bring their own ground truth."""
    simulated: SimulatedParams | None = None
    """Simulated walks."""
    folder: str = "."
    """Folder of the suite or the recordings, relative to the experiment file."""
    only: tuple[str, ...] = ()
    """Patterns of the names of the walks to keep."""
    limit: Count | None = None
    """Number of walks to keep, from the first one on."""


@params
class FixesParams:
    """True positions that the estimators get as fixes."""

    protocol: FixesProtocol = "none"
    """The protocol "heldout" gives the true positions number 1, 4, 7, … and the last one, and the others judge the
    track; "every" does so with `every` and `sigma_m`; "none" gives none."""
    every: Annotated[int, Ge(2), Le(100_000)] = EVERY
    """With the protocol "every": each so-many-th true position is given."""
    sigma_m: Annotated[float, Gt(0.0), Le(100.0)] = WAYPOINT_SIGMA_M
    """With the protocol "every": standard deviation of a fix per axis, m. The fixes of a simulated walk get an error
    of that size, drawn from the seed."""


@params
class ExperimentConfig:
    """A comparison of variants of the settings on many walks."""

    data: DataParams
    """Walks."""
    title: str = ""
    """Title of the report; the name of the file if empty."""
    settings_file: str | None = None
    """Settings file that all variants begin with, relative to the experiment file."""
    settings: dict[str, Any] = field(default_factory=dict)
    """Settings of all variants, on top of `settings_file`; sections or dotted keys such as `steps.detector`."""
    variants: dict[str, dict[str, Any] | None] = field(default_factory=dict)
    """Name of a variant -> its own settings; `settings_file` is allowed there, too."""
    sweep: dict[str, tuple[Any, ...]] = field(default_factory=dict)
    """Dotted key -> values; every variant is run with every combination."""
    fixes: FixesParams = FixesParams()
    """True positions that the estimators get as fixes."""
    metrics: tuple[str, ...] = ()
    """Metrics in the results; all that there are if none is named."""
    group_by: tuple[str, ...] = ()
    """Keys of the walks by which tables are divided."""
    seed: Annotated[int, Ge(0), Le(2**32)] = 0
    """Seed of everything random."""
