"""The report of a walk over several floors: a picture, a plan and the times of each."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from storeys import BUILDING, TURNED, over_three_storeys

from pdr_est import pipeline
from pdr_est.pipeline import SmoothedWalk
from pdr_est.report.walk.panels import floor_panels
from pdr_est.report.walk.result_files import write_results
from pdr_est.report.walk.visited_floors import part_on_floor, visited_floors


@cache
def walk() -> SmoothedWalk:
    config = TURNED.with_estimator("particle")
    return pipeline.smooth_recording(over_three_storeys().recording, config, plan=BUILDING)


def test_floors_stand_in_order_with_the_times_of_each_visit() -> None:
    ground, first, second = visited_floors(walk())
    assert [floor.title for floor in (ground, first, second)] == ["floor 0", "floor 1", "floor 2"]
    assert [len(floor.on_plan_s) for floor in (ground, first, second)] == [1, 2, 1]
    (_, up_s), ((arrival_s, _), _) = ground.shown_s[0], first.on_plan_s
    assert up_s == arrival_s  # the stairs are shown with both floors
    assert first.shown_s[0][0] == ground.on_plan_s[0][1]


def test_a_visit_during_which_the_floor_becomes_less_probable_is_one_visit() -> None:
    ground, *others = walk().floors
    doubtful = replace(ground, time_s=0.5 * others[0].time_s, probability=0.8)
    split = replace(walk(), floors=(ground, doubtful, *others))
    assert visited_floors(split)[0].shown_s == visited_floors(walk())[0].shown_s
    panels, before = (floor_panels(one, over_three_storeys().recording, in_map_frame=True) for one in (split, walk()))
    assert panels[0].svg == before[0].svg


def test_the_line_of_a_floor_breaks_between_two_visits() -> None:
    first = visited_floors(walk())[1]
    part = part_on_floor(walk().track, first)
    missing = np.flatnonzero(np.isnan(part.position_m[:, 0]))
    assert len(missing) == 1
    assert part.time_s[missing[0]] >= first.shown_s[1][0]
    legs_m = np.hypot(*np.diff(part.position_m, axis=0).T)
    assert np.nanmax(legs_m) < 2.0


def test_each_floor_has_a_picture_and_numbers_of_its_own(tmp_path: Path) -> None:
    recording = over_three_storeys().recording
    panels = floor_panels(walk(), recording, in_map_frame=True)
    assert [panel.title for panel in panels] == ["Track on floor 0", "Track on floor 1", "Track on floor 2"]
    assert floor_panels(walk(), recording, in_map_frame=False) == []
    summary = write_results(tmp_path, walk(), recording, TURNED, {})
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert [one["floor"] for one in summary["floor_plans"]] == ["0", "1", "2"]
    assert summary["floor_plan"] == summary["floor_plans"][1]
    assert max(one["share_of_track_outside"] for one in summary["floor_plans"]) < 0.02
    data = json.loads(page.split('id="walk-data">')[1].split("</script>")[0])
    assert [one["name"] for one in data["floors"]] == ["0", "1", "2"]
    assert data["floors"][1]["spans_s"] == pytest.approx(
        np.minimum(visited_floors(walk())[1].shown_s, walk().track.time_s[-1] + 1.0)
    )
    assert data["background"] is None
