"""Excel workbooks of the smallest kind, written by hand."""

import struct
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

_MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
_RELATIONS = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006"


def write_workbook(path: Path, sheets: Mapping[str, Sequence[Sequence[Any]]]) -> Path:
    """Write rows of texts and numbers as the sheets of an xlsx file."""
    numbers = range(1, len(sheets) + 1)
    parts = "".join(
        f'<Override PartName="/xl/worksheets/sheet{i}.xml" ContentType="application/vnd.'
        'openxmlformats-officedocument.spreadsheetml.worksheet+xml"/>'
        for i in numbers
    )
    listed = "".join(
        f'<sheet name="{escape(name)}" sheetId="{i}" r:id="r{i}"/>' for i, name in zip(numbers, sheets, strict=True)
    )
    related = "".join(
        f'<Relationship Id="r{i}" Type="{_RELATIONS}/worksheet" Target="worksheets/sheet{i}.xml"/>' for i in numbers
    )
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(
            "[Content_Types].xml",
            f'<Types xmlns="{_PACKAGE}/content-types"><Default Extension="rels" ContentType="application/vnd.'
            'openxmlformats-package.relationships+xml"/><Override PartName="/xl/workbook.xml" ContentType='
            f'"application/vnd.openxmlformats-officedocument.spreadsheetml.sheet.main+xml"/>{parts}</Types>',
        )
        archive.writestr(
            "_rels/.rels",
            f'<Relationships xmlns="{_PACKAGE}/relationships"><Relationship Id="r0" '
            f'Type="{_RELATIONS}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        )
        archive.writestr(
            "xl/workbook.xml",
            f'<workbook xmlns="{_MAIN}" xmlns:r="{_RELATIONS}"><sheets>{listed}</sheets></workbook>',
        )
        archive.writestr(
            "xl/_rels/workbook.xml.rels", f'<Relationships xmlns="{_PACKAGE}/relationships">{related}</Relationships>'
        )
        for i, rows in zip(numbers, sheets.values(), strict=True):
            archive.writestr(f"xl/worksheets/sheet{i}.xml", _sheet(rows))
    return path


def _sheet(rows: Sequence[Sequence[Any]]) -> str:
    lines = "".join(f'<row r="{i}">{"".join(map(_cell, row))}</row>' for i, row in enumerate(rows, start=1))
    return f'<worksheet xmlns="{_MAIN}"><sheetData>{lines}</sheetData></worksheet>'


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return f'<c t="inlineStr"><is><t>{escape(value)}</t></is></c>'
    return f"<c><v>{float(value)!r}</v></c>"


def write_old_workbook(path: Path, sheets: Mapping[str, Sequence[Sequence[Any]]]) -> Path:
    """Write rows of texts and numbers as the sheets of an xls file (BIFF8), as phyphox on Android does."""
    bodies = [_biff_sheet(rows) for rows in sheets.values()]
    names = [struct.pack("<BB", len(name), 0) + name.encode("latin-1") for name in sheets]
    start = len(_biff(0x0809, _BIFF_GLOBALS)) + sum(len(_biff(0x0085, b"\0" * 6 + name)) for name in names)
    start += len(_biff(0x000A, b""))
    listed, at = b"", start
    for name, body in zip(names, bodies, strict=True):
        listed += _biff(0x0085, struct.pack("<IBB", at, 0, 0) + name)
        at += len(body)
    path.write_bytes(_compound_file(_biff(0x0809, _BIFF_GLOBALS) + listed + _biff(0x000A, b"") + b"".join(bodies)))
    return path


_BIFF_GLOBALS = struct.pack("<HHHHII", 0x0600, 0x0005, 0, 0, 0, 0)
_BIFF_SHEET = struct.pack("<HHHHII", 0x0600, 0x0010, 0, 0, 0, 0)


def _biff(number: int, content: bytes) -> bytes:
    return struct.pack("<HH", number, len(content)) + content


def _biff_sheet(rows: Sequence[Sequence[Any]]) -> bytes:
    parts = [_biff(0x0809, _BIFF_SHEET)]
    for i, row in enumerate(rows):
        for j, cell in enumerate(row):
            if isinstance(cell, str):
                text = cell.encode("utf-16-le")
                parts.append(_biff(0x0204, struct.pack("<HHHHB", i, j, 0, len(cell), 1) + text))
            elif cell is not None:
                parts.append(_biff(0x0203, struct.pack("<HHHd", i, j, 0, float(cell))))
    return b"".join([*parts, _biff(0x000A, b"")])


def _compound_file(stream: bytes) -> bytes:
    """Put a stream named Workbook into the container of Office's old files."""
    sector, free, end, fat_mark = 512, 0xFFFFFFFF, 0xFFFFFFFE, 0xFFFFFFFD
    stream += b"\0" * max(0, 4096 - len(stream))  # shorter streams are stored in another way
    size = len(stream)
    stream += b"\0" * (-size % sector)
    n = len(stream) // sector
    n_fat = next(k for k in range(1, 110) if k * 128 >= n + 1 + k)
    chain = [*range(1, n), end, end, *[fat_mark] * n_fat]
    chain += [free] * (n_fat * 128 - len(chain))

    def entry(name: str, kind: int, child: int, first: int, length: int) -> bytes:
        text = (name + "\0").encode("utf-16-le")
        head = text.ljust(64, b"\0") + struct.pack("<HBBIII", len(text), kind, 1, free, free, child)
        return head + b"\0" * 36 + struct.pack("<IQ", first, length)

    directory = entry("Root Entry", 5, 1, end, 0) + entry("Workbook", 2, free, 0, size)
    directory += (b"\0" * 68 + struct.pack("<III", free, free, free) + b"\0" * 48) * 2
    header = bytes.fromhex("D0CF11E0A1B11AE1") + b"\0" * 16
    header += struct.pack("<HHHHH", 0x3E, 3, 0xFFFE, 9, 6) + b"\0" * 6
    header += struct.pack("<IIIIIIIII", 0, n_fat, n, 0, 4096, end, 0, end, 0)
    header += struct.pack("<109I", *(n + 1 + k for k in range(n_fat)), *[free] * (109 - n_fat))
    return header + stream + directory + struct.pack(f"<{len(chain)}I", *chain)
