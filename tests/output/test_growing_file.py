"""A file that is followed while it grows."""

import sys
from pathlib import Path
from typing import TextIO

import pytest

from pdr_est.errors import OutputError
from pdr_est.output.growing_file import growing_file


def write_and_fail(stream: TextIO) -> None:
    stream.write("one\n")
    stream.flush()
    raise RuntimeError


pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="an open file keeps its name")


def test_it_appears_with_the_first_text_and_grows(tmp_path: Path) -> None:
    target = tmp_path / "lines.jsonl"
    target.write_text("old")
    with growing_file(target, overwrite=True, inputs=[]) as stream:
        assert target.read_text() == "old"
        stream.flush()
        assert target.read_text() == "old"
        stream.write("one\n")
        stream.flush()
        assert target.read_text() == "one\n"
        stream.write("two\n")
        stream.flush()
        assert target.read_text() == "one\ntwo\n"
    assert [path.name for path in tmp_path.iterdir()] == ["lines.jsonl"]


def test_an_error_keeps_the_old_file_until_there_is_text(tmp_path: Path) -> None:
    target = tmp_path / "lines.jsonl"
    target.write_text("old")
    with pytest.raises(RuntimeError), growing_file(target, overwrite=True, inputs=[]):
        raise RuntimeError
    assert target.read_text() == "old"
    with pytest.raises(RuntimeError), growing_file(target, overwrite=True, inputs=[]) as stream:
        write_and_fail(stream)
    assert target.read_text() == "one\n"
    assert [path.name for path in tmp_path.iterdir()] == ["lines.jsonl"]


def test_without_text_an_empty_file_appears_at_the_end(tmp_path: Path) -> None:
    with growing_file(tmp_path / "lines.jsonl", overwrite=False, inputs=[]):
        pass
    assert (tmp_path / "lines.jsonl").read_text() == ""


def test_what_is_read_or_there_is_refused(tmp_path: Path) -> None:
    target = tmp_path / "lines.jsonl"
    target.write_text("old")
    for overwrite, inputs, words in ((False, [], "exists already"), (True, [target], "lines.jsonl")):
        with (
            pytest.raises(OutputError, match=words),
            growing_file(target, overwrite=overwrite, inputs=inputs) as stream,
        ):
            stream.write("new")
        assert target.read_text() == "old"
