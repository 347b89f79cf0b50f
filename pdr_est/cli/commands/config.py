"""`pdr-est config`: which settings there are, and what a file leaves to the defaults."""

import json
from pathlib import Path

import click

from pdr_est.cli.options import PATH
from pdr_est.module_loading import loading_modules


@click.group()
def config() -> None:
    """Print the schema of configuration files, or a file with all settings that it leaves to the defaults."""


@config.command()
@click.option("--settings", is_flag=True, help="Of settings files, as --config takes them. Default: of experiments.")
def schema(settings: bool) -> None:
    """Print the JSON schema, for editors that complete and check YAML."""
    with loading_modules():
        from pdr_est.experiment.json_schema import experiment_schema, settings_schema

    click.echo(json.dumps(settings_schema() if settings else experiment_schema(), indent=2))


@config.command()
@click.argument("file", type=PATH)
@click.option("--data", type=PATH, metavar="DIR", help="Folder of an experiment's recordings.")
def show(file: Path, data: Path | None) -> None:
    """Print FILE, of settings or of an experiment, with every setting and what it means.

    An experiment is checked as before a run.
    """
    with loading_modules():
        from pdr_est.config import commented, config_to_yaml, load_config
        from pdr_est.params.yaml_lines import load_yaml

    content = load_yaml(file)
    if isinstance(content, dict) and "data" in content:
        with loading_modules():
            from pdr_est.experiment import load_experiment
            from pdr_est.experiment.config import ExperimentConfig

        resolved = load_experiment(file, data).resolved()
        click.echo(commented(resolved, ExperimentConfig, variants="variants"), nl=False)
    else:
        click.echo(config_to_yaml(load_config(file), comments=True), nl=False)
