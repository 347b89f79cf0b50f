"""The command line `pdr-est`. Only here do errors become exit codes: 2 for bad input, with one line on stderr."""

import io
import re
import sys

import click

from pdr_est import __version__
from pdr_est.cli.benchmark import benchmark
from pdr_est.cli.demo import demo
from pdr_est.cli.inspect import inspect
from pdr_est.cli.smooth import smooth
from pdr_est.errors import PdrError


class BadInput(click.ClickException):
    """Exit code 2 and one line."""

    exit_code = 2

    def format_message(self) -> str:
        return re.sub(r"\s*\n\s*", " ", self.message)


class _Group(click.Group):
    """A group whose commands report bad input and wrong options in one line, without a traceback."""

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


for command in (inspect, smooth, benchmark, demo):
    main.add_command(command)
