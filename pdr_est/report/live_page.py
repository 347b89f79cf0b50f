"""The live page: one document with everything inside, and the policy that allows its own scripts only."""

from collections.abc import Sequence

from pdr_est.report.inline_assets import TRACK_MAP_SCRIPTS, inline_assets, inline_json
from pdr_est.report.page_templates import template_environment

_SCRIPTS = ("dom.js", "live_link.js", "live_phone.js", "live_track.js", "live_page.js")
_NO_FRAMES = "frame-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"


def render_live_page(modes: Sequence[str]) -> tuple[str, str]:
    """Render the page.

    Parameters
    ----------
    modes
        Names of the carrying modes by their number.

    Returns
    -------
    tuple of str
        HTML, and the value of the header Content-Security-Policy, by which the page runs its own scripts, connects to
        its own server and shows the report of that server, and nothing else.
    """
    assets = inline_assets(["leaflet"], [*TRACK_MAP_SCRIPTS, *_SCRIPTS])
    template = template_environment().get_template("live.html.j2")
    page = template.render(assets=assets, modes=inline_json(list(modes)))
    policy = assets.policy(connect=["'self'"])
    return page, f"{policy}; {_NO_FRAMES}"
