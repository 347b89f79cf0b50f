"""Benchmark suites, one module each: on public data sets, and on the surveyed walks of anybody."""

from pdr_est.errors import ConfigError
from pdr_est.experiment.suite import Suite
from pdr_est.experiment.suites import (
    gait,
    ilc20,
    ipin2023,
    known_distance,
    motionsense,
    oxford_steps,
    oxiod,
    phone_gps,
    stride_length,
    walks,
    weallwalk,
)

SUITES: tuple[Suite, ...] = (
    ilc20.SUITE,
    oxiod.SUITE,
    ipin2023.SUITE,
    oxford_steps.SUITE,
    weallwalk.SUITE,
    known_distance.SUITE,
    stride_length.SUITE,
    phone_gps.SUITE,
    motionsense.SUITE,
    gait.SUITE,
    walks.SUITE,
)


def suite_named(name: str) -> Suite:
    """Return the suite of that name.

    Raises
    ------
    ConfigError
        For an unknown name; the message lists the known ones.
    """
    for suite in SUITES:
        if suite.name == name:
            return suite
    raise ConfigError(f"unknown benchmark suite {name!r}: choose one of {', '.join(suite.name for suite in SUITES)}")
