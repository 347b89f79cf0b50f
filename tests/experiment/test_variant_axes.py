from dataclasses import replace
from pathlib import Path

import pytest

from pdr_est.config import Config, load_config
from pdr_est.errors import ConfigError
from pdr_est.experiment.variants.axes import (
    AXES,
    axis_named,
    comparison_from_options,
    comparison_on_axis,
    same_front_end,
)


@pytest.mark.parametrize("axis", AXES, ids=lambda axis: axis.name)
def test_each_value_of_an_axis_can_be_chosen_and_changes_nothing_else(axis):
    default = axis.value_in(Config())
    assert default in axis.values
    for name in axis.values:
        config = axis.with_value(Config(), name)
        assert axis.value_in(config) == name
        back = axis.with_value(config, default)
        assert axis.value_in(back) == default
        assert replace(back, estimator=Config().estimator) == Config()


def test_the_default_estimator_is_another_one_on_a_plan_and_a_chosen_one_is_not():
    default = comparison_from_options(Config(), {}).main
    assert (default.name, default.automatic_on_plan) == ("factor-graph", "particle")
    chosen = comparison_from_options(Config(), {"estimator": "factor-graph"}).main
    assert (chosen.name, chosen.automatic_on_plan) == ("factor-graph", None)
    every = comparison_from_options(Config(), {"estimator": "all"})
    assert every.main.name == "factor-graph"
    assert {variant.automatic_on_plan for variant in every.variants} == {None}


def test_the_textbook_front_end_is_that_of_its_file():
    file = Path(__file__).parents[2] / "configs/settings/textbook.yaml"
    assert axis_named("front-end").with_value(Config(), "textbook") == load_config(file)


def test_a_front_end_of_ones_own_has_no_name_and_stays_as_it_is():
    config = Config().replace({"steps.detector": "mmpdr"})
    (only,) = comparison_from_options(config, {}).variants
    assert (only.settings()["front-end"], only.config) == ("own", config)
    assert comparison_from_options(config, {"front-end": "default"}).main.config == Config()


def test_without_a_choice_the_configured_variant_runs_alone():
    config = Config().with_estimator("ekf")
    comparison = comparison_from_options(config, {})
    assert (comparison.axis, comparison.names) == ("estimator", ("ekf",))
    assert comparison.main.config == config


def test_a_single_choice_is_the_axis_that_is_shown():
    comparison = comparison_from_options(Config(), {"estimator": None, "detector": "mmpdr"})
    assert (comparison.axis, comparison.names) == ("detector", ("mmpdr",))
    settings = comparison.main.settings()
    assert (settings["estimator"], settings["detector"]) == ("factor-graph", "mmpdr")


@pytest.mark.parametrize("axis", AXES, ids=lambda axis: axis.name)
def test_all_compares_every_value_and_the_configured_one_is_the_main_one(axis):
    config = axis.with_value(Config(), axis.values[1])
    comparison = comparison_from_options(config, {axis.name: "all"})
    assert (comparison.axis, comparison.names, comparison.main.name) == (axis.name, axis.values, axis.values[1])
    assert [axis.value_in(variant.config) for variant in comparison.variants] == list(axis.values)


@pytest.mark.parametrize(
    ("every", "one", "name"), [("estimator", "detector", "mmpdr"), ("detector", "estimator", "ekf")]
)
def test_all_of_one_axis_with_one_value_of_the_other(every, one, name):
    comparison = comparison_from_options(Config(), {every: "all", one: name})
    assert comparison.axis == every
    assert {variant.settings()[one] for variant in comparison.variants} == {name}


def test_two_axes_at_once_are_refused():
    with pytest.raises(
        ConfigError, match="--estimator all and --detector all: only one setting is compared at a time"
    ):
        comparison_from_options(Config(), {"estimator": "all", "detector": "all"})


def test_unknown_names_are_refused():
    with pytest.raises(ConfigError, match="unknown axis 'colour': choose one of estimator, detector"):
        comparison_on_axis(Config(), "colour")
    with pytest.raises(ConfigError, match=r"--detector: steps\.detector = 'ear'"):
        comparison_on_axis(Config(), "detector", ("auto", "ear"))
    with pytest.raises(ConfigError, match="no detector to compare"):
        comparison_on_axis(Config(), "detector", ())


def test_a_value_outside_the_compared_ones_leaves_the_first_as_the_main_one():
    assert comparison_on_axis(Config(), "detector", ("mmpdr", "zero-crossing")).main.name == "mmpdr"


def test_only_the_estimator_leaves_the_front_end_as_it_is():
    config = Config()
    assert same_front_end(config, config.with_estimator("ekf"))
    (other,) = comparison_on_axis(config, "detector", ("mmpdr",)).variants
    assert not same_front_end(config, other.config)
