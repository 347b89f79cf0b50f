"""Which class of step was taken for which, over the walks of a suite that sorts steps into classes."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Confusion:
    """counts: true class -> label -> steps. shares: what follows from them, by name."""

    counts: Mapping[str, Mapping[str, int]]
    shares: Mapping[str, float]

    def to_dict(self) -> dict[str, Any]:
        """As it stands in the JSON document."""
        return {"counts": {true: dict(labels) for true, labels in self.counts.items()}, **self.shares}
