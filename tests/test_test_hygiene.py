"""Tests use public names of the package only, so that its insides can change without them."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).resolve().parent
PACKAGE = "pdr_est"
PATCHERS = ("setattr", "delattr", "getattr", "hasattr", "patch", "object")  # which take names as strings
NAMED_TUPLE = {"_replace", "_asdict", "_fields", "_make"}


def private(name: str) -> bool:
    """Tell whether a name is private: `_name`, but neither `__name__` nor `_protocol_`, such as `_repr_html_`."""
    return name.startswith("_") and not name.startswith("__") and not name.endswith("_") and name not in NAMED_TUPLE


def foreign_names(tree: ast.Module) -> set[str]:
    """Names that stand for something outside the package: imported from elsewhere, and a test class's own self."""
    names = {"self", "cls"}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {
                (alias.asname or alias.name).split(".")[0]
                for alias in node.names
                if alias.name.split(".")[0] != PACKAGE
            }
        elif isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] != PACKAGE:
            names |= {alias.asname or alias.name for alias in node.names}
    return names


def root_of(node: ast.expr) -> str:
    while isinstance(node, ast.Attribute | ast.Subscript | ast.Call):
        node = node.func if isinstance(node, ast.Call) else node.value
    return node.id if isinstance(node, ast.Name) else ""


def private_uses(source: str) -> Iterator[str]:
    """Yield every use of a private name of the package, with its line."""
    tree = ast.parse(source)
    foreign = foreign_names(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and private(node.attr) and root_of(node) not in foreign:
            yield f"{node.lineno}: {ast.unparse(node)}"
        elif isinstance(node, ast.Import | ast.ImportFrom):
            module = node.module if isinstance(node, ast.ImportFrom) else None
            for alias in node.names:
                parts = f"{module or ''}.{alias.name}".strip(".").split(".")
                if parts[0] == PACKAGE and any(private(part) for part in parts):
                    yield f"{node.lineno}: import {'.'.join(parts)}"
        elif isinstance(node, ast.Call) and ast.unparse(node.func).rsplit(".", 1)[-1] in PATCHERS:
            words = [
                item.value for item in node.args if isinstance(item, ast.Constant) and isinstance(item.value, str)
            ]
            if any(private(word.rsplit(".", 1)[-1]) for word in words[:1]):
                yield f"{node.lineno}: {ast.unparse(node)}"


def test_no_private_name_of_the_package_is_touched() -> None:
    files = {str(path.relative_to(TESTS)): path.read_text(encoding="utf-8") for path in TESTS.rglob("*.py")}
    assert {name: uses for name, source in files.items() if (uses := list(private_uses(source)))} == {}


@pytest.mark.parametrize(
    "source",
    [
        "from pdr_est.pipeline import _inner",
        "from pdr_est._hidden import name",
        "import pdr_est._hidden",
        "from pdr_est import pipeline\npipeline._inner()",
        "import pdr_est\npdr_est.read('x')._rows[0]",
        "def test(tracker):\n    assert tracker.filter._state == 1",
        "def test(tracker):\n    assert getattr(tracker, '_state') == 1",
        "def test(monkeypatch):\n    monkeypatch.setattr('pdr_est.pipeline._inner', 1)",
        "from pdr_est import pipeline\ndef test(monkeypatch):\n    monkeypatch.setattr(pipeline, '_inner', 1)",
    ],
)
def test_a_private_name_is_noticed(source: str) -> None:
    assert list(private_uses(source))


@pytest.mark.parametrize(
    "source",
    [
        "import os\nos._exit(0)",
        "class Stub:\n    def push(self):\n        return self._rows",
        "def test(track):\n    assert track._repr_html_()",
        "def test(row):\n    assert row.__class__ and row._replace(a=1)",
        "from pdr_est.pipeline import smooth\nsmooth.__doc__",
    ],
)
def test_names_of_others_are_free(source: str) -> None:
    assert list(private_uses(source)) == []
