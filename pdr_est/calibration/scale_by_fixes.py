"""The length scale that one walk shows by its position fixes, apart from what is expected of people.

The smoother's posterior of the logarithm of the scale is the product of a normal prior and of what the measurements
tell. Their quotient is the observation of the walk: its information is that of the posterior less that of the prior,
and the prior enters again once for all walks, in `fit_calibration`. The observation is therefore the same whatever
was known of the walker before.

The prior that is divided out is wider than that of people in general: the comparison of fixes with steps
(`estimators.fix_checks`) widens a narrower one by itself where a walk shows an unusual scale, and the prior that was
used would then not be known here. Over the 84 walks of the suites `walks` and `ilc20` where the fixes tell the scale
within 10 %, priors of 0.11 and 1.1 give quotients that differ by 0.02 at most.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.calibration.step_length_fit import (
    CalibrationSteps,
    NotLearnt,
    ScaleObservation,
    mean_length_m,
    observe_scale,
    refuse_scale,
)
from pdr_est.config import Config
from pdr_est.errors import ConfigError, RecordingError
from pdr_est.estimators.fix_checks import SIGMA_UNUSUAL_SCALE
from pdr_est.front_end.step_length import WalkerParams
from pdr_est.front_end.step_length.walker import MOST_SCALE
from pdr_est.pipeline import DeviceWalk, estimate_tracks
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import PositionFix
from pdr_est.types.track import Track

LARGEST_SIGMA = 0.2
"""Standard deviation of the logarithm of a walk's scale from which the walk hardly determines it; ours."""

_DISAGREEMENTS = (FindingKind.FIXES, FindingKind.STEPS)
_SURE_SIGMAS = 2.0  # by which a scale lies beyond those of people before it is refused
_NO_FIXES = NotLearnt("no fixes that tell the length of the way; give --fixes or --distance", doubtful=False)
_LEAST_INFORMATION = 1e-3  # of a measurement over that of the prior; below it rounding decides


@dataclass(frozen=True)
class LogScale:
    """Normal distribution of the logarithm of a length scale.

    Attributes
    ----------
    mean : float
        Mean.
    sigma : float
        Standard deviation.
    """

    mean: float
    sigma: float

    def without(self, prior: "LogScale") -> "LogScale | None":
        """Divide out a prior; None if no more than the prior is left, so that nothing was measured."""
        information = self.sigma**-2 - prior.sigma**-2
        if information <= _LEAST_INFORMATION * prior.sigma**-2:
            return None
        mean = (self.mean * self.sigma**-2 - prior.mean * prior.sigma**-2) / information
        return LogScale(mean, information**-0.5)


def observe_fixes(
    walks: Sequence[DeviceWalk], config: Config, fixes: Sequence[PositionFix], place: str
) -> ScaleObservation:
    """Observe the scale of a walk whose fixes should determine it.

    Raises
    ------
    ConfigError
        For an estimator that does not use fixes.
    RecordingError
        Without a step, if the fixes hardly determine the scale or disagree with the steps or each other, or if it is
        out of range. Errors of `pipeline.estimate_tracks` are passed on.
    """
    seen = observe_any_fixes(walks, config, fixes, place)
    if isinstance(seen, NotLearnt) and seen.doubtful:
        raise RecordingError(f"{place}: {seen.reason}")
    if isinstance(seen, NotLearnt) or seen.sigma > LARGEST_SIGMA:
        raise RecordingError(
            f"{place}: its fixes hardly determine the step length: give fixes farther apart, or the distance"
        )
    return seen


def observe_any_fixes(
    walks: Sequence[DeviceWalk], config: Config, fixes: Sequence[PositionFix], place: str
) -> ScaleObservation | NotLearnt:
    """Observe the scale of a walk as far as its fixes tell it.

    A walk that ends where it began does so at every scale; the closure tells something together with fixes only.
    Fixes that disagree with the steps or with each other teach nothing: what is wrong about them may be the scale.

    Parameters
    ----------
    walks : sequence of DeviceWalk
        Devices of the walk, with steps whose lengths are those of the model, without personal constants.
    config : Config
        Settings of the estimator.
    fixes : sequence of PositionFix
        Known positions.
    place : str
        Name of the walk in messages.

    Returns
    -------
    ScaleObservation or NotLearnt
        The reason if the fixes tell nothing about the scale, as without any, or with a single one and an unknown
        start, or if they disagree.

    Raises
    ------
    ConfigError
        For an estimator that does not use fixes.
    RecordingError
        Without a step, or if the scale is certainly out of range. Errors of `pipeline.estimate_tracks` are
        passed on.
    """
    if not fixes:
        return _NO_FIXES
    if not config.estimator.make().spec.uses_fixes:
        raise ConfigError(
            f"estimator.name = {config.estimator.name}: makes no use of fixes: choose ekf or factor-graph, or give "
            "the distance"
        )
    steps = [CalibrationSteps.from_steps(walk.steps) for walk in walks]
    mean_length_m(steps, place)
    prior = LogScale(0.0, max(SIGMA_UNUSUAL_SCALE, config.odometry.sigma_length_scale))
    wide = replace(config, odometry=replace(config.odometry, sigma_length_scale=prior.sigma))
    tracks = [estimate_tracks([walk], wide, fixes) for walk in walks]
    doubts = [finding for track in tracks for finding in track.findings if _disagrees(finding)]
    seen = [_log_scale_of(track).without(prior) for track in tracks]
    told = [one for one in seen if one is not None]
    if not told:
        return _disagreement(doubts) if doubts else _NO_FIXES
    # The devices are carried along one way past the same fixes: together they know little more than one.
    mean, sigma = float(np.mean([one.mean for one in told])), max(one.sigma for one in told)
    if abs(mean) - _SURE_SIGMAS * sigma > math.log(MOST_SCALE):
        scale = math.exp(mean)
        refuse_scale(scale, place, f"the fixes make the steps {scale:.2f} times as long")
    return _disagreement(doubts) if doubts else replace(observe_scale(steps, 1.0, sigma), log_ratio=mean)


def without_personal_constants(config: Config) -> Config:
    """Remove from a configuration what is known of the walker's own step length."""
    body = WalkerParams(height_m=config.walker.height_m, gender=config.walker.gender)
    usual = replace(config.odometry, sigma_length_scale=Config().odometry.sigma_length_scale)
    return replace(config, walker=body, odometry=usual)


def _disagrees(finding: Finding) -> bool:
    return finding.doubtful and finding.kind in _DISAGREEMENTS


def _disagreement(doubts: Sequence[Finding]) -> NotLearnt:
    return NotLearnt(f"its fixes disagree with its steps or with each other ({doubts[0].words}): correct the fixes")


def _log_scale_of(track: Track) -> LogScale:
    """Return the posterior of the smoother."""
    return LogScale(math.log(track.length_scale), track.sigma_length_scale / track.length_scale)
