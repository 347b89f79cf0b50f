"""Robust DR's constrained optimum against numerical ones, and against the conditions that prove an optimum."""

from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import brentq, minimize, nnls, root

from pdr_est.errors import EstimationError
from pdr_est.estimators.robust_dr.constrained_map import closed_form, general, general_many
from pdr_est.frames import Array, rotation_matrix

LIMIT_M = 0.15  # twice the paper's R
EXACT = 1e-9
SLSQP_EXACT = 1e-7  # three devices or more: a cost known to 1e-16 tells its argument to about the root of that


def covariance(rng: np.random.Generator, decades: float = 1.0) -> Array:
    """Any positive definite matrix; variances spread over so many factors of ten on each side of 1 m^2."""
    axes = rotation_matrix(rng.uniform(0.0, np.pi))
    return np.asarray(axes @ np.diag(10.0 ** rng.uniform(-decades, decades, 2)) @ axes.T)


def estimates(rng: np.random.Generator, count: int, size_m: float = 3.0) -> Array:
    return 20.0 * rng.standard_normal(2) + size_m * rng.standard_normal((count, 2))


def cost(positions: Array, estimates_m: Array, covariances: Array) -> float:
    error = positions.reshape(-1, 2) - estimates_m
    return float(np.einsum("ni,nij,nj->", error, np.linalg.inv(covariances), error))


def best_direction(estimates_m: Array, covariances: Array) -> Array:
    """Eqs. 8-20 numerically: l_a of eqs. 13 and 14 for any phi, and the phi that eq. 15 holds for."""
    (a, b), (of_a, of_b) = estimates_m, np.linalg.inv(covariances)

    def positions(phi: float) -> Array:
        q = LIMIT_M * np.array([np.cos(phi), np.sin(phi)])
        first = np.linalg.solve(of_a + of_b, of_a @ a + of_b @ (b - q))
        return np.array([first, first + q])

    def eq15(phi: float) -> float:
        return float((of_b @ (positions(phi)[1] - b)) @ [-np.sin(phi), np.cos(phi)])

    grid = np.linspace(-np.pi, np.pi, 721)
    lowest = grid[np.argmin([cost(positions(phi), estimates_m, covariances) for phi in grid])]
    return positions(brentq(eq15, lowest - 0.01, lowest + 0.01, xtol=1e-15, rtol=1e-15))


def numerical(estimates_m: Array, covariances: Array, pairs: list[tuple[int, int]], limits: Array) -> Array:
    """SLSQP tells which tethers are taut, and the stationarity conditions with those are solved to the last digit."""
    rows, columns = np.array(pairs).T

    def slack(x: Array) -> Array:
        points = x.reshape(-1, 2)
        return np.asarray(limits**2 - np.sum((points[rows] - points[columns]) ** 2, axis=1))

    middle = np.tile(estimates_m.mean(axis=0), len(estimates_m))
    options = {"ftol": 1e-15, "maxiter": 1000}
    constraint = {"type": "ineq", "fun": slack}
    found = minimize(cost, middle, (estimates_m, covariances), "SLSQP", constraints=constraint, options=options).x
    active = np.flatnonzero(slack(found) < 1e-5)
    information = np.linalg.inv(covariances)

    def conditions(unknown: Array) -> Array:
        points, multipliers = unknown[: estimates_m.size].reshape(-1, 2), unknown[estimates_m.size :]
        pull = np.einsum("nij,nj->ni", information, points - estimates_m)
        for row, multiplier in zip(active, multipliers, strict=True):
            i, j = pairs[row]
            pull[i] += multiplier * (points[i] - points[j])
            pull[j] += multiplier * (points[j] - points[i])
        return np.concatenate([pull.ravel(), slack(points.ravel())[active]])

    solved = root(conditions, np.concatenate([found, np.ones(len(active))]), method="lm", tol=1e-15)
    assert np.abs(conditions(solved.x)).max() < 1e-9
    return np.asarray(solved.x[: estimates_m.size].reshape(-1, 2))


def unbalanced(
    positions: Array, estimates_m: Array, covariances: Array, pairs: list[tuple[int, int]], limits: Array
) -> float:
    """What no pull of taut tethers can balance, relative to the largest pull: zero at the optimum and only there."""
    pull = np.einsum("nij,nj->ni", np.linalg.inv(covariances), positions - estimates_m)
    directions = []
    for (i, j), limit in zip(pairs, limits, strict=True):
        apart = positions[i] - positions[j]
        if np.hypot(*apart) > limit * (1.0 - EXACT):
            direction = np.zeros_like(positions)
            direction[i], direction[j] = apart, -apart
            directions.append(direction.ravel())
    size = np.abs(pull).max()
    if not directions:
        return float(size)
    return float(nnls(np.array(directions).T, -pull.ravel() / size)[1])


@pytest.mark.parametrize("seed", range(40))
def test_two_devices_are_at_the_numerical_optimum(seed: int) -> None:
    rng = np.random.default_rng(seed)
    given, sigmas = estimates(rng, 2), np.array([covariance(rng, 1.5), covariance(rng, 1.5)])
    fused = general(given, sigmas, LIMIT_M)
    np.testing.assert_allclose(fused, best_direction(given, sigmas), atol=EXACT)
    assert np.hypot(*(fused[1] - fused[0])) == pytest.approx(LIMIT_M, rel=EXACT)


@pytest.mark.parametrize("seed", range(20))
def test_equal_covariances_are_the_closed_form(seed: int) -> None:
    rng = np.random.default_rng(seed)
    given, round_one = estimates(rng, 2), np.tile(rng.uniform(0.1, 9.0) * np.eye(2), (2, 1, 1))
    expected = closed_form(given, LIMIT_M)
    np.testing.assert_allclose(general(given, round_one, LIMIT_M), expected, atol=EXACT)
    np.testing.assert_allclose(best_direction(given, round_one), expected, atol=EXACT)


def test_closed_form_lies_on_the_line_at_the_paper_s_radius() -> None:
    fused = closed_form(np.array([[1.0, 2.0], [4.0, 6.0]]), 1.0)
    np.testing.assert_allclose(fused, [[2.2, 3.6], [2.8, 4.4]], atol=1e-15)


def test_estimates_within_reach_stay() -> None:
    given = np.array([[1.0, 1.0], [1.0, 1.15 - 1e-12]])
    sigmas = np.array([np.eye(2), 4.0 * np.eye(2)])
    for fused in (closed_form(given, LIMIT_M), general(given, sigmas, LIMIT_M)):
        np.testing.assert_array_equal(fused, given)


def test_coincident_estimates_stay_whatever_their_covariances() -> None:
    given = np.full((3, 2), 7.0)
    np.testing.assert_array_equal(closed_form(given[:2], LIMIT_M), given[:2])
    np.testing.assert_array_equal(general_many(given, np.zeros((3, 2, 2)), [(0, 1), (1, 2)], np.full(2, 0.1)), given)


def test_a_certain_device_moves_the_other() -> None:
    given, sigmas = np.array([[0.0, 0.0], [3.0, 4.0]]), np.array([np.zeros((2, 2)), np.eye(2)])
    np.testing.assert_allclose(general(given, sigmas, 0.5), [[0.0, 0.0], [0.3, 0.4]], atol=1e-10)


def test_a_bad_phone_moves_nearly_alone() -> None:
    given, sigmas = np.array([[0.0, 0.0], [10.0, 0.0]]), np.array([np.eye(2), 99.0 * np.eye(2)])
    fused = general(given, sigmas, 1.0)
    np.testing.assert_allclose(fused, [[0.09, 0.0], [1.09, 0.0]], atol=1e-12)


@pytest.mark.parametrize("ratio", [1e4, 1e8, 1e11])
def test_needle_like_covariances(ratio: float) -> None:
    rng = np.random.default_rng(3)
    for _ in range(10):
        needles = []
        for _ in range(2):
            axes = rotation_matrix(rng.uniform(0.0, np.pi))
            needles.append(axes @ np.diag([1.0, 1.0 / ratio]) @ axes.T)
        given, sigmas = estimates(rng, 2), np.array(needles)
        fused = general(given, sigmas, LIMIT_M)
        assert np.hypot(*(fused[1] - fused[0])) == pytest.approx(LIMIT_M, rel=EXACT)
        # Seen from the common direction of least width the answer is well determined: eq. 15 in S itself.
        q = fused[1] - fused[0]
        moved = np.linalg.solve(sigmas.sum(axis=0), given[1] - given[0] - q)
        assert abs(moved[0] * q[1] - moved[1] * q[0]) < 1e-6 * np.hypot(*moved) * LIMIT_M


@pytest.mark.parametrize("count", [3, 4])
@pytest.mark.parametrize("seed", range(15))
def test_several_devices_are_at_the_numerical_optimum(count: int, seed: int) -> None:
    rng = np.random.default_rng([seed, count])
    given, sigmas = estimates(rng, count), np.array([covariance(rng, 0.7) for _ in range(count)])
    pairs = list(combinations(range(count), 2))
    limits = rng.uniform(0.5, 1.5, len(pairs))
    fused = general_many(given, sigmas, pairs, limits)
    np.testing.assert_allclose(fused, numerical(given, sigmas, pairs, limits), atol=EXACT)


@pytest.mark.parametrize("seed", range(60))
def test_every_answer_satisfies_the_conditions_of_an_optimum(seed: int) -> None:
    rng = np.random.default_rng([seed, 9])
    count = int(rng.integers(2, 6))
    given = estimates(rng, count, 10.0 ** rng.uniform(-1.5, 2.0))
    sigmas = np.array([covariance(rng, 1.5) for _ in range(count)])
    pairs = list(combinations(range(count), 2))
    limits = np.full(len(pairs), LIMIT_M) if seed % 2 else rng.uniform(0.1, 1.0, len(pairs))
    fused = general_many(given, sigmas, pairs, limits)
    rows, columns = np.array(pairs).T
    assert np.all(np.hypot(*(fused[rows] - fused[columns]).T) <= limits * (1.0 + EXACT))
    assert unbalanced(fused, given, sigmas, pairs, limits) < (EXACT if count == 2 else SLSQP_EXACT)


def needle(rng: np.random.Generator, condition: float) -> Array:
    """Return a covariance with a variance of 1 m^2 along a random axis and 1 / condition of it across."""
    axes = rotation_matrix(rng.uniform(0.0, np.pi))
    return np.asarray(axes @ np.diag([1.0, 1.0 / condition]) @ axes.T)


def constructed(rng: np.random.Generator, condition: float) -> tuple[Array, Array, Array, float]:
    """Build a problem of three devices from its solution: optimum, estimates, covariances and the common limit.

    Positive multipliers of all pairs at the corners of an equilateral triangle fulfil the conditions of the optimum,
    e = l + S (sum of multiplier times separation), and the problem is convex: there is no other optimum.
    """
    corners = np.array([rotation_matrix(angle) @ [1.0, 0.0] for angle in np.array([0.0, 2.0, 4.0]) * np.pi / 3.0])
    optimum = LIMIT_M / np.sqrt(3.0) * corners @ rotation_matrix(rng.uniform(0.0, np.pi)).T
    sigmas = np.array([needle(rng, condition) for _ in range(3)])
    pull = np.zeros((3, 2))
    for i, j in combinations(range(3), 2):
        force = rng.uniform(5.0, 50.0) * (optimum[i] - optimum[j])
        pull[i] += force
        pull[j] -= force
    return optimum, optimum + np.einsum("nij,nj->ni", sigmas, pull), sigmas, LIMIT_M


@pytest.mark.parametrize("condition", [1.0, 1e3, 1e9, 1e10, 1e11, 1e12])
@pytest.mark.parametrize("seed", range(5))
def test_ill_conditioned_devices_are_at_the_optimum_they_were_built_from(seed: int, condition: float) -> None:
    """The former interior-point method crashed on most of these from a condition of 1e9 on."""
    optimum, given, sigmas, limit = constructed(np.random.default_rng([seed, 3]), condition)
    fused = general_many(given, sigmas, [(0, 1), (0, 2), (1, 2)], np.full(3, limit))
    np.testing.assert_allclose(fused, optimum, atol=SLSQP_EXACT)


@pytest.mark.parametrize("condition", [1e9, 1e10, 1e11, 1e12])
@pytest.mark.parametrize("seed", range(10))
def test_several_needles_are_fused_within_the_limits(seed: int, condition: float) -> None:
    rng = np.random.default_rng([seed, int(np.log10(condition))])
    given, sigmas = estimates(rng, 3), np.array([needle(rng, condition) for _ in range(3)])
    fused = general_many(given, sigmas, [(0, 1), (0, 2), (1, 2)], np.full(3, LIMIT_M))
    assert max(np.hypot(*(fused[i] - fused[j])) for i, j in combinations(range(3), 2)) <= LIMIT_M * (1.0 + EXACT)


def test_the_conditions_notice_a_wrong_answer() -> None:
    given, sigmas = np.array([[0.0, 0.0], [3.0, 0.0]]), np.array([np.eye(2), 4.0 * np.eye(2)])
    wrong = closed_form(given, LIMIT_M)
    assert unbalanced(wrong, given, sigmas, [(0, 1)], np.array([LIMIT_M])) > 0.1


def test_three_devices_at_the_corners_of_a_triangle_shrink_it() -> None:
    corners = np.array([[np.cos(angle), np.sin(angle)] for angle in np.array([0.0, 2.0, 4.0]) * np.pi / 3.0])
    fused = general_many(corners, np.tile(np.eye(2), (3, 1, 1)), [(0, 1), (0, 2), (1, 2)], np.full(3, LIMIT_M))
    np.testing.assert_allclose(fused, corners * LIMIT_M / np.sqrt(3.0), atol=1e-12)


def test_a_device_in_the_middle_does_not_matter() -> None:
    line = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    fused = general_many(line, np.tile(np.eye(2), (3, 1, 1)), [(0, 1), (0, 2), (1, 2)], np.full(3, LIMIT_M))
    np.testing.assert_allclose(fused, [[1.0 - LIMIT_M / 2, 0.0], [1.0, 0.0], [1.0 + LIMIT_M / 2, 0.0]], atol=EXACT)


def test_devices_without_a_tether_stay() -> None:
    given = np.array([[0.0, 0.0], [1.0, 0.0], [50.0, 0.0]])
    fused = general_many(given, np.tile(np.eye(2), (3, 1, 1)), [(0, 1)], np.array([LIMIT_M]))
    np.testing.assert_allclose(fused[2], given[2], atol=1e-12)
    np.testing.assert_allclose(fused[:2], closed_form(given[:2], LIMIT_M), atol=1e-12)


def test_the_frame_does_not_matter() -> None:
    rng = np.random.default_rng(8)
    given, sigmas = estimates(rng, 3), np.array([covariance(rng) for _ in range(3)])
    pairs, limits = [(0, 1), (0, 2), (1, 2)], np.full(3, LIMIT_M)
    turn = rotation_matrix(1.1)
    expected = general_many(given, sigmas, pairs, limits) @ turn.T + [300.0, -50.0]
    turned = general_many(given @ turn.T + [300.0, -50.0], turn @ sigmas @ turn.T, pairs, limits)
    np.testing.assert_allclose(turned, expected, atol=EXACT)


def test_rounding_of_large_variances_is_no_asymmetry() -> None:
    """Of a walk of 50 000 steps: what is left off the diagonal differs in the last digits of the variances."""
    apart = np.array([[0.0, 0.0], [9.0, 0.0]])
    long = np.array([[[4e7, 3e7], [3e7, 3e7]], [[3.1e7, -187.79753112], [-187.79753131, 6.1e6]]])
    fused = general(apart, long, LIMIT_M)
    assert np.hypot(*(fused[1] - fused[0])) == pytest.approx(LIMIT_M)


def test_unusable_input_is_refused() -> None:
    apart, sigmas = np.array([[0.0, 0.0], [1.0, 0.0]]), np.tile(np.eye(2), (2, 1, 1))
    with pytest.raises(EstimationError, match="finite"):
        closed_form(np.array([[0.0, np.nan], [1.0, 0.0]]), LIMIT_M)
    with pytest.raises(EstimationError, match="positive"):
        general(apart, sigmas, 0.0)
    with pytest.raises(EstimationError, match="positive"):
        general(apart, 0.0 * sigmas, LIMIT_M)
    with pytest.raises(EstimationError, match="positive"):
        general(apart, -sigmas, LIMIT_M)
    with pytest.raises(EstimationError, match="symmetric"):
        general(apart, np.array([np.eye(2), [[1.0, 0.5], [0.0, 1.0]]]), LIMIT_M)
