"""Recursive filters whose output does not depend, to the last bit, on how the signal is cut.

A recursion takes one sample after the other, which is slow in Python. The signal is therefore divided into pieces of
`_PIECE` samples, counted from its first one. The output of a piece is the sum of two: that of its samples alone, as
if the filter had been at rest before, and that of the state in which the filter enters the piece. The first is
computed for many pieces at once, one sample of each after the other; the second is a known multiple of the state.
A piece that comes in several blocks is computed sample by sample, with the same multiplications and additions in the
same order. No matrices are multiplied, because the rounding of such products depends on their size.
"""

from collections.abc import Sequence

import numpy as np

from pdr_est.frames import Array

_PIECE = 16  # samples
_FEWEST_PIECES = 4  # fewer are computed faster sample by sample
_AT_ONCE = 4096  # samples; the numbers of more do not stay in the cache of a processor


class RecursiveFilter:
    """Second-order sections one after the other, which start in the steady state of their first sample.

    Parameters
    ----------
    sections : ndarray, shape (sections, 6)
        Coefficients of each section, as `butterworth` explains.
    """

    def __init__(self, sections: Array) -> None:
        self._sections = [_Section(row.tolist()) for row in sections]

    def reset(self) -> None:
        """Forget the past."""
        for section in self._sections:
            section.reset()

    def push(self, samples: Array) -> Array:
        """Filter samples of shape (n, k), at least one, column by column."""
        if len(samples) > _AT_ONCE:
            return np.concatenate([self.push(samples[i : i + _AT_ONCE]) for i in range(0, len(samples), _AT_ONCE)])
        for section in self._sections:
            samples = section.push(samples)
        return samples


class _Section:
    """Filter of second order; the arguments are those of `RecursiveFilter`."""

    def __init__(self, coefficients: Sequence[float]) -> None:
        b0, b1, b2, _, a1, a2 = coefficients
        self._coefficients = (b0, b1, b2, a1, a2)
        gain = (b0 + b1 + b2) / (1.0 + a1 + a2)
        self._steady = (b1 + b2 - (a1 + a2) * gain, b2 - a2 * gain)  # state for a constant input of 1
        # Without input the output is the first state, p, and the states become q - a1 p and -a2 p.
        powers = [np.eye(2)]
        for _ in range(_PIECE):
            powers.append(np.array([[-a1, 1.0], [-a2, 0.0]]) @ powers[-1])
        self._decay = np.array([power[0] for power in powers[:_PIECE]])
        self._decay_rows: list[list[float]] = self._decay.tolist()
        self._over_piece: list[float] = powers[_PIECE].ravel().tolist()
        self.reset()

    def reset(self) -> None:
        """Forget the past."""
        self._states: list[tuple[float, float, float, float]] | None = None
        self._phase = 0

    def push(self, samples: Array) -> Array:
        """Filter samples of shape (n, k), at least one."""
        if self._states is None:
            p, q = self._steady
            self._states = [(p * first, q * first, 0.0, 0.0) for first in samples[0].tolist()]
        begin = min(-self._phase % _PIECE, len(samples))
        pieces = (len(samples) - begin) // _PIECE
        if pieces < _FEWEST_PIECES:
            return self._one_by_one(samples, self._states)
        end = begin + pieces * _PIECE
        output = np.empty(samples.shape)
        for part, compute in (
            (slice(0, begin), self._one_by_one),
            (slice(begin, end), self._many_pieces),
            (slice(end, None), self._one_by_one),
        ):
            output[part] = compute(samples[part], self._states)
        return output

    def _one_by_one(self, samples: Array, states: list[tuple[float, float, float, float]]) -> Array:
        """Filter samples (n, k) and advance the states of the columns.

        A state is that before the piece, and that which the samples of the piece alone have left.
        """
        b0, b1, b2, a1, a2 = self._coefficients
        pp, pq, qp, qq = self._over_piece
        decay = self._decay_rows
        output = np.empty(samples.shape)
        phase = self._phase
        for column, (p, q, own_p, own_q) in enumerate(states):
            phase = self._phase
            found = []
            for x in samples[:, column].tolist():
                y = b0 * x + own_p
                of_p, of_q = decay[phase]
                found.append(y + (of_p * p + of_q * q))
                own_p, own_q = (b1 * x - a1 * y) + own_q, b2 * x - a2 * y
                phase += 1
                if phase == _PIECE:
                    p, q = (pp * p + pq * q) + own_p, (qp * p + qq * q) + own_q
                    phase, own_p, own_q = 0, 0.0, 0.0
            output[:, column] = found
            states[column] = (p, q, own_p, own_q)
        self._phase = phase
        return output

    def _many_pieces(self, samples: Array, states: list[tuple[float, float, float, float]]) -> Array:
        """Filter samples (n, k) of whole pieces, and advance the states of the columns."""
        columns = samples.shape[1]
        by_phase = np.ascontiguousarray(samples.reshape(-1, _PIECE, columns).swapaxes(0, 1))  # (phase, piece, column)
        with np.errstate(invalid="ignore", over="ignore"):  # as for numbers of Python
            output, own_p, own_q = self._at_rest(by_phase)
            p, q = self._before_pieces(own_p, own_q, states)
            of_p, of_q = self._decay.T[:, :, None, None]
            output += of_p * p + of_q * q
        return output.swapaxes(0, 1).reshape(-1, columns)

    def _at_rest(self, samples: Array) -> tuple[Array, Array, Array]:
        """Filter pieces (phase, piece, column) as if at rest before each; also return the states after them."""
        b0, b1, b2, a1, a2 = self._coefficients
        output = b0 * samples
        by_b1, by_b2 = b1 * samples, b2 * samples
        p, q = np.zeros(samples.shape[1:]), np.zeros(samples.shape[1:])
        term = np.empty_like(p)
        for y, with_b1, with_b2 in zip(output, by_b1, by_b2, strict=True):
            y += p
            np.subtract(with_b1, np.multiply(a1, y, out=term), out=p)
            p += q
            np.subtract(with_b2, np.multiply(a2, y, out=term), out=q)
        return output, p, q

    def _before_pieces(
        self, own_p: Array, own_q: Array, states: list[tuple[float, float, float, float]]
    ) -> tuple[Array, Array]:
        """Compute the states before each piece from what each has left, (piece, column), and advance the states."""
        pp, pq, qp, qq = self._over_piece
        before_p, before_q = np.empty_like(own_p), np.empty_like(own_q)
        for column, (p, q, _, _) in enumerate(states):
            all_p, all_q = [p], [q]
            for left_p, left_q in zip(own_p[:, column].tolist(), own_q[:, column].tolist(), strict=True):
                p, q = (pp * p + pq * q) + left_p, (qp * p + qq * q) + left_q
                all_p.append(p)
                all_q.append(q)
            before_p[:, column], before_q[:, column] = all_p[:-1], all_q[:-1]
            states[column] = (p, q, 0.0, 0.0)
        return before_p, before_q
