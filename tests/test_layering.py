"""Imports run one way through the package, and its modules and functions stay small."""

import ast
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest
from package_sources import PACKAGE as ROOT
from package_sources import REPOSITORY, package_trees

PACKAGE = ROOT.name

# A part may import what stands in an earlier group, and itself; never its neighbours in the same group. The longest
# name that fits a module places it.
ORDER: list[set[str]] = [
    {"errors", "frames", "stage", "label_runs", "records", "module_loading"},
    {"params", "output"},
    {"parts"},
    {"types"},
    # The five wings, which never see each other. Inside a wing the same rule holds.
    {
        "io.text",
        "clock_sync",
        "front_end.signal",
        "estimators.blas_threads",
        "estimators.common",
        "estimators.spec",
        "simulate",
    },
    {"estimators.reckoned_poses"},
    {
        "io.conversion",
        "front_end.attitude",
        "estimators.kalman",
        "estimators.fix_checks",
        "estimators.pose_chains",
    },
    {"io.tables"},
    {"io.side_tables", "front_end.mode", "estimators.dead_reckoning", "estimators.person", "estimators.factor_graph"},
    {
        "io.formats",
        "io.writers",
        "front_end.steps",
        "estimators.fixed_lag",
        "estimators.robust_dr",
        "estimators.heading_chain",
        "estimators.particle",
    },
    {"io.floor_plans"},
    {"io", "front_end.gait", "estimators"},
    {"front_end.step_length", "front_end.heading", "front_end.height", "front_end.step_noise"},
    {"front_end.odometry"},
    {"front_end"},
    {"preprocessing", "evaluate"},
    {"config"},
    {"pipeline"},
    {"public_api"},
    {"online", "calibration", "training", "testing"},
    {"report"},
    {"live"},
    {"experiment", "performance"},
    {"cli"},
    {"__main__"},
]
WINGS = ("io", "clock_sync", "front_end", "estimators", "simulate")
FACADE_HIDES = {"cli", "__main__"}  # what pdr_est/__init__.py must not import
# Heavy or replaceable libraries, and the only places that know them.
LIBRARIES = {
    "gtsam": ("estimators.factor_graph", "performance.smoothing"),
    "filterpy": ("estimators.kalman",),
    "sklearn": ("front_end.gait",),
    "vqf": ("front_end.attitude", "performance.yardsticks"),
    "pygeomag": ("front_end.heading.north",),
    # A track gives data frames and drawings of itself; both libraries are imported at use.
    "polars": ("io", "types.track", "types.track_output"),
    "matplotlib": ("report", "types.track", "types.track_output"),
    "shapely": ("io.floor_plans",),
    "skimage": ("io.floor_plans",),
    "jinja2": ("report",),
    "click": ("cli",),
    "starlette": ("live",),
    "uvicorn": ("live",),
    "websockets": ("live",),
    "segno": ("live",),
    "cryptography": ("live",),
}
MOST_LINES, MOST_FUNCTION_LINES = 300, 60
MOST_LINES_OF_THE_TOP = 110  # pipeline/__init__.py reads as the algorithm
MOST_FILES = 14


@dataclass(frozen=True)
class Import:
    """One imported module and where. module, name: dotted, those of this package without `pdr_est.`."""

    importer: str
    line: int
    name: str


def module_name(path: str) -> str:
    """Name the module of a file below the package by dots; the facade has an empty name."""
    parts = Path(path).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_name(path.relative_to(ROOT).as_posix()): path for path in sorted(ROOT.rglob("*.py"))}


@cache
def trees() -> dict[str, ast.Module]:
    """Syntax trees of the package by dotted module name."""
    return {module_name(path): tree for path, tree in package_trees().items()}


def imported(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Every dotted name that a module imports anywhere, functions included; `from a import b` gives a.b."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"line {node.lineno}: relative import: write the full name"
            yield from ((node.lineno, f"{node.module}.{alias.name}") for alias in node.names)


def within(module: str, part: str) -> bool:
    return module == part or module.startswith(f"{part}.")


@cache
def imports() -> tuple[Import, ...]:
    return tuple(Import(module, line, name) for module, tree in trees().items() for line, name in imported(tree))


@cache
def inner_imports() -> tuple[Import, ...]:
    """Imports of the package's own modules."""
    return tuple(
        Import(item.importer, item.line, item.name.removeprefix(PACKAGE).removeprefix("."))
        for item in imports()
        if within(item.name, PACKAGE)
    )


def part_of(module: str) -> str | None:
    """Name the part of the package that a module belongs to; None for a module that nobody has placed yet."""
    return max((part for group in ORDER for part in group if within(module, part)), key=len, default=None)


def rank(module: str) -> int | None:
    """Find the position of a module in the one-way order."""
    part = part_of(module)
    return next((i for i, group in enumerate(ORDER) if part in group), None)


def wing_of(module: str) -> str | None:
    return next((wing for wing in WINGS if within(module, wing)), None)


def test_every_module_has_a_place_in_the_order() -> None:
    assert [name for name in MODULES if rank(name) is None and name != ""] == [], "place these modules in ORDER"


def test_imports_run_one_way() -> None:
    wrong = [f"{item.importer}:{item.line} imports {item.name}" for item in inner_imports() if not allowed(item)]
    assert wrong == []


def allowed(item: Import) -> bool:
    if item.importer == "":
        return not any(within(item.name, hidden) for hidden in FACADE_HIDES)
    importer, target = rank(item.importer), rank(item.name)
    if item.name == "__version__":  # all that may be had through the facade, by what the facade does not import
        return importer is not None and importer >= len(ORDER) - 3
    if importer is None or target is None:
        return False
    from_wing, to_wing = wing_of(item.importer), wing_of(item.name)
    if from_wing and to_wing and from_wing != to_wing:
        return False
    return target < importer or part_of(item.importer) == part_of(item.name)


def test_the_order_is_noticed_when_broken() -> None:
    assert not allowed(Import("io.formats.datasets.ilc20", 1, "front_end.attitude.VqfAttitude"))
    assert not allowed(Import("front_end.step_length", 1, "front_end.heading.step_yaw.StepYaw"))
    assert not allowed(Import("types.steps", 1, "io.formats.registry.read"))
    assert not allowed(Import("pipeline", 1, "newcomer"))
    assert not allowed(Import("pipeline", 1, "__version__"))
    assert not allowed(Import("cli.smooth", 1, ""))
    assert not allowed(Import("cli.smooth", 1, "smooth"))
    assert not allowed(Import("", 1, "cli.main"))
    assert allowed(Import("cli.smooth", 1, "pipeline"))
    assert allowed(Import("io.formats.datasets.ilc20", 1, "io.text.container.Source"))


@pytest.mark.parametrize("wing", WINGS)
def test_wings_never_see_each_other(wing: str) -> None:
    others = [other for other in WINGS if other != wing]
    seen = [
        item for item in inner_imports() if within(item.importer, wing) and any(within(item.name, o) for o in others)
    ]
    assert seen == []


def test_no_folder_is_crowded() -> None:
    files = Counter(path.parent for path in MODULES.values() if path.name != "__init__.py")
    crowded = {str(folder.relative_to(REPOSITORY)): n for folder, n in files.items() if n > MOST_FILES}
    assert crowded == {}


@pytest.mark.parametrize("library", LIBRARIES)
def test_a_library_is_known_in_few_places(library: str) -> None:
    users = {item.importer for item in imports() if within(item.name, library)}
    assert {user for user in users if not any(within(user, place) for place in LIBRARIES[library])} == set()


def test_the_package_imports_neither_experiments_nor_tests() -> None:
    outside = ("experiments", "tests", "conftest", "pytest", "hypothesis")
    assert [item for item in imports() if any(within(item.name, name) for name in outside)] == []


def test_modules_are_small() -> None:
    lines = {name: path.read_text(encoding="utf-8").count("\n") for name, path in MODULES.items()}
    assert {name: count for name, count in lines.items() if count >= MOST_LINES} == {}
    assert lines["pipeline"] <= MOST_LINES_OF_THE_TOP


def test_functions_are_small() -> None:
    long = {
        f"{name}.{node.name}": length
        for name, tree in trees().items()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        if (length := (node.end_lineno or 0) - node.lineno + 1) >= MOST_FUNCTION_LINES
    }
    assert long == {}


def test_only_the_command_line_prints() -> None:
    printing = [
        f"{name}:{node.lineno}"
        for name, tree in trees().items()
        if not within(name, "cli")
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"
    ]
    assert printing == []


def test_no_module_is_a_drawer_for_everything() -> None:
    drawers = {"utils", "util", "helpers", "misc"}
    assert [name for name in MODULES if drawers & set(name.split("."))] == []
