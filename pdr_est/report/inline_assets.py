"""Scripts and styles that stand inside a page, so that it is a single file, and the policy that allows only them."""

import base64
import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from markupsafe import Markup

from pdr_est.output.visible_text import visible_json

_LIBRARIES: Mapping[str, tuple[str, str]] = {
    "leaflet": ("leaflet.js", "leaflet.css"),
    "uplot": ("uPlot.iife.min.js", "uPlot.min.css"),
}
# Comments, and declarations that refer to pictures which are not used.
_NEEDLESS_STYLE = re.compile(r"/\*.*?\*/|[\w-]+:\s*url\([^)]*\);?", re.DOTALL)

TRACK_MAP_SCRIPTS = ("poses.js", "covariance.js", "device_lines.js", "map_controls.js", "track_map.js")
"""Scripts that `createTrackMap` needs, beside the library "leaflet"."""


@dataclass(frozen=True)
class InlineAssets:
    """Scripts and styles of a page.

    Attributes
    ----------
    scripts
        Text of each script, in the order in which they run.
    styles
        Text of each style sheet.
    """

    scripts: tuple[Markup, ...]
    styles: tuple[Markup, ...]

    def policy(self, *image_hosts: str, connect: Sequence[str] = ()) -> str:
        """Write a Content-Security-Policy that allows these scripts and nothing else that runs.

        Parameters
        ----------
        *image_hosts
            Origins from which pictures may be loaded, such as "https://tile.openstreetmap.org".
        connect
            Sources that scripts may open connections to, such as "'self'".
        """
        parts = [
            "default-src 'none'",
            "script-src " + " ".join(f"'sha256-{_digest(text)}'" for text in self.scripts),
            "style-src 'unsafe-inline'",  # Leaflet places its parts by style attributes
            " ".join(("img-src data: blob:", *image_hosts)),
        ]
        if connect:
            parts.append(" ".join(("connect-src", *connect)))
        return "; ".join(parts)


def inline_assets(libraries: Sequence[str], scripts: Sequence[str]) -> InlineAssets:
    """Load bundled libraries and scripts for a page.

    Parameters
    ----------
    libraries
        Names of bundled libraries: "leaflet", "uplot".
    scripts
        Names of files in the folder `scripts`, in the order in which they run, after the libraries.
    """
    names = [_LIBRARIES[name] for name in libraries]
    texts = [_asset(library, script) for library, (script, _) in zip(libraries, names, strict=True)]
    texts += [_script(name) for name in scripts]
    styles = [_asset(library, style) for library, (_, style) in zip(libraries, names, strict=True)]
    return InlineAssets(
        tuple(Markup(text) for text in texts), tuple(Markup(_NEEDLESS_STYLE.sub("", text)) for text in styles)
    )


def inline_json(value: Any) -> Markup:
    """Write a value as JSON that stands inside a <script type="application/json"> element."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return Markup(visible_json(text).replace("<", "\\u003c"))  # so that no text in it can end the element


@cache
def _asset(library: str, name: str) -> str:
    text = (files("pdr_est.report") / "assets" / library / name).read_text(encoding="utf-8")
    text = text.split("//# sourceMappingURL=")[0]  # of a file that is not there
    licence = (files("pdr_est.report") / "assets" / library / "LICENSE").read_text(encoding="utf-8")
    return f"/*\n{licence.strip()}\n*/\n{text.strip()}\n" if name.endswith(".js") else text.strip()


@cache
def _script(name: str) -> str:
    return (files("pdr_est.report") / "scripts" / name).read_text(encoding="utf-8").strip()


@cache
def _digest(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii")
