"""Read the docstrings under the fields of parameter records from the source.

Python keeps no docstring of a field, so the source is parsed. That takes time, and therefore happens only where the
docstrings are shown.
"""

import ast
import inspect
import textwrap
from collections.abc import Iterator, Mapping
from functools import cache
from itertools import pairwise
from types import MappingProxyType
from typing import Any

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue


@cache
def field_docstrings(record: type) -> Mapping[str, str]:
    """Map the name of each field of a record to its docstring, one paragraph a line.

    Fields without a docstring, and all fields of a class whose source cannot be found, are left out.
    """
    found: dict[str, str] = {}
    for base in reversed(record.__mro__):
        found |= dict(_own_docstrings(base))
    return MappingProxyType(found)


class DescribedJsonSchema(GenerateJsonSchema):
    """Generator of JSON schemas in which the docstring of a field is its description."""

    def dataclass_schema(self, schema: Any) -> JsonSchemaValue:
        """Make the schema of a record and add the descriptions of its fields."""
        document = super().dataclass_schema(schema)
        described = field_docstrings(schema["cls"])
        for name, value in document.get("properties", {}).items():
            if name in described:
                value["description"] = described[name]
        return document


def _own_docstrings(cls: type) -> Iterator[tuple[str, str]]:
    """Yield the fields that the body of a class defines, each with the string literal that follows it."""
    if "__annotations__" not in vars(cls):
        return
    try:
        (definition,) = ast.parse(textwrap.dedent(inspect.getsource(cls))).body
    except (OSError, TypeError, SyntaxError):  # defined in an interpreter, or compiled
        return
    body = definition.body if isinstance(definition, ast.ClassDef) else []
    for field, after in pairwise(body):
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
            text = _string(after)
            if text is not None:
                yield field.target.id, text


def _string(statement: ast.stmt) -> str | None:
    """Read a statement that is nothing but a string literal; lines of a paragraph are joined."""
    if not isinstance(statement, ast.Expr) or not isinstance(statement.value, ast.Constant):
        return None
    if not isinstance(statement.value.value, str):
        return None
    paragraphs = inspect.cleandoc(statement.value.value).split("\n\n")
    return "\n".join(" ".join(paragraph.split()) for paragraph in paragraphs)
