"""Bring the text of a table to UTF-8 with plain line ends, whatever encoding it was saved in."""

import re

_UTF8_MARK = b"\xef\xbb\xbf"
_UTF16_MARKS = {b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}
_SAMPLE_BYTES = 2000
_NUL_SHARE = 0.3  # every second byte of UTF-16 text in Latin letters and digits is NUL
_HIGH_BYTES = re.compile(rb"[\x80-\xff]+")
_KANA = re.compile("[\u30a1-\u30fc]")
_IDEOGRAPHS = re.compile("[\u4e00-\u9fff]")
_FEWEST_LETTERS = 2
# Frequent in titles of recordings: time, acceleration, angle, axis, magnetism, sensor, gyroscope, place.
_TELLING = re.compile("[時間刻加速度角軸轴磁気地力重压圧緯経度方向位置回転时间戳传感器陀螺仪场强气纬经旋转值]")
# Beginnings of the same words in Russian and Ukrainian.
_TELLING_CYRILLIC = re.compile(
    "врем|отмет|дата|час|секунд|ускор|прискор|скорост|гироск|гіроск|акселер|магн|широт|долгот"
)
# First bytes of signs and digits that mean the same as those of ASCII: minus and dashes, full-width, Arabic, Persian.
_FOREIGN_LEADS = (b"\xe2\x88\x92", b"\xe2\x80\x93", b"\xef\xbc", b"\xd9", b"\xdb")
_DASHES = re.compile("[−–－](?=[0-9０-９٠-٩۰-۹.])")
_FOREIGN_DIGITS = str.maketrans("０１２３４５６７８９٠١٢٣٤٥٦٧٨٩۰۱۲۳۴۵۶۷۸۹٫．＋", "012345678901234567890123456789..+")
_BROKEN_SIGNS = {"Â²": "²", "Â°": "°", "Âµ": "µ", "Î¼": "μ", "â°": "°", "Âº": "º"}


def as_utf8(data: bytes) -> bytes:
    """Return the bytes of a text in UTF-8, without byte-order mark and NUL, with LF at the ends of lines.

    UTF-16 is recognised by its mark or by its NULs. Bytes that are not UTF-8 are Cyrillic (Windows-1251) by its words
    for what is recorded, Chinese (GB 18030) or Japanese (Shift JIS) if they come in pairs, else Windows-1252, which
    contains Latin-1. Digits of other scripts and
    typographic minus signs become those of ASCII. A text that is plain UTF-8 already is returned as it is, so that
    nothing is copied.
    """
    encoding = _utf16_encoding(data)
    if encoding is not None:
        data = data.decode(encoding, "replace").removeprefix("\ufeff").encode()
    elif data.startswith(_UTF8_MARK):
        data = data[len(_UTF8_MARK) :]
    if b"\0" in data:
        data = data.replace(b"\0", b"")
    if not data.isascii():
        data = _with_plain_numbers(_from_single_bytes(data))
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return data


def repair_signs(text: str) -> str:
    """Return a text with the signs ², °, µ that were once read in the wrong encoding."""
    for broken, sign in _BROKEN_SIGNS.items():
        if broken in text:
            text = text.replace(broken, sign)
    return text


def _with_plain_numbers(data: bytes) -> bytes:
    """Write numbers in the digits and signs of ASCII."""
    if not any(lead in data for lead in _FOREIGN_LEADS):
        return data
    return _DASHES.sub("-", data.decode("utf-8", "replace")).translate(_FOREIGN_DIGITS).encode()


def _utf16_encoding(data: bytes) -> str | None:
    if data[:2] in _UTF16_MARKS:
        return _UTF16_MARKS[data[:2]]
    sample = data[:_SAMPLE_BYTES]
    if len(sample) < 4 or sample.count(0) < _NUL_SHARE * len(sample):
        return None
    if sample[1::2].count(0) > 0.8 * len(sample[1::2]) and not sample[::2].count(0):
        return "utf-16-le"
    if sample[::2].count(0) > 0.8 * len(sample[::2]) and not sample[1::2].count(0):
        return "utf-16-be"
    return None


def _from_single_bytes(data: bytes) -> bytes:
    """Return the data as they are if they are UTF-8, else read from Windows-1252."""
    try:
        data.decode()
    except UnicodeDecodeError as error:
        # A text that is cut in the middle of a letter, as the head of a file is, is still UTF-8.
        if error.end >= len(data) and len(data) - error.start < 4:
            return data[: error.start]
        return data.decode(_encoding_of_bytes(data[:_SAMPLE_BYTES]), "replace").encode()
    return data


def _encoding_of_bytes(sample: bytes) -> str:
    """Tell Cyrillic, Chinese and Japanese text, of many letters beyond ASCII, from Western text with single signs."""
    runs = [run for run in _HIGH_BYTES.findall(sample) if len(run) > 1]
    if 2 * len(runs) < len(_HIGH_BYTES.findall(sample)):
        return "cp1252"
    if len(_TELLING_CYRILLIC.findall(sample.decode("cp1251", "ignore").lower())) >= _FEWEST_LETTERS:
        return "cp1251"
    likelier = max(("cp932", "gb18030"), key=lambda one: len(_TELLING.findall(sample.decode(one, "ignore"))))
    for encoding, script in ((likelier, _TELLING), ("cp932", _KANA), ("gb18030", _IDEOGRAPHS)):
        text = sample.decode(encoding, "ignore")
        if len(script.findall(text)) >= _FEWEST_LETTERS and "\ufffd" not in sample[:-2].decode(encoding, "replace"):
            return encoding
    return "cp1252"
