"""Read tables of Core Motion by any app of iPhone or Apple Watch: userAcceleration, gravity, rotationRate.

Both accelerations are in g and point down at rest; their sum negated is the specific force.
"""

import re

from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.named_tables import members_marked, read_named_table
from pdr_est.io.text.container import Source
from pdr_est.types.recording import Recording

NAME = "Core Motion table"

_MARK = re.compile(
    rb"^(?=[^\n]*user_?acceleration)(?=[^\n]*gravity)(?=[^\n]*(?:time|date|elapsed))", re.IGNORECASE | re.MULTILINE
)


def sniff(source: Source) -> bool:
    """Tell whether a header names a time, user acceleration and gravity."""
    return bool(members_marked(source, _MARK))


def read_source(source: Source) -> Recording:
    """Read the walk of a table.

    Raises
    ------
    RecordingError
        For several tables, and when no motion sensor has values.
    """
    device = RawDevice({}, platform="ios", sign=-1.0, sign_reason="Core Motion's sign")
    return read_named_table(source, members_marked(source, _MARK), NAME, device)
