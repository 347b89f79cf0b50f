"""The scripts in experiments/ import each other as those beside them, as `python experiments/NAME.py` does."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "experiments"))
