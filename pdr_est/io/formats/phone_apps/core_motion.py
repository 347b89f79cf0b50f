"""Read tables of Core Motion by any app of iPhone or Apple Watch: userAcceleration, gravity, rotationRate.

Both accelerations are in g and point down at rest; their sum negated is the specific force.
"""

import re

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import NamedTableFormat

_MARK = re.compile(
    rb"^(?=[^\n]*user_?acceleration)(?=[^\n]*gravity)(?=[^\n]*(?:time|date|elapsed))", re.IGNORECASE | re.MULTILINE
)


def _device(_head: bytes) -> RawDevice:
    return RawDevice({}, platform="ios", sign=-1.0, sign_reason="Core Motion's sign")


FORMAT = NamedTableFormat("Core Motion table", _MARK, _device)
"""The format, for the registry."""
