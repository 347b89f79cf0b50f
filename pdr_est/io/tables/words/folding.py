"""Bring words to one way of writing, so that each name stands in the vocabulary once."""

import re
import unicodedata

_CAMEL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
_SCRIPTS = re.compile(r"(?<=[A-Za-z0-9])(?=[^\W\d_A-Za-z])|(?<=[^\W\d_A-Za-z])(?=[A-Za-z0-9])", re.UNICODE)
_WORD = re.compile(r"[^\W_]+")
_LATIN_MARKS = re.compile(r"(?<=[a-z])[\u0300-\u036f]+")
_LATIN_LETTERS = str.maketrans({"ł": "l", "ø": "o", "ı": "i", "đ": "d", "æ": "ae", "œ": "oe"})
# Chinese, Japanese and Korean write these without a blank beside the name of a sensor.
_EAST_ASIAN_FILLERS = re.compile(
    "(三?軸|三?轴|축)(方向|向)?(の|的|의)?|方向|方位|成分|分量|数据|數據|データ|[の的値值]"
)
_EAST_ASIAN = re.compile("[\u3040-\u30ff\u3400-\u9fff\uac00-\ud7af]")


def folded(text: str) -> str:
    """Write a text in lower case without the accents of Latin letters."""
    decomposed = unicodedata.normalize("NFD", unicodedata.normalize("NFKC", text).casefold())
    return unicodedata.normalize("NFC", _LATIN_MARKS.sub("", decomposed).translate(_LATIN_LETTERS))


def split_words(text: str) -> list[str]:
    """Split a text into folded words at separators, changes of case and changes of script."""
    # Accents go first: a change of case is then also seen beside ä or é, and a letter is never cut from its word.
    plain = _without_latin_marks(unicodedata.normalize("NFKC", text))
    spaced = _SCRIPTS.sub(" ", _CAMEL.sub(" ", plain))
    return [_without_fillers(folded(word)) for word in _WORD.findall(spaced)]


def _without_latin_marks(text: str) -> str:
    if text.isascii():
        return text
    decomposed = re.sub(r"(?<=[A-Za-z])[\u0300-\u036f]+", "", unicodedata.normalize("NFD", text))
    return unicodedata.normalize("NFC", decomposed.translate(_LATIN_LETTERS))


def _without_fillers(word: str) -> str:
    """Leave out what means "axis" or "direction" in a word of East Asian scripts, unless that is all of it."""
    if not _EAST_ASIAN.search(word):
        return word
    return _EAST_ASIAN_FILLERS.sub("", word) or word
