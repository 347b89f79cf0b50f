"""Comparison of the fixes of a walk with its steps, before a smoother takes them.

Other parts use what this package names in `__all__`, and none of its modules.

* `check`: the top function, `check_fixes`.
* `section`: the fixes of a walk as a table, in sections that can be compared at once.
* `dead_reckoned_path`: the path of the steps alone and the covariance of its errors.
* `position_regression`: the Gaussian model that places this path through the fixes, with evidence and residuals.
* `outlier_weights`: the probability of each fix to be an outlier.
* `explanations`, `clock_shifts`, `bad_stretches`: what may be otherwise than stated.
* `remaining_doubt`: what the best explanation leaves open.
* `adjusted_fixes`, `fix_findings`: what the smoother gets, and what is told.
"""

from pdr_est.estimators.fix_checks.check import check_fixes
from pdr_est.estimators.fix_checks.dead_reckoned_path import DeadReckonedPath
from pdr_est.estimators.fix_checks.explanations import SIGMA_UNUSUAL_SCALE

__all__ = ["SIGMA_UNUSUAL_SCALE", "DeadReckonedPath", "check_fixes"]
