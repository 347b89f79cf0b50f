"""Names and messages that say what they hold, wherever they are shown."""

import re

_CONTROLS = "\x00-\x08\x0b-\x1f\x7f-\x9f"
_DIRECTIONS = "\u202a-\u202e\u2066-\u2069"  # embeddings, overrides and isolates of the bidirectional algorithm
_HIDDEN = re.compile(f"[{_CONTROLS}{_DIRECTIONS}]")


def visible_text(text: str) -> str:
    r"""Escape control characters, and those that change the direction of a text, such as \u202e.

    A page or a terminal would obey such a character in a name, and show what follows backwards or somewhere else.
    Tabs, ends of lines and the letters of all scripts stay.
    """
    return _HIDDEN.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


def visible_json(document: str) -> str:
    r"""Escape the same characters in the texts of a JSON document; they are then read as \u202e is written here."""
    return _HIDDEN.sub(lambda found: f"\\\\u{ord(found[0]):04x}", document)
