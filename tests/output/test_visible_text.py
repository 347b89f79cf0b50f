"""Hidden characters in names are shown and not obeyed."""

import json

import pytest

from pdr_est.output.visible_text import visible_json, visible_text

HOSTILE = "walk\u202egpj.exe\x1b[2J\u2066"


def test_what_changes_direction_and_what_controls_is_escaped() -> None:
    assert visible_text(HOSTILE) == r"walk\u202egpj.exe\u001b[2J\u2066"


@pytest.mark.parametrize("name", ["散歩 – Weg", "правая рука 🚶", "רגל ימין", "two\nlines\tand a tab", "👩\u200d💻"])
def test_other_texts_stay(name: str) -> None:
    assert visible_text(name) == name


def test_in_a_json_document_the_texts_are_read_as_they_are_shown() -> None:
    document = json.dumps({"name": "a\u202eb", "other": "é"}, ensure_ascii=False)
    assert json.loads(visible_json(document)) == {"name": r"a\u202eb", "other": "é"}
