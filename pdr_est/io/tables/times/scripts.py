"""Write dates in Chinese, Japanese and Korean with the marks of other languages."""

import polars as pl

# In this order: a mark between two numbers, then what stands alone.
_MARKS = (
    (r"\s*[年月년월]\s*", "-"),
    (r"\s*[日号號일](?:\s*[（(]?(?:星期|周|週)?[一二三四五六日天月火水木金土]?(?:曜日)?[)）])?\s*", " "),
    (r"\s*毫秒|\s*ミリ秒|\s*밀리초", ""),
    (r"\s*[時时點点시]\s*", ":"),
    (r"\s*[分분]\s*", ":"),
    (r"\s*[秒초]\s*(\d)", ".$1"),
    (r"\s*[秒초]", ""),
    (r"(?:上午|午前|오전|凌晨|早上)\s*([\d:.,]+)", "$1 AM"),
    (r"(?:下午|午後|오후|晚上)\s*([\d:.,]+)", "$1 PM"),
    (r":+($|\s)", "$1"),
    (r"\s{2,}", " "),
)


def with_usual_marks(column: pl.Series) -> pl.Series:
    """Write 2031年2月3日 12时05分06秒 as 2031-2-3 12:05:06; other texts are returned as they are.

    Parameters
    ----------
    column
        (n,) texts.
    """
    if not len(column) or not column.str.contains(r"[年月日号時时點点分秒년월일시분초：]|午").any():
        return column
    # Full-width digits and colons become the usual ones.
    column = column.str.normalize("NFKC")
    for mark, usual in _MARKS:
        column = column.str.replace_all(mark, usual)
    return column.str.strip_chars()
