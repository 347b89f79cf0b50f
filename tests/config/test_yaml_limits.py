"""Settings files that never end, repeat themselves without end or are no files are refused at once."""

from pathlib import Path

import pytest

from pdr_est.config import load_config
from pdr_est.errors import ConfigError
from pdr_est.params.yaml_lines import load_yaml


def repeated(levels: int, each: int) -> str:
    """Return a document in which each list names the one before it several times."""
    lines = [f"a0: &a0 [{', '.join(['1'] * each)}]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * each)}]" for i in range(1, levels)]
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (repeated(12, 9), r"settings\.yaml, line \d+: .* more than 1000000 values"),
        ("a: &a [1, *a]", r"line 1: .*an alias contains itself"),
        ("a: &a {b: *a}", r"line 1: .*an alias contains itself"),
        ("[" * 1500, "is not valid YAML"),
        ("#" * ((1 << 24) + 1), "is larger than 16 MiB"),
    ],
)
def test_documents_without_end(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "settings.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigError, match=message):
        load_config(path)


def test_a_device_that_never_ends() -> None:
    if not Path("/dev/zero").exists():
        pytest.skip("this system has no /dev/zero")
    with pytest.raises(ConfigError, match="is larger than 16 MiB"):
        load_config("/dev/zero")


def test_aliases_are_understood(tmp_path: Path) -> None:
    path = tmp_path / "settings.yaml"
    path.write_text("base: &base {x: 1, y: [1, 2]}\nother: *base\nmore: {<<: *base, x: 2}\n", encoding="utf-8")
    assert load_yaml(path) == {
        "base": {"x": 1, "y": [1, 2]},
        "other": {"x": 1, "y": [1, 2]},
        "more": {"x": 2, "y": [1, 2]},
    }
