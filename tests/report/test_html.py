"""The report is one page that holds the numbers, loads nothing and believes no name."""

import base64
import hashlib
import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from pdr_est.estimators.person.track import fuse
from pdr_est.report.page_templates import (
    format_duration,
    format_metric_with_unit,
    format_number,
    format_time_span,
)
from pdr_est.report.walk.page import SCRIPTS, render_report
from pdr_est.report.walk.summary import package_versions, summarise
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import StartPose
from pdr_est.types.sensors import Gap
from pdr_est.types.track import concatenate

VOID = {"meta", "link", "br", "img", "input", "hr"}
CONFIG = {"estimator": {"name": "factor-graph"}, "resample": {"rate_hz": 50.0}}


class Page(HTMLParser):
    """Checks that tags are balanced; collects text, attributes and tag names."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str]] = []
        self.words: list[str] = []
        self.scripts: list[str] = []  # what runs
        self.data: list[str] = []
        self.feed(text)
        self.close()
        assert not self.open, f"never closed: {self.open}"

    def handle_starttag(self, tag: str, attrs: list) -> None:
        self.handle_startendtag(tag, attrs)
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list) -> None:
        self.tags.append(tag)
        if tag == "script":
            self.last_script = dict(attrs).get("type", "")
        self.attributes += [(name, value or "") for name, value in attrs]

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open[-1:] != ["script"]:
            self.words.append(data)
        elif self.last_script == "application/json":
            self.data.append(data)
        else:
            self.scripts.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


def render(walk, recording, **options) -> str:
    summary = summarise(walk, recording, CONFIG, {"walk.zip": "c0ffee" * 10}, package_versions(), **options)
    return render_report(walk, recording, summary)


def test_page_holds_the_numbers(make_walk) -> None:
    walk, recording = make_walk(steps=120)
    walk = replace(walk, warnings=("fix at 912.0 s lies after the end",))
    gap = Gap("rotation_rate", 20.0, 23.25, "gap")
    walk = replace(walk, devices=(replace(walk.devices[0], gaps=(gap,)),))
    page = Page(render(walk, recording, errors={"error_heldout_m": 0.834, "coverage95": 0.9444}))
    for expected in (
        "morning loop",
        f"{walk.track.distance_m:.1f} m",
        "steps 120",
        "1 min 08 s",
        "factor-graph (smoothed)",
        "1.034 ± 0.012",
        "4 (4 waypoint)",
        "HOLDING 100.0 % 120 100.0 %",
        "fix at 912.0 s lies after the end",
        "rotation_rate gap 20.00 s 23.25 s 3.25 s",
        "error_heldout_m 0.83 m",
        "coverage95 0.944",
        "rate_hz: 50.0",
        "walk.zip c0ffee",
        f"numpy {np.__version__}",
        "signs: Android, the phone lay face up at rest",
        "2023-11-14 22:13 UTC",
    ):
        assert expected in page.text, expected


def test_the_person_has_steps_and_no_samples(make_walk) -> None:
    walk, recording = make_walk(steps=40, devices=("1L", "2R"))
    person = fuse(walk.track)
    walk = replace(walk, track=concatenate([walk.track, person]))
    words = [word.strip() for word in Page(render(walk, recording)).words if word.strip()]
    row = words.index("fused", words.index("Devices"))
    assert words[row + 1] == str(len(person) - 1)
    assert words[row + 6 : row + 8] == ["–", "–"]


def test_page_loads_nothing_and_runs_only_its_own_scripts(make_walk) -> None:
    walk, recording = make_walk(steps=3000, devices=("1L", "2R"))  # enough for the layers drawn as images
    text = render(walk, recording)
    assert "data:image/png;base64," in text
    page = Page(text)
    without_scripts = text
    for script in page.scripts:
        without_scripts = without_scripts.replace(script, "")
    assert "http:" not in without_scripts
    assert "https:" not in without_scripts
    assert "@import" not in without_scripts
    assert all(target.startswith("#") for target in re.findall(r"url\(([^)]*)\)", without_scripts))
    for name, value in page.attributes:
        if name in {"src", "xlink:href", "srcset", "data", "action", "poster"}:
            assert value.startswith(("#", "data:image/png")), (name, value[:60])
        if name == "href":  # a download is a file beside the page
            assert re.match(r"#|data:image/png|[\w-]+(\.\w+)?$", value), value[:60]
        assert not name.startswith("on"), name
    assert not {"iframe", "object", "embed", "link", "base"} & set(page.tags)
    ids = [value for name, value in page.attributes if name == "id"]
    assert len(ids) == len(set(ids))


def test_the_policy_allows_the_scripts_of_the_page_and_no_other(make_walk) -> None:
    walk, recording = make_walk(steps=30)
    page = Page(render(walk, recording))
    policy = next(value for name, value in page.attributes if value.startswith("default-src 'none'"))
    allowed = re.findall(r"'sha256-([^']+)'", policy)
    digests = [base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in page.scripts]
    assert allowed == digests
    assert re.sub(r" 'sha256-[^']+'", "", policy) == (
        "default-src 'none'; script-src; style-src 'unsafe-inline'; img-src data: blob:"
    )


def test_names_and_messages_are_text_and_never_markup(make_walk) -> None:
    hostile = '<script>alert("x")</script> $\\frac{1}$ \'"&'
    walk, recording = make_walk(steps=30, devices=(hostile, "_hidden"))
    device = replace(recording.devices[0], model=hostile, warnings=(hostile,), decisions=(hostile,))
    recording = replace(recording, name=hostile, format=hostile, devices=(device,), notes=(hostile,))
    walk = replace(walk, warnings=(f"</section>{hostile}",), timings_s={hostile: 1.0})
    text = render(walk, recording, errors={hostile: 1.0})
    page = Page(text)
    assert len(page.scripts) == len(SCRIPTS) + 2  # and the two libraries
    assert sum("<script" in part for part in (*page.scripts, *page.data)) == 0
    assert json.loads(page.data[0])["devices"][0]["name"] == hostile
    assert page.text.count('<script>alert("x")</script> $\\frac{1}$ \'"&') >= 9
    assert "_hidden" in page.text


def test_findings_have_a_section_of_their_own_and_are_not_told_twice(make_walk) -> None:
    walk, recording = make_walk(steps=30, devices=("1L", "2R"))
    bad = Finding(FindingKind.FIXES, "gps disagrees by 14.0 m <b>", "1L", 5.0, 12.0, 14.0, 3.0)
    chosen = Finding(FindingKind.FIX_CLOCK, "the clock of gps is 3.0 s late", doubtful=False)
    track = replace(walk.track, findings=(chosen, bad))
    page = Page(render(replace(walk, track=track, warnings=(bad.words, "1L: stuck")), recording))
    assert (
        "What does not fit when device about finding 5.0 to 12.0 s 1L fixes gps disagrees by 14.0 m <b>" in page.text
    )
    assert "whole walk all fix-clock the clock of gps is 3.0 s late (certain)" in page.text
    assert page.text.count("gps disagrees by 14.0 m") == 1
    assert "Warnings 1L: stuck" in page.text
    assert "does not fit Track" not in page.text
    assert "does not fit" in page.text[page.text.index("95 % region") :]  # the legend of the map
    only = Page(render(replace(walk, track=track, warnings=(bad.words,)), recording))
    assert "Warnings" not in only.text
    assert "does not fit" not in Page(render(walk, recording)).text


@pytest.mark.parametrize(
    ("begin_s", "end_s", "text"),
    [
        (None, None, "whole walk"),
        (3.04, 9.0, "3.0 to 9.0 s"),
        (3.0, 3.0, "3.0 s"),
        (None, 9.0, "until 9.0 s"),
        (3.0, None, "from 3.0 s on"),
    ],
)
def test_time_spans_read_well(begin_s: float | None, end_s: float | None, text: str) -> None:
    assert format_time_span(begin_s, end_s) == text


def test_names_in_other_scripts_are_kept(make_walk) -> None:
    walk, recording = make_walk(steps=30, devices=("左ポケット", "правая рука 🚶"))
    page = Page(render(walk, replace(recording, name="散歩 – Weg zur Universität")))
    for name in ("散歩 – Weg zur Universität", "左ポケット", "правая рука 🚶"):
        assert name in page.text


def test_characters_that_turn_a_text_round_are_shown(make_walk) -> None:
    walk, recording = make_walk(steps=30, devices=("phone\u202eenohp",))
    text = render(replace(walk, warnings=("a\u2067b",)), replace(recording, name="walk\u202eklaw"))
    page = Page(text)
    assert not set(text) & {"\u202e", "\u2067"}
    for shown in (r"walk\u202eklaw", r"phone\u202eenohp", r"a\u2067b"):
        assert shown in page.text
    assert json.loads(page.data[0])["devices"][0]["name"] == r"phone\u202eenohp"


def test_walk_without_a_step_has_a_page(make_walk) -> None:
    walk, recording = make_walk(steps=0, with_truth=False)
    page = Page(render(replace(walk, warnings=("phone: no step found",)), recording))
    assert "the track is a single point" in page.text
    assert "phone: no step found" in page.text
    assert "step length" not in page.text
    bare = replace(walk, devices=(replace(walk.devices[0], level=()),))
    assert "single point" in Page(render(bare, recording)).text


def test_truth_is_laid_onto_a_track_in_a_frame_of_its_own(make_walk) -> None:
    walk, recording = make_walk(steps=100)
    free = replace(walk, fixes=())
    assert "truth was rotated and shifted" in Page(render(free, recording)).text
    tied = Page(render(free, recording, start=StartPose((0.0, 0.0), 0.0))).text
    assert "truth (waypoints)" in tied
    assert "rotated and shifted" not in tied


@pytest.mark.slow
def test_very_long_walk_stays_small(make_walk) -> None:
    walk, recording = make_walk(steps=50_000)
    text = render(walk, recording)
    assert len(text.encode()) < 5_000_000
    assert "50\u202f000" in text


def test_many_gaps_are_cut_with_a_word_about_it(make_walk) -> None:
    walk, recording = make_walk(steps=20)
    gaps = tuple(Gap("attitude", float(n), n + 0.6, "gap") for n in range(130))
    page = Page(render(replace(walk, devices=(replace(walk.devices[0], gaps=gaps),)), recording))
    assert "and 30 more, listed in summary.json" in page.text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "–"),
        (8.44, "8.4 s"),
        (59.98, "1 min 00 s"),
        (185.0, "3 min 05 s"),
        (3599.6, "1 h 00 min"),
        (7620.0, "2 h 07 min"),
    ],
)
def test_durations_read_well(value: float | None, text: str) -> None:
    assert format_duration(value) == text


def test_numbers_carry_the_unit_of_their_name() -> None:
    assert format_number(-12345.678, 1) == "−12\u202f345.7"
    assert format_metric_with_unit(0.834, "ate_rigid_m") == "0.83 m"
    assert format_metric_with_unit(2.5, "phone · turn_error_deg") == "2.50 °"
    assert format_metric_with_unit(0.9444, "coverage95") == "0.944"
    assert format_metric_with_unit(3, "n") == "3"
    assert format_metric_with_unit(None, "ate_rigid_m") == "–"
