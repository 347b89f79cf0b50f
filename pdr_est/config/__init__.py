"""The configuration of the whole system, from Python, dictionaries and YAML files.

* `records`: the record `Config` with its sections, one for each stage.
* `contradictions`: settings that are in range one by one but do not go together.
* `loading`: files and dictionaries to configurations; `settings` and `params.yaml_lines` are what it needs.
* `front_ends`: front ends by name, such as the textbook chain.
* `commented_yaml`: configurations to YAML.
"""

from pdr_est.config.commented_yaml import commented, config_to_yaml
from pdr_est.config.loading import (
    config_from_dict,
    config_to_dict,
    config_with,
    external_files,
    import_folders,
    load_config,
)
from pdr_est.config.records import PART_KEYS, Config, DevicesParams, EstimatorParams, Mounting, StartParams
from pdr_est.config.settings import merged

__all__ = [
    "PART_KEYS",
    "Config",
    "DevicesParams",
    "EstimatorParams",
    "Mounting",
    "StartParams",
    "commented",
    "config_from_dict",
    "config_to_dict",
    "config_to_yaml",
    "config_with",
    "external_files",
    "import_folders",
    "load_config",
    "merged",
]
