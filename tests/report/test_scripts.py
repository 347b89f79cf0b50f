"""The scripts of the pages: small files with one job each, strict, and without names that hide each other."""

import re
from collections import Counter
from pathlib import Path

import pytest

import pdr_est.report

SCRIPTS = sorted((Path(pdr_est.report.__file__).parent / "scripts").glob("*.js"))
MOST_LINES, MOST_COLUMNS = 300, 118
# Elements made of text, code made of text, and anything from elsewhere have no place in a page of untrusted names.
FORBIDDEN = re.compile(
    r"\beval\(|new Function|document\.write|insertAdjacentHTML|outerHTML|\bimport\b|XMLHttpRequest"
)


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_a_script_is_small_strict_and_says_what_it_does(script: Path) -> None:
    text = script.read_text(encoding="utf-8")
    assert text.count("\n") <= MOST_LINES
    assert max(map(len, text.splitlines())) <= MOST_COLUMNS
    assert re.match(r"/\*\* [A-Z][a-z]+ .*[^*]\*/\n'use strict';\n", text)
    assert not FORBIDDEN.search(text)


def test_no_two_scripts_define_the_same_name() -> None:
    defined = re.compile(r"^(?:async )?(?:function|const|let|class) (\w+)", re.MULTILINE)
    names = Counter(name for path in SCRIPTS for name in defined.findall(path.read_text(encoding="utf-8")))
    assert {name for name, count in names.items() if count > 1} == set()
