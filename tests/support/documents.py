"""Code blocks of the README and of the pages in docs/."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")), ROOT / "experiments" / "README.md")
TUTORIALS = tuple(sorted((ROOT / "docs" / "tutorials").glob("*.py")))
LANGUAGES = ("console", "python", "yaml", "csv", "text")  # "text" is for pictures and tables that nothing reads

_FENCE = re.compile(r"^```(?P<language>\S*)\n(?P<code>.*?)^```$", re.MULTILINE | re.DOTALL)
_FILE_NAME = re.compile(r"# (?P<name>[\w-]+\.\w+)\n")


@dataclass(frozen=True)
class Block:
    """A fenced block of a page, whose code begins in `line`, counted from 1."""

    page: Path
    line: int
    language: str
    code: str

    @property
    def name(self) -> str:
        """Return page and line, for messages."""
        return f"{self.page.relative_to(ROOT)}:{self.line}"

    @property
    def file_name(self) -> str | None:
        """Return the name of the file that a reader writes it into, from a first line such as `# walks.yaml`."""
        match = _FILE_NAME.match(self.code)
        return match["name"] if match else None

    @property
    def commands(self) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """Return the commands of a console block, each after its "$ ", with the lines that it prints."""
        found: list[tuple[str, list[str]]] = []
        for line in self.code.splitlines():
            if line.startswith("$ "):
                found.append((line.removeprefix("$ "), []))
            elif found:
                found[-1][1].append(line)
            else:
                raise AssertionError(f"{self.name}: output before the first command: {line}")
        return tuple((command, tuple(lines)) for command, lines in found)


def blocks_of(page: Path) -> tuple[Block, ...]:
    """Return the blocks of a page in their order."""
    text = page.read_text(encoding="utf-8")
    return tuple(
        Block(page, text.count("\n", 0, match.start("code")) + 1, match["language"], match["code"])
        for match in _FENCE.finditer(text)
    )


def prose_of(page: Path) -> str:
    """Return a page without its blocks."""
    return _FENCE.sub("", page.read_text(encoding="utf-8"))


def missing_lines(expected: Sequence[str], output: str) -> list[str]:
    """Return the lines that a page shows and a command did not print; "…" stands for anything."""
    printed = {" ".join(line.split()) for line in output.splitlines()}
    return [line for line in expected if line.strip() not in ("", "…") and " ".join(line.split()) not in printed]
