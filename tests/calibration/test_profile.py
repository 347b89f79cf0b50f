"""A walker's profile: the exact posterior, order and repetition of walks, and which configurations it fits."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from profile_notes import NOTE

from pdr_est.calibration.profile import (
    LearntWalk,
    Profile,
    apply_profile,
    check_model_matches,
    check_profile_matches,
    new_profile,
)
from pdr_est.calibration.profile_file import profile_to_yaml
from pdr_est.calibration.step_length_fit import SIGMA_EXPONENT, SIGMA_LOG_CADENCE, SIGMA_LOG_SCALE, SIGMA_WALK
from pdr_est.config import Config, config_to_dict
from pdr_est.errors import ConfigError, RecordingError
from pdr_est.front_end.step_length import LAW_OF_AUTO, WalkerParams
from pdr_est.front_end.steps import StepsParams

CONFIG = Config(
    step_length=NOTE.step_length,
    steps=StepsParams(detector="local-variance"),
    walker=WalkerParams(height_m=1.6, gender="female"),
)


def walk_of(number: int, log_ratio: float = 0.1, sigma: float = 0.03, log_cadence: float = 0.6) -> LearntWalk:
    sha256 = f"{number:064x}"
    return LearntWalk(sha256=sha256, name="w", log_ratio=log_ratio, sigma=sigma, log_cadence=log_cadence)


PROFILE = Profile(note=NOTE).with_walk(walk_of(1)).with_walk(walk_of(2, 0.05, 0.0))

WALKS = st.lists(
    st.builds(
        walk_of,
        st.integers(0, 2**200),
        st.floats(-0.2, 0.2),
        st.sampled_from([0.0, 0.01, 0.03, 0.1, 0.5]),
        st.floats(-0.3, 0.9),
    ),
    min_size=1,
    max_size=6,
    unique_by=lambda walk: walk.sha256,
)


def test_the_posterior_is_the_product_of_normal_distributions() -> None:
    """Walks of one cadence, by hand: prior, and each walk with its own deviation and its error."""
    first, second = SIGMA_WALK**2 + 0.03**2, SIGMA_WALK**2
    variance = 1.0 / (SIGMA_LOG_SCALE**-2 + 1.0 / first + 1.0 / second)
    assert PROFILE.walker.length_scale == pytest.approx(math.exp(variance * (0.1 / first + 0.05 / second)))
    next_walk = variance + SIGMA_WALK**2 + (SIGMA_EXPONENT * SIGMA_LOG_CADENCE) ** 2
    assert PROFILE.sigma_length_scale == pytest.approx(math.sqrt(next_walk))


def test_without_walks_nothing_is_known_of_the_walker() -> None:
    profile = new_profile(CONFIG)
    assert apply_profile(CONFIG, profile) == CONFIG
    assert profile.posterior is None
    assert profile.to_dict()["learnt"] == {"walks": 0, "sigma_next_walk": SIGMA_LOG_SCALE}


@settings(max_examples=60, deadline=None)
@given(walks=WALKS, data=st.data())
def test_the_order_of_learning_does_not_matter(walks: list[LearntWalk], data: st.DataObject) -> None:
    one, other = Profile(note=NOTE), Profile(note=NOTE)
    for walk in walks:
        one = one.with_walk(walk)
    for walk in data.draw(st.permutations(walks)):
        other = other.with_walk(walk)
    assert one == other
    assert profile_to_yaml(one) == profile_to_yaml(other)


@settings(max_examples=60, deadline=None)
@given(walks=WALKS)
def test_a_walk_is_learnt_once_and_can_be_left_out(walks: list[LearntWalk]) -> None:
    profile = Profile(note=NOTE)
    for walk in walks[1:]:
        profile = profile.with_walk(walk)
    first = walks[0]
    assert profile.known(first.checksums) == ()
    learnt = profile.with_walk(first)
    assert learnt.with_walk(first) is learnt
    assert learnt.without(first.checksums).walks == profile.walks
    changed = learnt.with_walk(replace(first, log_ratio=first.log_ratio + 0.1))
    assert len(changed.walks) == len(learnt.walks)
    assert changed.walker.length_scale > learnt.walker.length_scale


def test_a_walk_by_two_phones_and_by_one_of_them_counts_once() -> None:
    one, other = f"{1:064x}", f"{2:064x}"
    pair = replace(walk_of(7, log_ratio=-0.1), devices=(one, other))
    alone, both = Profile(note=NOTE).with_walk(walk_of(1)), Profile(note=NOTE).with_walk(pair)
    assert alone.known(pair.checksums) == alone.walks
    assert alone.with_walk(pair) == both
    assert both.with_walk(walk_of(1)) == alone
    assert both.without(walk_of(2).checksums).walks == ()
    assert len(both.with_walk(walk_of(3)).walks) == 2


def test_a_walk_that_tells_nearly_nothing_changes_nearly_nothing() -> None:
    vague = PROFILE.with_walk(walk_of(3, log_ratio=-2.0, sigma=1e3, log_cadence=-0.3))
    assert vague.walker.length_scale == pytest.approx(PROFILE.walker.length_scale, rel=1e-4)
    assert vague.walker.reference_cadence_hz == pytest.approx(PROFILE.walker.reference_cadence_hz, rel=1e-4)
    assert vague.sigma_length_scale == pytest.approx(PROFILE.sigma_length_scale, rel=1e-4)


def test_constants_that_nobody_has_are_refused() -> None:
    slow, quick = walk_of(4, 0.5, 0.0, 0.0), walk_of(5, -0.5, 0.0, 0.5)
    with pytest.raises(RecordingError, match="w: with this walk the profile would get constants that nobody has"):
        Profile(note=NOTE).with_walk(slow).with_walk(quick)


def test_each_walk_stands_once_in_order() -> None:
    with pytest.raises(ConfigError, match="walks: must be in order of sha256, each walk once"):
        Profile(note=NOTE, walks=(walk_of(1), walk_of(1)))


def test_it_sets_the_walker_and_the_uncertainty_and_nothing_else() -> None:
    config = apply_profile(CONFIG, PROFILE)
    assert config.walker == PROFILE.walker
    assert config.odometry.sigma_length_scale == PROFILE.sigma_length_scale < SIGMA_LOG_SCALE
    back = replace(
        config,
        walker=CONFIG.walker,
        odometry=replace(config.odometry, sigma_length_scale=CONFIG.odometry.sigma_length_scale),
    )
    assert config_to_dict(back) == config_to_dict(CONFIG)


@pytest.mark.parametrize(
    ("section", "key", "value", "message"),
    [
        ("step_length", "model", "static", "made for step_length.model = weinberg, but static is set"),
        ("step_length", "model", "auto", f"made for step_length.model = weinberg, but {LAW_OF_AUTO} \\(for auto\\)"),
        ("step_length", "weinberg_k2", 0.48, "made for step_length.weinberg_k2 = 0.5, but 0.48 is set"),
        ("steps", "detector", "auto", "made for steps.detector = local-variance, but auto is set"),
        ("walker", "height_m", 1.9, "made for walker.height_m = 1.6, but 1.9 is set"),
        ("walker", "length_scale", 1.0, "made for walker.length_scale = .*, but 1.0 is set"),
        ("odometry", "sigma_length_scale", 0.11, "made for odometry.sigma_length_scale = .*, but 0.11 is set"),
    ],
)
def test_a_configuration_must_be_the_one_of_the_calibration(section, key, value, message) -> None:
    config = apply_profile(CONFIG, PROFILE)
    check_profile_matches(config, PROFILE, "p.yaml")
    other = replace(config, **{section: replace(getattr(config, section), **{key: value})})
    with pytest.raises(ConfigError, match=rf"p\.yaml: {message}.*set it like that"):
        check_profile_matches(other, PROFILE, "p.yaml")


def test_a_profile_of_an_earlier_default_does_not_fit_a_later_one() -> None:
    """The law that "auto" stood for is kept: its name alone would fit any later one."""
    profile = new_profile(Config())
    assert (profile.note.step_length.model, profile.note.law) == ("auto", LAW_OF_AUTO)
    check_model_matches(Config(), profile, "p.yaml")
    earlier = replace(profile, note=replace(profile.note, law="older"))
    with pytest.raises(ConfigError, match=f"made for step_length.model = older, but {LAW_OF_AUTO} .for auto. is set"):
        check_model_matches(Config(), earlier, "p.yaml")


def test_a_profile_is_smaller_in_doubt_than_people_in_general() -> None:
    sigmas = [Profile(note=NOTE).sigma_length_scale]
    profile = Profile(note=NOTE)
    for number in range(5):
        profile = profile.with_walk(walk_of(number))
        sigmas.append(profile.sigma_length_scale)
    assert np.all(np.diff(sigmas) < 0.0)
    assert sigmas[-1] > SIGMA_WALK
