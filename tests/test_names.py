"""Public names of the package are unique, docstrings do not begin as fragments, and every parameter has one."""

import ast
from collections import defaultdict
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "pdr_est"
MODULES = {str(path.relative_to(PACKAGE)): ast.parse(path.read_text("utf-8")) for path in PACKAGE.rglob("*.py")}
INTERFACES = {
    "sniff",
    "read_source",
    "read_chosen",
    "estimate",
}  # the same function of every format and of every estimator
FACADE = "public_api.py"  # passes on what others define
FRAGMENTS = ("Of ", "What ", "Whether ", "How ", "Where ", "Which ", "Whose ", "Those ", "That ")


def test_no_two_public_classes_or_functions_share_a_name() -> None:
    places = defaultdict(list)
    for module, tree in MODULES.items():
        for node in tree.body if module != FACADE else ():
            if isinstance(node, ast.ClassDef | ast.FunctionDef) and not node.name.startswith("_"):
                places[node.name].append(module)
    shared = {name: found for name, found in places.items() if len(found) > 1 and name not in INTERFACES}
    assert shared == {}


@pytest.mark.parametrize("module", sorted(MODULES))
def test_no_docstring_begins_as_a_fragment(module: str) -> None:
    nodes = [
        node
        for node in ast.walk(MODULES[module])
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
    ]
    openings = [(ast.get_docstring(node) or "").split("\n")[0] for node in nodes]
    found = [opening for opening in openings if opening.startswith(FRAGMENTS)]
    assert found == []


@pytest.mark.parametrize("module", sorted(MODULES))
def test_every_field_of_a_parameter_record_is_documented(module: str) -> None:
    bare = []
    for node in ast.walk(MODULES[module]):
        if isinstance(node, ast.ClassDef) and any(ast.unparse(item) == "params" for item in node.decorator_list):
            following = [*node.body[1:], None]
            bare += [
                f"{node.name}.{ast.unparse(field.target)}"
                for field, after in zip(node.body, following, strict=True)
                if isinstance(field, ast.AnnAssign)
                and not (isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant))
            ]
    assert bare == []
