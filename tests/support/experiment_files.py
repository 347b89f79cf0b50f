"""Small experiment files for the tests."""

from pathlib import Path

SMALL = """\
data:
  simulated:
    number: 3
    people: 2
    duration_s: 45.0
    carrying: [[HOLDING], [POCKET]]
sweep:
  estimator.name: [dead-reckoning, ekf]
fixes:
  protocol: heldout
group_by: [carrying]
seed: 7
"""


def experiment_file(folder: Path, text: str = SMALL, name: str = "small.yaml") -> Path:
    """The text as a file."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path
