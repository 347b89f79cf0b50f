"""Write single files into a folder that may hold files of other origin, which are never replaced or removed."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from pdr_est.errors import OutputError
from pdr_est.output.atomic_output import MANIFEST, manifest, staged_file, written_files
from pdr_est.output.call_inputs import refuse_inputs_in_file
from pdr_est.output.write_errors import output_errors


class OwnFiles:
    """Files that this program writes into a folder, of which it keeps a list there.

    A file that is not on the list is of other origin. A name is put on the list before its file is written, so that
    a run that is killed in between can be started again.

    Parameters
    ----------
    folder
        The folder; it is made when the first file is written.
    inputs
        Files and folders that are read, which are never replaced or removed.
    """

    def __init__(self, folder: Path, inputs: Sequence[Path] = ()) -> None:
        self._folder, self._inputs = folder, tuple(inputs)

    def __contains__(self, name: object) -> bool:
        return name in written_files(self._folder)

    def refuse_foreign(self, names: Iterable[str]) -> None:
        """Raise OutputError if one of some names stands for a file of other origin."""
        own = written_files(self._folder)
        for name in names:
            if name not in own and (self._folder / name).exists():
                raise OutputError(
                    f"{self._folder / name}: exists and was not written by pdr-est: allow overwriting "
                    "(--overwrite) or choose another folder"
                )

    @contextmanager
    def staged(self, name: str, overwrite: bool = False) -> Iterator[Path]:
        """Provide an empty file that becomes the file of that name when the block ends without an error.

        Parameters
        ----------
        name
            Name of the file.
        overwrite
            True if a file of other origin may be replaced.

        Raises
        ------
        OutputError
            For a file of other origin, and for a folder that cannot be written to.
        """
        if not overwrite:
            self.refuse_foreign([name])
        with output_errors(self._folder):
            self._folder.mkdir(parents=True, exist_ok=True)
        with staged_file(self._folder / name, overwrite=True, inputs=self._inputs) as staging:
            self._record(name)
            yield staging

    def write(self, name: str, text: str, overwrite: bool = False) -> None:
        """Write a text, completely or not at all. Raises OutputError as `staged` does."""
        with self.staged(name, overwrite) as staging:
            staging.write_text(text, encoding="utf-8", errors="backslashreplace")

    def remove(self, names: Iterable[str]) -> None:
        """Remove those of some files that this program has written."""
        own = written_files(self._folder)
        for path in (self._folder / name for name in names if name in own):
            refuse_inputs_in_file(path, path.absolute(), self._inputs)
            with output_errors(path):
                path.unlink(missing_ok=True)

    def _record(self, name: str) -> None:
        own = written_files(self._folder)
        if name in own:
            return
        with staged_file(self._folder / MANIFEST, overwrite=True) as staging:
            staging.write_text(manifest({*own, name} - {MANIFEST}), encoding="utf-8")
