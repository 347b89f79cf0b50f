"""Configurations as YAML, on request with the docstring of each setting as a comment."""

import textwrap
from collections.abc import Iterator, Mapping
from typing import Any

import yaml

from pdr_est.config.loading import config_to_dict
from pdr_est.config.records import Config
from pdr_est.params.field_docstrings import field_docstrings
from pdr_est.params.validation_messages import section_at

_WIDTH = 100


def config_to_yaml(config: Config, comments: bool = False) -> str:
    """Write the whole configuration as YAML, which `load_config` reads back to the same record.

    Parameters
    ----------
    config
        The configuration.
    comments
        True to put the docstring of each setting above it.
    """
    values = config_to_dict(config)
    return commented(values, Config) if comments else str(yaml.safe_dump(values, sort_keys=False))


def commented(values: Mapping[str, Any], record: type, variants: str | None = None) -> str:
    """Write sections as YAML with the docstring of each key as a comment above it.

    Parameters
    ----------
    values
        Plain values, nested by section.
    record
        Parameter record whose fields the keys are.
    variants
        Key of whole configurations by name; the settings of the first one get comments.
    """
    return "\n".join(_lines(values, record, "", variants)) + "\n"


def _lines(values: Mapping[str, Any], record: type, indent: str, variants: str | None = None) -> Iterator[str]:
    described = field_docstrings(record)
    for key, value in values.items():
        width = _WIDTH - len(indent)
        for paragraph in described.get(key, "").splitlines():
            yield from (f"{indent}# {line}" for line in textwrap.wrap(paragraph, width))
        section = section_at(record, (key,))
        if key == variants:
            yield f"{indent}{key}:"
            yield from _variants(value, f"{indent}  ")
        elif isinstance(value, dict) and value and isinstance(section, type):
            yield f"{indent}{key}:"
            yield from _lines(value, section, f"{indent}  ")
        else:
            text = yaml.safe_dump({key: value}, sort_keys=False, allow_unicode=True)
            yield from (f"{indent}{line}" for line in text.splitlines())


def _variants(variants: Mapping[str, Mapping[str, Any]], indent: str) -> Iterator[str]:
    for number, (name, settings) in enumerate(variants.items()):
        heading = yaml.safe_dump({name: None}, allow_unicode=True).removesuffix(" null\n")
        yield indent + heading
        if number == 0:
            yield from _lines(settings, Config, f"{indent}  ")
        else:
            text = yaml.safe_dump(dict(settings), sort_keys=False, allow_unicode=True)
            yield from (f"{indent}  {line}" for line in text.splitlines())
