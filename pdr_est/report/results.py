"""All the files of a smoothed walk."""

import json
from collections.abc import Mapping
from pathlib import Path

from pdr_est.config import Config, config_to_dict
from pdr_est.evaluate.metrics import against_truth
from pdr_est.io.recording import Recording
from pdr_est.io.writers import write_geojson, write_steps_csv, write_tum
from pdr_est.pipeline import SmoothedWalk
from pdr_est.report.html import render_report
from pdr_est.report.summary import Json, package_versions, summarise


def write_results(
    folder: Path, walk: SmoothedWalk, recording: Recording, config: Config, inputs: Mapping[str, str | None]
) -> Json:
    """Write track.csv, steps.csv, track.tum, track.geojson, summary.json and report.html; return the summary.

    inputs: name of each input file -> its SHA-256, or None. Raises OutputError when a file cannot be written.
    """
    summary = summarise(
        walk,
        recording,
        config_to_dict(config),
        inputs,
        package_versions(),
        start=config.start.pose(),
        errors=errors_against_truth(walk, recording),
    )
    origin = recording.origin if summary["frame"] == "map" else None
    walk.track.to_csv(folder / "track.csv")
    write_steps_csv({device.device: device.steps for device in walk.devices}, folder / "steps.csv")
    write_tum(walk.track, folder / "track.tum", recording.epoch_s)
    write_geojson(walk.track, folder / "track.geojson", origin, fixes=walk.fixes)
    (folder / "summary.json").write_text(json.dumps(summary, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    (folder / "report.html").write_text(render_report(walk, recording, summary), encoding="utf-8")
    return summary
