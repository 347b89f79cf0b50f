"""JSON schemas of configuration files, for editors; the docstrings of the settings are the descriptions."""

from typing import Any

from pydantic import TypeAdapter

from pdr_est.config import Config
from pdr_est.experiment.config import ExperimentConfig
from pdr_est.params.field_docstrings import DescribedJsonSchema

Json = dict[str, Any]

_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_DOTTED = r"^[a-z_]+(\.[a-z0-9_]+)+$"


def settings_schema() -> Json:
    """Make the JSON schema of a settings file; settings may be sections or dotted keys."""
    document = {**_schema(Config), "patternProperties": {_DOTTED: {}}}
    return {"$schema": _DIALECT, **document, "title": "pdr-est settings"}


def experiment_schema() -> Json:
    """Make the JSON schema of an experiment file; settings may be sections or dotted keys."""
    document = _schema(ExperimentConfig)
    settings = _schema(Config)
    sections = settings.pop("$defs")
    settings["patternProperties"] = {_DOTTED: {}}
    file = {"settings_file": {"type": "string", "description": "Relative to the experiment file."}}
    tracks = "Files of another program's tracks, such as ronin/{walk}.tum, relative to the experiment file."
    file["track_files"] = {"type": "string", "description": tracks}
    variant = {**settings, "title": "Variant", "properties": {**settings["properties"], **file}}
    properties = document["properties"]
    properties["settings"] = {"$ref": "#/$defs/Settings"}
    properties["variants"]["additionalProperties"] = {"anyOf": [{"$ref": "#/$defs/Variant"}, {"type": "null"}]}
    properties["sweep"]["propertyNames"] = {"pattern": _DOTTED}
    definitions = {**sections, **document.pop("$defs"), "Settings": settings, "Variant": variant}
    return {"$schema": _DIALECT, **document, "title": "pdr-est experiment", "$defs": definitions}


def _schema(record: type) -> Json:
    return TypeAdapter(record).json_schema(schema_generator=DescribedJsonSchema)
