"""A computer with too little memory is told in one line, as other things that do not work."""

import pytest

from tests.support.cli_runs import run


@pytest.mark.parametrize("words", ["", "Unable to allocate 8 TiB"])
def test_too_little_memory_ends_with_exit_code_2_in_words(monkeypatch: pytest.MonkeyPatch, words: str) -> None:
    def fill(*_: object, **__: object) -> None:
        raise MemoryError(words)

    monkeypatch.setattr("pdr_est.cli.recording_part.read", fill)
    result = run("inspect", "any.csv")
    assert result.exit_code == 2
    assert "memory of this computer is not enough" in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
