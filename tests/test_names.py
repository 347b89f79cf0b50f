"""Public names of the package are unique, docstrings do not begin as fragments, and every parameter has one."""

import ast
from collections import defaultdict

from package_sources import package_trees

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
    for module, tree in package_trees().items():
        for node in tree.body if module != FACADE else ():
            if isinstance(node, ast.ClassDef | ast.FunctionDef) and not node.name.startswith("_"):
                places[node.name].append(module)
    shared = {name: found for name, found in places.items() if len(found) > 1 and name not in INTERFACES}
    assert shared == {}


def test_no_docstring_begins_as_a_fragment() -> None:
    found = {module: openings for module, tree in package_trees().items() if (openings := fragments(tree))}
    assert found == {}


def fragments(tree: ast.Module) -> list[str]:
    nodes = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
    ]
    openings = [(ast.get_docstring(node) or "").split("\n")[0] for node in nodes]
    return [opening for opening in openings if opening.startswith(FRAGMENTS)]


def test_every_field_of_a_parameter_record_is_documented() -> None:
    found = {module: bare for module, tree in package_trees().items() if (bare := undocumented_fields(tree))}
    assert found == {}


def undocumented_fields(tree: ast.Module) -> list[str]:
    bare = []
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef) and any(ast.unparse(item) == "params" for item in node.decorator_list):
            following = [*node.body[1:], None]
            bare += [
                f"{node.name}.{ast.unparse(field.target)}"
                for field, after in zip(node.body, following, strict=True)
                if isinstance(field, ast.AnnAssign)
                and not (isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant))
            ]
    return bare


def test_a_fragment_and_a_bare_field_are_noticed() -> None:
    tree = ast.parse('"""Of a fragment."""\n\n\n@params\nclass Some:\n    """Return."""\n\n    a: int\n    b: int\n')
    assert fragments(tree) == ["Of a fragment."]
    assert undocumented_fields(tree) == ["Some.a", "Some.b"]
