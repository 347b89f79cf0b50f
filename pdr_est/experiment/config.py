"""What an experiment file may hold, section by section."""

from dataclasses import field
from typing import Annotated, Any, Literal

from annotated_types import Ge, Gt, Le

from pdr_est.evaluate.held_out_fixes import EVERY, WAYPOINT_SIGMA_M
from pdr_est.params import params
from pdr_est.simulate.people.population import PopulationParams

Count = Annotated[int, Ge(1), Le(1_000_000)]
Protocol = Literal["none", "heldout", "every"]
Series = Literal["robust-dr", "psp-I", "psp-II"]


@params
class SimulatedParams(PopulationParams):
    """Walks whose truth is exact: those of a series or named ones if there are any, else a population of people in
    corridors.

    series: the walks of papers' experiments, `number` of each: two pocket phones in a laboratory (`robust-dr`), a
    pocket phone on a closed path of straight legs (`psp-I`) or with a circle (`psp-II`). presets: names of simulated
    walks. Of the keys of a population, only `number` and `seed` apply to a series, and only `seed` to presets.
    repeats: how often each preset is walked, every time with other errors of the sensors. truth_every_s: the distance
    of the true positions that score the tracks and serve as fixes.
    """

    series: tuple[Series, ...] = ()
    presets: tuple[str, ...] = ()
    repeats: Count = 1
    truth_every_s: Annotated[float, Ge(0.1), Le(600.0)] = 5.0


@params
class DataParams:
    """The walks: one of `suite`, `recordings` and `simulated`.

    suite: name of a benchmark suite, whose metrics are taken. recordings: patterns such as `office/**/*.csv` of
    recordings that bring their own truth. folder: where both lie, relative to the experiment file. only: patterns of
    the names of the walks that are taken. limit: only the first so many of them.
    """

    suite: str | None = None
    recordings: tuple[str, ...] = ()
    simulated: SimulatedParams | None = None
    folder: str = "."
    only: tuple[str, ...] = ()
    limit: Count | None = None


@params
class FixesParams:
    """Known positions that the estimators get. protocol: "none"; "heldout" gives truth points number 1, 4, 7, … and
    the last and judges by the others; "every" does so with each so-manyth and a sigma of one's own.

    sigma_m: of a fix, per axis. Positions of a simulated walk get an error of that size, from the seed.
    """

    protocol: Protocol = "none"
    every: Annotated[int, Ge(2), Le(100_000)] = EVERY
    sigma_m: Annotated[float, Gt(0.0), Le(100.0)] = WAYPOINT_SIGMA_M


@params
class ExperimentConfig:
    """A comparison of variants on walks.

    settings_file: settings that all variants begin with. settings: more of them. variants: name -> what is different
    in it, sections or dotted keys such as `steps.detector`; `settings_file` is allowed there, too. sweep: dotted key
    -> values; every variant is run with every combination. metrics: all that there are if none is named. group_by:
    keys of the walks that tables are split by.
    """

    data: DataParams
    title: str = ""
    settings_file: str | None = None
    settings: dict[str, Any] = field(default_factory=dict)
    variants: dict[str, dict[str, Any] | None] = field(default_factory=dict)
    sweep: dict[str, tuple[Any, ...]] = field(default_factory=dict)
    fixes: FixesParams = FixesParams()
    metrics: tuple[str, ...] = ()
    group_by: tuple[str, ...] = ()
    seed: Annotated[int, Ge(0), Le(2**32)] = 0
