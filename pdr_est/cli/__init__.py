"""The command line `pdr-est`.

Only here do errors become exit codes: 2 for bad input, with one line on stderr. Each command is a module in
`commands`, which holds arguments, options and help text and imports nothing slow; what the command does is in `work`.
Options that several commands share are in `options`, the words that they offer in `choices`.
"""

import re
from difflib import get_close_matches
from importlib import import_module
from types import MappingProxyType
from typing import Any

import click

from pdr_est.cli.process import (
    ended_by_signals,
    escape_unprintable,
    occupy_closed_streams,
    stdout_fault,
)
from pdr_est.errors import PdrError
from pdr_est.output.call_inputs import inputs_remembered
from pdr_est.output.visible_text import visible_text

COMMANDS = MappingProxyType(
    {
        "inspect": "inspect:inspect_command",
        "steps": "steps:steps_command",
        "smooth": "smooth:smooth_command",
        "track": "online.track:track_command",
        "live": "online.live:live_command",
        "calibrate": "calibrate:calibrate_command",
        "convert": "convert:convert_command",
        "benchmark": "benchmark:benchmark",
        "experiment": "experiment:experiment",
        "compare": "compare:compare",
        "evaluate": "evaluate:evaluate_command",
        "plan": "plan:plan_command",
        "config": "config:config",
        "train-gait": "train_gait:train_gait_command",
        "demo": "demo:demo_command",
    }
)
"""Module in `pdr_est.cli.commands` and function of each command, in the order of the help text."""


_LONGEST_MESSAGE = 2000


class BadInputError(click.ClickException):
    """Error that ends the program with exit code 2 and one line on stderr."""

    exit_code = 2

    def format_message(self) -> str:
        """Return the message in one line, without the middle of one that quotes very much."""
        line = visible_text(re.sub(r"\s*\n\s*", " ", self.message))
        left_out = len(line) - _LONGEST_MESSAGE
        if left_out <= 0:
            return line
        half = _LONGEST_MESSAGE // 2
        return f"{line[:half]} […{left_out} characters…] {line[-half:]}"


class _LazyGroup(click.Group):
    """Command group that reports bad input and wrong options in one line, without a traceback.

    A command is loaded when it is called, and its work when it is run: loading takes a second or more, in which a
    help text or a completed word has appeared already, and Ctrl-C must work from the beginning.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            near = get_close_matches(cmd_name, COMMANDS, n=1)
            hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(COMMANDS)}"
            raise click.UsageError(f"No such command {cmd_name!r}: {hint}", ctx)
        module, function = COMMANDS[cmd_name].split(":")
        command: click.Command = getattr(import_module(f"pdr_est.cli.commands.{module}"), function)
        return command

    def invoke(self, ctx: click.Context) -> object:
        try:
            with inputs_remembered():
                return super().invoke(ctx)
        except PdrError as error:
            raise BadInputError(str(error)) from error
        except MemoryError as error:
            raise BadInputError(
                f"{ctx.invoked_subcommand}: the memory of this computer is not enough: give a shorter part of the "
                "recording (--from, --to), fewer recordings, or more memory"
            ) from error
        except click.UsageError as error:
            command = ctx.command_path if error.ctx is None else error.ctx.command_path
            raise BadInputError(f"{error.format_message().rstrip('.')}; see {command} --help") from error

    def main(self, *args: Any, **kwargs: Any) -> Any:
        occupy_closed_streams()
        escape_unprintable()
        try:
            with ended_by_signals():
                return super().main(*args, **kwargs)
        except OSError as error:  # not from a file of results, whose writer has words of its own
            stdout_fault()
            fault = f"{error.filename or 'standard output'}: {error.strerror or error}"
        except SystemExit:
            unwritten = stdout_fault()
            if unwritten is None:
                raise
            fault = f"standard output: {unwritten}"
        click.echo(f"Error: {fault}: check whether there is space, and the right to use it", err=True)
        raise SystemExit(BadInputError.exit_code)


def _print_version(ctx: click.Context, _param: click.Parameter, wanted: bool) -> None:
    if wanted and not ctx.resilient_parsing:
        from pdr_est import __version__

        click.echo(f"pdr-est, version {__version__}")
        ctx.exit()


@click.group(cls=_LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_print_version,
    help="Show the version and exit.",
)
def main() -> None:
    """Estimate tracks of walking people, with honest uncertainty, from the inertial recordings of phones."""
