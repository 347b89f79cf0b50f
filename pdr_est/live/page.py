"""The live page: one document with everything inside, and the policy that allows its own scripts only."""

import base64
import hashlib
import json
import re
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable

from pdr_est.live.poses import MODES

_LEAFLET = ("leaflet", ("leaflet.js",))
_MAP_SCRIPTS = ("poses.js", "covariance.js", "device_lines.js", "map_controls.js", "track_map.js")
_OWN_SCRIPTS = ("live_link.js", "live_phone.js", "live_track.js", "live_page.js")


@cache
def live_page() -> tuple[str, str]:
    """Return the page and its Content-Security-Policy, which allows the scripts of the page and nothing else.

    Returns
    -------
    tuple of str
        HTML, and the value of the header.
    """
    report, live = files("pdr_est.report"), files("pdr_est.live")
    library = report / "assets" / _LEAFLET[0]
    scripts = [
        *(_text(library / name) for name in _LEAFLET[1]),
        *(_text(report / "scripts" / name) for name in _MAP_SCRIPTS),
        *(_text(live / "scripts" / name) for name in _OWN_SCRIPTS),
    ]
    style = re.sub(r"</?style>", "", _text(report / "style.html.j2"))
    styles = "\n".join([_text(library / "leaflet.css"), style, _text(live / "live.css")])
    page = _text(live / "live.html")
    page = page.replace("<!-- modes -->", json.dumps(MODES))
    page = page.replace("<!-- styles -->", f"<style>\n{styles}</style>")
    page = page.replace("<!-- scripts -->", "\n".join(f"<script>{script}</script>" for script in scripts))
    return page, content_policy(scripts)


def content_policy(scripts: list[str]) -> str:
    """Make the policy of a page that runs these scripts and connects to its own server only."""
    hashes = [base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in scripts]
    allowed = " ".join(f"'sha256-{one}'" for one in hashes)
    return (
        f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; img-src data: blob:; "
        "connect-src 'self'; frame-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
    )


def _text(place: Traversable) -> str:
    return place.read_text(encoding="utf-8")
