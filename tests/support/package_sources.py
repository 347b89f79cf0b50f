"""Source files of the package as syntax trees, parsed once a process and only when a test asks for them."""

import ast
import gc
from functools import cache
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
PACKAGE = REPOSITORY / "pdr_est"


@cache
def package_trees() -> dict[str, ast.Module]:
    """Trees by the path of their file below the package, such as "io/tables/header.py"."""
    trees = {
        path.relative_to(PACKAGE).as_posix(): ast.parse(path.read_text(encoding="utf-8"))
        for path in sorted(PACKAGE.rglob("*.py"))
    }
    gc.freeze()  # millions of nodes, which every full collection of the tests that follow would visit
    return trees
