"""Lines of tracks keep their shape within the tolerance, and every point comes back from the text."""

import numpy as np
import pytest

from pdr_est.report.comparison.line_encoding import encode_lines, simplify_lines

SIGNS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"


def decoded(text: str, step_m: float) -> np.ndarray:
    """Points of a line as `comparison_data.js` reads them."""
    numbers, number, shift = [], 0, 0
    for sign in text:
        bits = SIGNS.index(sign)
        number |= (bits & 31) << shift
        shift += 5
        if not bits & 32:
            numbers.append(-(number + 1) // 2 if number % 2 else number // 2)
            number, shift = 0, 0
    return step_m * np.cumsum(np.array(numbers, dtype=float).reshape(-1, 2), axis=0)


def walk(n: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    heading = np.cumsum(np.where(rng.random(n) < 0.05, 1.57, 0.02 * rng.standard_normal(n)))
    return 0.7 * np.cumsum(np.column_stack([np.cos(heading), np.sin(heading)]), axis=0)


def distance_to_line(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Distance of each point (n, 2) from the nearest piece of a line."""
    if len(line) == 1:
        return np.linalg.norm(points - line, axis=1)
    begin, chord = line[:-1], np.diff(line, axis=0)
    own = points[:, None] - begin
    share = np.clip((own * chord).sum(-1) / np.maximum((chord**2).sum(-1), 1e-12), 0.0, 1.0)
    return np.linalg.norm(own - share[..., None] * chord, axis=2).min(axis=1)


@pytest.mark.parametrize("step_m", [0.01, 0.5])
def test_every_point_comes_back_within_half_a_step(step_m: float) -> None:
    lines = [walk(200, 1), np.empty((0, 2)), -1e6 + walk(3, 2), np.array([[-0.004, 3e6]])]
    texts = encode_lines(lines, [step_m] * 4)
    assert texts[1] == ""
    for line, text in zip(lines, texts, strict=True):
        np.testing.assert_allclose(decoded(text, step_m), line, atol=0.5 * step_m + 1e-6)


@pytest.mark.parametrize("tolerance_m", [0.02, 0.3])
def test_points_that_are_left_out_lie_within_the_tolerance(tolerance_m: float) -> None:
    lines = [walk(500, 3), walk(2, 4), walk(1, 5), np.empty((0, 2)), walk(301, 6)]
    shown = simplify_lines(lines, [tolerance_m] * 5, 4000)
    assert [len(line) for line in shown[1:4]] == [2, 1, 0]
    for line, simple in zip(lines, shown, strict=True):
        if len(line):
            np.testing.assert_array_equal(simple[[0, -1]], line[[0, -1]])
            assert distance_to_line(line, simple).max() <= tolerance_m * (1 + 1e-9)
    assert len(shown[0]) < 0.6 * len(lines[0])


def test_a_turn_back_on_the_same_way_is_kept() -> None:
    there = np.column_stack([np.arange(0.0, 51.0), np.zeros(51)])
    (shown,) = simplify_lines([np.vstack([there, there[::-1][1:]])], [0.02], 100)
    np.testing.assert_array_equal(shown, [[0.0, 0.0], [50.0, 0.0], [0.0, 0.0]])


def test_a_line_has_at_most_so_many_points() -> None:
    (shown,) = simplify_lines([walk(900, 7)], [0.0], 24)
    assert len(shown) == 24
