"""Write a file that can be followed while it grows: it takes its name with the first text that is written."""

import io
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from pdr_est.output.atomic_output import place_of_file, publish_file
from pdr_est.output.staging import staging_folder
from pdr_est.output.write_errors import output_errors


@contextmanager
def growing_file(target: Path, overwrite: bool, inputs: Sequence[Path]) -> Iterator[TextIO]:
    """Provide a stream of UTF-8 text whose file appears, in place of an older one, when text is first flushed.

    If the block raises before, an existing target stays as it was. Afterwards the file holds what was flushed,
    whatever ends the program. On Windows, where an open file keeps its name, it appears at the end.

    Parameters
    ----------
    target
        File of the result.
    overwrite
        True when an existing file may be replaced.
    inputs
        Files and folders that are read, which are never overwritten.

    Raises
    ------
    OutputError
        As `staged_file` does.
    """
    resolved = place_of_file(target, overwrite, inputs)
    with output_errors(target), staging_folder(resolved) as folder:
        staging = folder / resolved.name

        def publish() -> None:
            if resolved.exists():
                shutil.copymode(resolved, staging)
            publish_file(staging, resolved, overwrite, target)

        with _GrowingText(staging, publish) as stream:
            yield stream
        if staging.exists():
            publish()


class _GrowingText(io.TextIOWrapper):
    """File of text that is published once it holds any."""

    def __init__(self, path: Path, publish: Callable[[], None]) -> None:
        self._file = path.open("wb")
        super().__init__(self._file, encoding="utf-8", newline="\n")
        self._publish: Callable[[], None] | None = None if sys.platform == "win32" else publish

    def flush(self) -> None:
        super().flush()
        if self._publish is not None and not self.closed and self._file.tell():
            publish, self._publish = self._publish, None
            publish()
