"""Whether samples have the form that the front end takes."""

import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.types.sensors import Channel, SensorBlock

_WIDTH = {channel: 4 if channel is Channel.ATTITUDE else 3 for channel in Channel}


def refuse_malformed(device: str, block: SensorBlock) -> None:
    """Raise EstimationError for a name or a block that nothing can be made of; single samples that are not finite or
    not in order of time are left out later, as in recordings."""
    if not isinstance(device, str) or not device:
        raise EstimationError(f"device {device!r}: give it a name, which is a text that is not empty")
    if not isinstance(block, SensorBlock):
        raise EstimationError(f"{device}: samples of type {type(block).__name__}: give a SensorBlock")
    if block.channel not in _WIDTH:
        raise EstimationError(f"{device}: channel {block.channel!r}: choose one of {', '.join(Channel)}")
    for name, values, dimensions in (("time_s", block.time_s, 1), ("values", block.values, 2)):
        if not isinstance(values, np.ndarray) or values.ndim != dimensions or values.dtype.kind not in "fiu":
            raise EstimationError(
                f"{device}, {block.channel}: {name} is {_words(values)}: give an array of numbers of "
                f"{dimensions} dimension{'s' * (dimensions > 1)}"
            )
    expected = (len(block.time_s), _WIDTH[Channel(block.channel)])
    if block.values.shape != expected:
        raise EstimationError(
            f"{device}, {block.channel}: values of shape {block.values.shape} at {len(block.time_s)} times: give the "
            f"shape {expected}, a row a sample"
        )


def _words(values: object) -> str:
    if isinstance(values, np.ndarray):
        return f"an array of shape {values.shape} of {values.dtype}"
    return f"a {type(values).__name__}"
