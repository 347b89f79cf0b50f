"""Refuse to build a site whose pages load anything from the network.

This file is a hook of mkdocs.
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

_ADDRESS = r"[\"']?((?:https?:)?//[^\"')\s>]+)"
_LOADS = (
    re.compile(rf"<(?:script|img|iframe|source|audio|video|embed)\b[^>]*\bsrc={_ADDRESS}"),
    re.compile(rf"<link\b(?=[^>]*rel=[\"']?(?:stylesheet|icon|preload|preconnect))[^>]*\bhref={_ADDRESS}"),
    re.compile(rf"(?:url\(|@import\s+){_ADDRESS}"),
)


def external_loads(folder: Path) -> Iterator[str]:
    """Find what pages and style sheets load from outside, each as `file: address`; links to follow do not count."""
    for path in sorted(folder.rglob("*")):
        if path.suffix in (".html", ".css"):
            text = path.read_text(encoding="utf-8")
            for pattern in _LOADS:
                yield from (f"{path.relative_to(folder)}: {address}" for address in pattern.findall(text))


def on_post_build(config: Any) -> None:
    """Fail if a page loads something from the network (called by mkdocs)."""
    from mkdocs.exceptions import PluginError

    found = list(external_loads(Path(config["site_dir"])))
    if found:
        raise PluginError(
            f"the site must work without network, but loads {len(found)} things: {'; '.join(found[:5])}"
        )
