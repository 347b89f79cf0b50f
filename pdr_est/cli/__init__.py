"""The command line `pdr-est`. Only here do errors become exit codes: 2 for bad input, with one line on stderr."""

import io
import re
import sys
from difflib import get_close_matches
from importlib import import_module

import click

from pdr_est import __version__
from pdr_est.errors import PdrError

COMMANDS = (
    "inspect",
    "steps",
    "smooth",
    "track",
    "calibrate",
    "benchmark",
    "experiment",
    "compare",
    "config",
    "train-gait",
    "demo",
)
"""Each is a module of this package that holds the command under its own name, with _ for -."""


class BadInput(click.ClickException):
    """Exit code 2 and one line."""

    exit_code = 2

    def format_message(self) -> str:
        return re.sub(r"\s*\n\s*", " ", self.message)


class _Group(click.Group):
    """A group whose commands report bad input and wrong options in one line, without a traceback.

    A command is loaded when it is called: loading takes seconds, and Ctrl-C must work from the beginning.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            near = get_close_matches(cmd_name, COMMANDS, n=1)
            hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(COMMANDS)}"
            raise click.UsageError(f"No such command {cmd_name!r}: {hint}", ctx)
        name = cmd_name.replace("-", "_")
        command: click.Command = getattr(import_module(f"pdr_est.cli.commands.{name}"), name)
        return command

    def invoke(self, ctx: click.Context) -> object:
        _print_any_name()
        try:
            return super().invoke(ctx)
        except PdrError as error:
            raise BadInput(str(error)) from error
        except click.UsageError as error:
            command = ctx.command_path if error.ctx is None else error.ctx.command_path
            raise BadInput(f"{error.format_message().rstrip('.')}; see {command} --help") from error


def _print_any_name() -> None:
    """File names may hold bytes that are no text, and terminals know few letters: print those escaped."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="pdr-est")
def main() -> None:
    """Tracks of walking people, with honest uncertainty, from the inertial recordings of phones."""
