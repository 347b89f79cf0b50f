"""Every file that the package writes goes through the writer that leaves nothing half-written."""

import ast
from collections.abc import Iterator

import pytest
from package_sources import package_trees

STAGED = {"staged", "staged_file", "staged_folder", "saved", "text_output", "TemporaryDirectory"}
"""Functions whose results may be written to, for as long as a `with` block holds them."""

WRITES = {"write_text", "write_bytes", "write_csv", "write_parquet", "write_json", "write_ipc", "touch", "to_parquet"}
TAKES_FILE = {"savez", "savez_compressed", "savetxt", "savefig", "copyfile", "copytree", "copy2"}
OF_LIBRARY = {"shutil": {"copy", "move"}, "np": {"save"}, "json": {"dump"}, "pickle": {"dump"}, "yaml": {"dump"}}
OPENS = {"open", "File", "ZipFile", "fdopen", "NamedTemporaryFile", "mkstemp"}
CHANGES = {"unlink", "rmtree", "rename", "remove_tree", "symlink_to", "hardlink_to", "truncate", "rmdir"}
KNOWN = {
    # Results of walks are removed by their pattern, and only in a folder whose provenance is ours.
    ("experiment/results/result_folder.py", "_clear", "unlink"),
    # The null device.
    ("cli/process.py", "occupy_closed_streams", "open"),
    ("cli/process.py", "give_up_stdout", "open"),
    # A buffer in memory, and a folder that the system keeps for temporary files.
    ("report/plots/figure.py", "to_svg", "savefig"),
    ("io/formats/phone_apps/matlab_mobile.py", "_timetables", "write_bytes"),
    # Into memory.
    ("io/formats/exchange/parquet_table.py", "write_parquet_recording", "write_parquet"),
    ("io/writers/parquet.py", "write_parquet", "write_parquet"),
    # No files: columns of a table, a table as text, and the table of a track, which writes through `text_output`.
    ("io/text/whole_rows.py", "_add", "rename"),
    ("types/track.py", "to_csv", "write_csv"),
    ("io/tables/split/respelt.py", "_side_by_side", "write_csv"),
    ("io/tables/split/respelt.py", "_side_by_side", "rename"),
}


def name_of(function: ast.expr) -> str:
    return (
        function.attr
        if isinstance(function, ast.Attribute)
        else function.id
        if isinstance(function, ast.Name)
        else ""
    )


def mode_of(call: ast.Call) -> str:
    texts = [
        node.value for node in (*call.args, *(key.value for key in call.keywords)) if isinstance(node, ast.Constant)
    ]
    return next((text for text in texts if isinstance(text, str) and text and set(text) <= set("rwxabt+U")), "r")


def staged_names(tree: ast.AST) -> set[str]:
    """Names that `with` blocks give to what may be written to, and to streams that are opened on it."""
    names: set[str] = set()
    for node in ast.walk(tree):
        for item in node.items if isinstance(node, ast.With) else ():
            call = item.context_expr
            if not isinstance(call, ast.Call) or not isinstance(item.optional_vars, ast.Name):
                continue
            if name_of(call.func) in STAGED or (set(names_in(call)) & names):
                names.add(item.optional_vars.id)
    return names


def names_in(tree: ast.AST) -> Iterator[str]:
    yield from (node.id for node in ast.walk(tree) if isinstance(node, ast.Name))


def writing_calls(tree: ast.AST) -> Iterator[tuple[str, ast.Call]]:
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name, method = name_of(node.func), isinstance(node.func, ast.Attribute)
        library = node.func.value.id if method and isinstance(node.func.value, ast.Name) else ""
        writes = method and name in WRITES | CHANGES | TAKES_FILE | OF_LIBRARY.get(library, set())
        if writes or (name in OPENS and set(mode_of(node)) & set("wxa+")):
            yield name, node


def unstaged(tree: ast.Module, module: str) -> list[str]:
    """Calls that write to something that no `with` block of the same function has staged."""
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    inner = {
        id(node)
        for outer in functions
        for node in ast.walk(outer)
        if isinstance(node, ast.FunctionDef) and node is not outer
    }
    found = []
    for function in (one for one in functions if id(one) not in inner):
        allowed = staged_names(function)
        for name, call in writing_calls(function):
            if not set(names_in(call)) & allowed and (module, function.name, name) not in KNOWN:
                found.append(f"{module}:{call.lineno}: {function.name}: {ast.unparse(call)}")
    return found


def test_no_module_writes_by_itself() -> None:
    writers = {module: tree for module, tree in package_trees().items() if not module.startswith("output/")}
    found = [line for module, tree in writers.items() for line in unstaged(tree, module)]
    assert found == [], "write through pdr_est.output.atomic_output"


@pytest.mark.parametrize(
    "code",
    [
        "path.write_text('x')",
        "open(path, 'w')",
        "path.open('xb')",
        "open(path, mode='a')",
        "frame.write_csv(path)",
        "np.savez(path, a=1)",
        "h5py.File(path, 'w')",
        "shutil.copyfile(a, b)",
        "path.unlink()",
        "shutil.rmtree(path)",
        "path.rename(other)",
        "figure.savefig(path)",
    ],
)
def test_a_write_by_itself_is_noticed(code: str) -> None:
    assert len(unstaged(ast.parse(f"def f():\n    {code}"), "a.py")) == 1
    held = "staged_file(x) as path, staged_file(y) as b, path.open('wb') as frame"
    assert unstaged(ast.parse(f"def f():\n    with {held}:\n        {code}"), "a.py") == []


def test_reading_is_no_writing() -> None:
    reading = "open(path)\n    path.open('rb')\n    text.replace('a', 'b')\n    Source.open(path)"
    assert unstaged(ast.parse(f"def f():\n    {reading}"), "a.py") == []
