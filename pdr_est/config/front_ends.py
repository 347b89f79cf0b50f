"""Front ends by name: settings of all its stages that belong together."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from pdr_est.config.loading import config_with
from pdr_est.config.records import Config

TEXTBOOK: Mapping[str, Any] = MappingProxyType(
    {
        "attitude.source": "vqf",
        "mode.method": "fixed",
        "mode.fixed": "HOLDING",
        "steps.detector": "magnitude-peaks",
        "gait.method": "none",
        "step_length.model": "weinberg",
        "step_length.weinberg_k2": 0.51,
        "heading.method": "step-yaw",
    }
)
"""The chain that textbooks describe, a yardstick for every other one: peaks of the acceleration's magnitude,
Weinberg's step length with one constant for everybody, and the yaw of VQF. It recognises no carrying mode; "fixed"
only names one. `configs/settings/textbook.yaml` holds the same settings.

The constant makes the mean logarithm of `length_ratio` zero over the suites ilc20, oxiod and ipin2023, a suite being
one vote; it is 0.54, 0.49 and 0.50 without the first, the second and the third of them. The walks of other suites
took no part.
"""

OWN = "own"
"""Name of a front end that is none of `FRONT_ENDS`."""


def _value_at(config: Config, key: str) -> Any:
    section, _, name = key.partition(".")
    return getattr(getattr(config, section), name)


FRONT_ENDS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        "default": MappingProxyType({key: _value_at(Config(), key) for key in TEXTBOOK}),
        "textbook": TEXTBOOK,
    }
)
"""Name -> settings by dotted key."""


def front_end_of(config: Config) -> str:
    """Return the name of the front end of a configuration, `OWN` if it has no name.

    Settings that no named front end changes, such as the parameters of a stage, make no difference.
    """
    for name, settings in FRONT_ENDS.items():
        if all(_value_at(config, key) == value for key, value in settings.items()):
            return name
    return OWN


def with_front_end(config: Config, name: str, option: str) -> Config:
    """Return a configuration with a front end of `FRONT_ENDS`; `OWN` leaves it as it is.

    Raises
    ------
    ConfigError
        For settings that contradict others; the message begins with the option.
    """
    return config if name == OWN else config_with(config, dict(FRONT_ENDS[name]), option)
