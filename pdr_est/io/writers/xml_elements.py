"""XML elements with text, and complete XML documents; for the formats of maps."""

import re
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, tostring

from pdr_est.output.atomic_output import write_text
from pdr_est.output.visible_text import visible_text

_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def add_element(parent: Element, tag: str, text: str) -> None:
    """Add an element that holds nothing but text, hidden characters escaped and those that XML forbids replaced."""
    SubElement(parent, tag).text = _NO_XML.sub("\N{REPLACEMENT CHARACTER}", visible_text(text))


def write_document(path: str | Path, root: Element) -> None:
    """Write an XML document in UTF-8.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    write_text(path, '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="unicode") + "\n")
