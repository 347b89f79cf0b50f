"""The page of an experiment stands alone, parses, and shows every part that its data allow."""

import re
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from pdr_est.evaluate.metric_definitions import ALIGNED_NOTE
from pdr_est.evaluate.paired_comparison import PairedValues, compare_pairs
from pdr_est.report.comparison.page import ComparisonContent, render_comparison
from pdr_est.report.comparison.plots import plot_distribution, plot_growth
from pdr_est.report.comparison.tables import averages_table, groups_table, modes_table, pairs_table, steps_table
from pdr_est.types.outcome import TrackOutcome

METRICS = ("error_heldout_m", "coverage95")
PROVENANCE = {
    "version": "1",
    "commit": None,
    "seed": 0,
    "fingerprint": {"data": "c0ffee"},
    "packages": {"numpy": "2"},
}


def outcome(number: int, variant: str, error_m: float) -> TrackOutcome:
    truth_m = np.column_stack([np.arange(0.0, 50.0, 5.0), np.zeros(10)])
    return TrackOutcome(
        walk=f"walk{number}",
        track="device",
        variant=variant,
        labels={"group": "ab"[number % 2]},
        mode="HOLDING",
        metrics={"error_heldout_m": error_m, "coverage95": 0.9},
        steps=70,
        true_steps=72,
        mode_shares={"HOLDING": 0.75, "SWING": 0.25},
        with_fixes=True,
        position_m=truth_m + np.array([0.0, error_m]),
        truth_m=truth_m,
        way_m=truth_m[:, 0],
        error_m=np.full(10, error_m),
        squared=np.linspace(0.1, 8.0, 10),
    )


@pytest.fixture
def content() -> ComparisonContent:
    """Six walks; `far` is off by the number of the walk, `near` by a tenth of it."""
    far = [outcome(number, "far", float(number)) for number in range(1, 7)]
    near = [outcome(number, "near", 0.1 * number) for number in range(1, 7)]
    values = [{one.walk: one.metrics["error_heldout_m"] or 0.0 for one in rows} for rows in (far, near)]
    pairs = compare_pairs([PairedValues("error_heldout_m", "far", "near", *values)])
    return ComparisonContent(
        title="Far & <near>",
        variants=("far", "near"),
        metrics=METRICS,
        group_by=("group",),
        outcomes=tuple(one for both in zip(far, near, strict=True) for one in both),
        pairs=pairs,
        failed=1,
        failures=(("walk9", "no <step> found"),),
        config="data: {}\n",
        provenance=PROVENANCE,
    )


class Page(HTMLParser):
    """Elements that must be closed, what is referred to, and the headings."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.references: list[str] = []
        self.ids: set[str] = set()
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        for name, value in attributes:
            if name in ("href", "src"):
                self.references.append(value or "")
            if name == "id":
                assert value not in self.ids, f"id {value} twice"
                self.ids.add(value or "")
        if tag not in ("meta", "link", "br", "input"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_startendtag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attributes)
        self.open.pop()

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] in ("h1", "h2"):
            self.words.append(data)


def test_the_page_stands_alone_and_is_well_formed(content: ComparisonContent) -> None:
    text = render_comparison(content)
    markup = re.sub(r"<(script|style)([^>]*)>.*?</\1>", r"<\1\2></\1>", text, flags=re.DOTALL)
    styles = "".join(re.findall(r"<style>(.*?)</style>", text, flags=re.DOTALL))
    assert not re.search(r"@import|url\((?!#)", styles)
    assert "http:" not in markup
    assert "https:" not in markup
    assert "src=" not in markup
    page = Page(markup)
    assert page.open == []
    assert page.references
    assert all(reference.startswith(("#", "data:")) for reference in page.references)
    assert {reference[1:] for reference in page.references if reference.startswith("#")} <= page.ids


def test_every_part_is_there(content: ComparisonContent) -> None:
    assert Page(render_comparison(content)).words == [
        "Far & <near>",
        "All walks",
        "Walks",
        "Distribution of the errors",
        "Error against distance",
        "Consistency of the covariance",
        "Worst walk by error_heldout_m: walk6",
        "Median walk by error_heldout_m: walk3",
        "Best walk by error_heldout_m: walk1",
        "Walk by walk",
        "Means by group",
        "Steps",
        "Carrying modes",
        "Failures",
        "Definitions",
        "Provenance",
    ]


def without_truth(content: ComparisonContent) -> Iterator[TrackOutcome]:
    nothing = np.empty(0)
    for one in content.outcomes:
        bare = {"truth_m": np.empty((0, 2)), "way_m": nothing, "error_m": nothing, "squared": nothing}
        yield replace(one, **bare, with_fixes=False, metrics={**one.metrics, "coverage95": None})


def test_walks_without_true_positions_have_a_page_without_plots_of_errors(content: ComparisonContent) -> None:
    words = Page(render_comparison(replace(content, outcomes=tuple(without_truth(content)), failures=()))).words
    assert "Distribution of the errors" not in words
    assert "Consistency of the covariance" not in words
    assert "Best walk by error_heldout_m: walk1" in words


def test_an_experiment_without_any_outcome_has_a_page(content: ComparisonContent) -> None:
    words = Page(render_comparison(replace(content, outcomes=(), pairs=()))).words
    assert "Failures" in words


def test_more_variants_than_colours_are_told_apart_by_dashes(content: ComparisonContent) -> None:
    names = tuple(f"v{number}" for number in range(9))
    outcomes = tuple(outcome(walk, name, 1.0 + i) for walk in (1, 2) for i, name in enumerate(names))
    text = render_comparison(replace(content, variants=names, outcomes=outcomes, pairs=()))
    assert "stroke-dasharray" in text
    assert Page(text).open == []


def test_the_tables_hold_the_numbers(content: ComparisonContent) -> None:
    table = averages_table(content.outcomes, content.variants, METRICS)
    assert [cell.text for cell in table.rows[0]] == ["error_heldout_m (m)", "far", "3.500", "3.500", "5.500", "6"]
    assert [row[2].strong for row in table.rows] == [False, True, False, False]  # equal means: none is best
    rows = groups_table(content.outcomes, content.variants, METRICS, "group").rows
    assert [cell.text for cell in rows[0]] == ["error_heldout_m (m)", "a", "3", "4.000", "0.400"]
    counted = steps_table(content.outcomes, content.variants).rows[0]
    assert [cell.text for cell in counted] == ["HOLDING", "all variants", "6", "420", "432", "2.8 %"]
    other = replace(content.outcomes[0], steps=71)
    rows = steps_table((other, *content.outcomes[1:]), content.variants).rows
    assert [[cell.text for cell in row[1:4]] for row in rows] == [["far", "6", "421"], ["near", "6", "420"]]
    shares = modes_table(content.outcomes, content.variants)
    assert [cell.text for cell in shares.headings] == ["variant", "HOLDING", "SWING"]
    assert [[cell.text for cell in row] for row in shares.rows] == [["all variants", "75.0 %", "25.0 %"]]


def test_many_variants_stand_below_each_other(content: ComparisonContent) -> None:
    names = tuple(f"v{number}" for number in range(7))
    outcomes = tuple(outcome(walk, name, 1.0 + i) for walk in (1, 2, 4) for i, name in enumerate(names))
    table = groups_table(outcomes, names, METRICS, "group")
    assert [cell.text for cell in table.headings] == ["metric", "variant", "a", "b"]
    assert [cell.text for cell in table.rows[1]] == ["error_heldout_m (m)", "v1", "2.000", "2.000"]
    assert [cell.strong for cell in table.rows[0]] == [False, False, True, True]
    assert table.note == "Number of tracks: a 2, b 1."


@pytest.mark.parametrize("points", [1, 3, 10])
def test_few_errors_are_drawn_one_by_one(content: ComparisonContent, points: int) -> None:
    """Where no median can be told yet, the plot is not empty."""
    short = [replace(one, way_m=one.way_m[:points], error_m=one.error_m[:points]) for one in content.outcomes[:2]]
    axes = plot_growth(short, content.variants).axes[0]
    dots = [line for line in axes.lines if line.get_marker() == "."]
    assert [len(line.get_xdata()) for line in dots] == [points, points]
    many = [replace(one, way_m=np.arange(200.0), error_m=np.ones(200)) for one in short]
    assert all(line.get_marker() != "." for line in plot_growth(many, content.variants).axes[0].lines)


def test_a_variant_with_a_few_great_errors_does_not_press_the_others_together(content: ComparisonContent) -> None:
    near, far = content.outcomes[1], content.outcomes[0]
    outlying = replace(far, error_m=np.concatenate([np.full(8, 0.3), [20.0, 30.0]]))
    near = replace(near, error_m=np.full(10, 0.3))
    assert plot_distribution([outlying, near], content.variants).axes[0].get_xscale() == "log"
    assert plot_distribution([near], content.variants).axes[0].get_xscale() == "linear"


def test_variants_that_are_only_aligned_with_the_fixes_are_marked_where_that_matters(
    content: ComparisonContent,
) -> None:
    assert "far *" not in render_comparison(content)
    page = render_comparison(replace(content, aligned=("far",)))
    assert "<strong>far:</strong> This estimator takes no measurement from the position fixes" in page
    also_open = [replace(one, metrics={**one.metrics, "length_ratio": 1.0}) for one in content.outcomes]
    averages = averages_table(also_open, content.variants, ("error_heldout_m", "length_ratio"), ("far",))
    assert [row[1].text for row in averages.rows] == ["far *", "near", "far", "near"]
    assert averages.note.endswith(ALIGNED_NOTE)
    pairs = pairs_table(content.pairs, "", ("far",))
    assert [cell.text for cell in pairs.rows[0][1:3]] == ["far *", "near"]
    assert pairs.note.endswith(ALIGNED_NOTE)


def test_without_fixes_no_variant_is_aligned_with_them(content: ComparisonContent) -> None:
    bare = tuple(replace(one, with_fixes=False, metrics={"length_ratio": 1.0}) for one in content.outcomes)
    page = render_comparison(replace(content, aligned=("far",), outcomes=bare, metrics=("length_ratio",), pairs=()))
    assert "position fixes" not in page
