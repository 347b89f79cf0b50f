"""A window in square-root form against the least squares of all its rows at once."""

import numpy as np
import pytest

from pdr_est.estimators.fixed_lag.square_root import SquareRootWindow, present_rows
from pdr_est.frames import Array

DEVICES, STEPS, KEPT = 2, 250, 30


class AllRows:
    """Every row of a window, in the columns of all variables that there ever were."""

    def __init__(self, known: Array, right: Array) -> None:
        self.present = [[0, 1, 2], [3, 4, 5]]
        self.count, self.rows, self.right = 6, [], []
        self.add([0, 1, 2, 3, 4, 5], known, right)

    def add(self, columns: list[int], rows: Array, right: Array) -> None:
        whole = np.zeros((len(rows), 6 + 3 * STEPS))
        whole[:, columns] = rows
        self.rows.append(whole)
        self.right.append(right)

    def follow(self, device: int) -> tuple[list[int], list[int]]:
        before, new = self.present[device], list(range(self.count, self.count + 3))
        self.present[device], self.count = new, self.count + 3
        return before, new

    def solution(self) -> tuple[Array, Array]:
        rows, right = np.concatenate(self.rows)[:, : self.count], np.concatenate(self.right)
        return np.linalg.lstsq(rows, right, rcond=None)[0], np.linalg.inv(rows.T @ rows)


def test_values_and_covariances_are_those_of_all_rows_while_the_window_moves_on() -> None:
    """Also while one device stands still, and beyond the memory that the window begins with."""
    rng = np.random.default_rng(0)
    known, right = rng.standard_normal((6, 6)), rng.standard_normal(6)
    window, whole = SquareRootWindow(present_rows(known, right)), AllRows(known, right)
    followed: list[tuple[int, list[int]]] = []
    for step in range(STEPS):
        device = 0 if 100 <= step < 130 else int(rng.random() < 0.3)
        place, other = slice(3 * device, 3 * device + 3), 1 - device
        of_before, of_present, wanted = (rng.standard_normal(shape) for shape in ((4, 3), (4, 6), 4))
        first = window.follow(place, of_before, of_present, wanted)
        before, new = whole.follow(device)
        columns = [*before, *new, *whole.present[other]]
        parts = of_before, of_present[:, place], of_present[:, 3 * other : 3 * other + 3]
        whole.add(columns, np.concatenate(parts, axis=1), wanted)
        followed.append((first, before))
        row, wanted = rng.standard_normal((1, 6)), rng.standard_normal(1)
        window.merge(row, wanted)
        whole.add([*whole.present[0], *whole.present[1]], row, wanted)
        if step >= KEPT:
            window.forget(followed[step - KEPT][0])
        if step % 25 == 0 or step == 128:
            assert_same(window, whole, followed[max(0, step - KEPT) :])


def assert_same(window: SquareRootWindow, whole: AllRows, followed: list[tuple[int, list[int]]]) -> None:
    value, covariance = whole.solution()
    present = window.present_changes()
    assert present == pytest.approx(value[[*whole.present[0], *whole.present[1]]], rel=1e-6, abs=1e-8)
    complete = [column for _, columns in followed for column in columns]
    assert window.complete_changes(present) == pytest.approx(value[complete], rel=1e-6, abs=1e-8)
    oldest, columns = followed[0]
    for own, found in ((columns, window.of_complete(oldest, 3)), (whole.present[1], window.of_present(slice(3, 6)))):
        assert found[0] == pytest.approx(value[own], rel=1e-6, abs=1e-8)
        assert found[1] == pytest.approx(covariance[np.ix_(own, own)], rel=1e-6, abs=1e-8)


def test_what_nothing_is_known_of_has_no_solution() -> None:
    window = SquareRootWindow(present_rows(np.diag([1.0, 1.0, 1.0, 1.0, 1.0, 0.0]), np.zeros(6)))
    with pytest.raises(ArithmeticError, match="is zero"):
        window.present_changes()
