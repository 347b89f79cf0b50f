"""What tests of all parts share."""

import gc
import os
from pathlib import Path

import pytest

if "PYTEST_XDIST_WORKER" in os.environ:  # one thread a process: the processes share the cores already
    for library in ("OMP", "OPENBLAS", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")


def pytest_collection_finish() -> None:
    """Keep the garbage collector from visiting, in every test, the modules and tests that stay until the end."""
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Folder of the real recordings that the project is tuned on; the test is skipped where there is none."""
    beside_repo = Path(__file__).resolve().parents[1] / "../shared/data"
    folder = Path(os.environ.get("PDR_EST_DATA", beside_repo))
    if not folder.is_dir():
        pytest.skip(f"no real recordings in {folder}: set PDR_EST_DATA to their folder")
    return folder
