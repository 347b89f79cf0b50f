"""The scripts of experiments/ import only what the package has: most of them run too seldom to notice."""

import ast
from functools import cache
from pathlib import Path

import pytest
from package_sources import PACKAGE, REPOSITORY

SCRIPTS = sorted((REPOSITORY / "experiments").glob("*.py"))


@cache
def names_in(module: str) -> set[str]:
    """Names that a module of the package defines, imports or loads when they are asked for, and its submodules."""
    path = PACKAGE.parent.joinpath(*module.split("."))
    file = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    names = {one.stem for one in path.glob("*") if one.is_dir() or one.suffix == ".py"}
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, ast.ImportFrom):
            names |= {one.asname or one.name for one in node.names}
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            names.add(node.value)  # as in the table of names that `pdr_est` loads
    return names


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_scripts_import_what_there_is(script: Path) -> None:
    for node in ast.walk(ast.parse(script.read_text(encoding="utf-8"))):
        module = node.module or "" if isinstance(node, ast.ImportFrom) else ""
        if module.split(".")[0] == PACKAGE.name:
            assert {one.name for one in node.names} <= names_in(module), module
