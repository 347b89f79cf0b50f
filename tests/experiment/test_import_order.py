"""Imports run one way through the parts of `experiment`, which has no circle and does not know `performance`."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

import pdr_est

PACKAGE = Path(pdr_est.__file__).parent


def imported_names(file: Path) -> set[str]:
    """Return the dotted names that a file imports from this package, without `pdr_est.`."""
    nodes = ast.walk(ast.parse(file.read_text(encoding="utf-8")))
    lines = (node for node in nodes if isinstance(node, ast.ImportFrom) and str(node.module).startswith("pdr_est."))
    return {f"{line.module}.{alias.name}".removeprefix("pdr_est.") for line in lines for alias in line.names}


def test_parts_of_experiment_import_one_way() -> None:
    graph: dict[str, set[str]] = {}
    for file in (PACKAGE / "experiment").rglob("*.py"):
        part = file.relative_to(PACKAGE / "experiment").with_suffix("").parts[0]
        own = {name for name in imported_names(file) if name.startswith("experiment.")}
        graph.setdefault(part, set()).update({name.split(".")[1] for name in own} - {part})
    order = list(TopologicalSorter(graph).static_order())  # raises CycleError
    assert order.index("config") < order.index("scoring") < order.index("results") < order.index("runners")


def test_experiment_and_performance_do_not_know_each_other() -> None:
    for part, other in (("experiment", "performance"), ("performance", "experiment")):
        for file in (PACKAGE / part).rglob("*.py"):
            assert not {name for name in imported_names(file) if name.startswith(f"{other}.")}, file
