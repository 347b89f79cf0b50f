"""Work of `pdr-est convert`: choose a format by name or extension and write it."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

import click

from pdr_est.cli.call_paths import input_paths
from pdr_est.cli.recording_part import RecordingPart
from pdr_est.io.formats.exchange.parquet_table import write_parquet_recording
from pdr_est.io.formats.exchange.sensor_logger_folder import write_sensor_logger_folder
from pdr_est.io.formats.exchange.synchronised_arrays import write_hdf5, write_npz
from pdr_est.io.formats.plain_csv.writer import write_plain_csv
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.output.atomic_output import staged_file, staged_folder
from pdr_est.preprocessing.moments import Moment
from pdr_est.types.recording import Recording

_FOLDER = "sensor-logger"
FORMATS: Mapping[str, Callable[[Recording, Path], tuple[str, ...]]] = MappingProxyType(
    {
        "csv": write_plain_csv,
        "parquet": write_parquet_recording,
        _FOLDER: write_sensor_logger_folder,
        "npz": write_npz,
        "hdf5": write_hdf5,
    }
)
_SUFFIXES = MappingProxyType(
    {".csv": "csv", ".parquet": "parquet", ".npz": "npz", ".hdf5": "hdf5", ".h5": "hdf5", "": _FOLDER}
)


def convert_recording(
    recordings: tuple[Path, ...],
    output: Path,
    chosen: str | None,
    begin: Moment | None,
    end: Moment | None,
    devices: tuple[str, ...],
    mapping: TableMapping | None,
    overwrite: bool,
) -> None:
    """Write a recording of any known format in one that other programs read."""
    name = chosen or _SUFFIXES.get(output.suffix.lower())
    if name is None:
        raise click.UsageError(f"{output}: the extension tells no format: give --format {'|'.join(FORMATS)}")
    write = FORMATS[name]
    staged = staged_folder if name == _FOLDER else staged_file
    with staged(output, overwrite, input_paths()) as place:
        recording = RecordingPart(begin, end, devices, mapping).read_cut(recordings)
        left_out = write(recording, place)
    if name == _FOLDER and recording.epoch_s is None:
        click.echo(f"note: {output} has the date 2000-01-01, because that of the recording is not known", err=True)
    for words in left_out:
        click.echo(f"note: {output} has no place for {words}", err=True)
    click.echo(f"{recording.name}: {recording.format} -> {name}, {output}")
