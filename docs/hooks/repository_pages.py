"""Add pages of the site that lie elsewhere in the repository: the changelog and both pages of the papers.

This file is a hook of mkdocs.
"""

import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
PAGES = {
    "changelog.md": "CHANGELOG.md",
    "papers.md": "experiments/README.md",
    "paper-details.md": "experiments/paper-details.md",
}
"""Name of each page on the site, and the file that it is made from."""


def on_files(files: Any, config: Any) -> Any:
    """Add the pages and the pictures that they link to (called by mkdocs)."""
    from mkdocs.structure.files import File

    pictures = {}
    for name, source in PAGES.items():
        path = ROOT / source
        files.append(File.generated(config, name, content=links_on_site(path.read_text(encoding="utf-8"))))
        pictures |= {target: path.parent / target for target in linked_pictures(path)}
    for target, picture in sorted(pictures.items()):
        files.append(File.generated(config, target, content=picture.read_bytes()))
    return files


def links_on_site(text: str) -> str:
    """Turn links to pages from the root of the repository into links between pages of the site."""
    for here, there in {
        "](docs/": "](",
        "](../docs/": "](",
        "](experiments/README.md": "](papers.md",
        "](README.md": "](papers.md",
    }.items():
        text = text.replace(here, there)
    return text


def linked_pictures(page: Path) -> set[str]:
    """Find the pictures beside a page that it links to, relative to its folder."""
    return set(re.findall(r"\]\(((?!https?:)[^)#\s]+\.png)\)", page.read_text(encoding="utf-8")))
