"""What a page embeds is what its policy allows, and nothing of it can end the element that holds it."""

import base64
import hashlib
import json
import re

import pytest

from pdr_est.report.inline_assets import TRACK_MAP_SCRIPTS, inline_assets, inline_json


def test_libraries_come_with_their_licences_and_load_nothing() -> None:
    assets = inline_assets(["leaflet", "uplot"], [])
    for script in assets.scripts:
        assert "copyright" in script[:1500].lower()
        assert "provided" in script[:1500].lower()
        assert "sourceMappingURL" not in script
    for style in assets.styles:
        assert not re.findall(r"url\((?!#)[^)]*\)", style)


def test_no_script_holds_what_an_html_parser_reacts_to() -> None:
    for script in inline_assets(["leaflet", "uplot"], TRACK_MAP_SCRIPTS).scripts:
        assert not re.search(r"</?script|<!--", script, re.IGNORECASE)


def test_the_policy_states_the_hash_of_every_script_and_no_other_source() -> None:
    assets = inline_assets(["uplot"], TRACK_MAP_SCRIPTS)
    digests = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in assets.scripts]
    parts = dict(part.split(" ", 1) for part in assets.policy().split("; "))
    assert parts["script-src"] == " ".join(f"'sha256-{digest}'" for digest in digests)
    assert parts["default-src"] == "'none'"
    assert "connect-src" not in parts


def test_data_cannot_end_their_element_and_come_back_unchanged() -> None:
    value = {"name": "</script><script>alert(1)</script><!-- & 左ポケット \u2028", "values": [1.5, None, -2]}
    text = inline_json(value)
    assert "<" not in text
    assert json.loads(text) == value
    with pytest.raises(ValueError, match="not JSON compliant"):
        inline_json([float("nan")])


def test_a_script_that_the_package_lacks_is_an_error() -> None:
    with pytest.raises(FileNotFoundError):
        inline_assets([], ["no_such_script.js"])
