"""Track of a walk with several alternatives: a mixture, and what is told of it."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from pdr_est.estimators.alternatives.alternative import DECIDED, Alternative
from pdr_est.frames import wrap_angle
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.track import Track


def estimate_alternatives(alternatives: Sequence[Alternative], estimate: Callable[[Alternative], Track]) -> Track:
    """Return the track of the most probable alternative, with the covariance of the mixture about it.

    Parameters
    ----------
    alternatives
        As `alternatives_of` returns them.
    estimate
        Function that estimates the track of an alternative.
    """
    tracks = [estimate(one) for one in alternatives]
    likeliest = replace(tracks[0], findings=(*tracks[0].findings, *_undecided(alternatives)))
    if len(tracks) == 1:
        return likeliest
    weights = np.array([one.probability for one in alternatives])
    apart = np.array([one.position_m - likeliest.position_m for one in tracks])
    turned = np.array([wrap_angle(one.heading_rad - likeliest.heading_rad) for one in tracks])
    covariance = np.array([one.covariance_m2 for one in tracks]) + apart[..., :, None] * apart[..., None, :]
    variance = np.array([one.sigma_heading_rad**2 for one in tracks]) + turned**2
    return replace(
        likeliest,
        covariance_m2=np.einsum("k,knij->nij", weights, covariance),
        sigma_heading_rad=np.sqrt(weights @ variance),
    )


def _undecided(alternatives: Sequence[Alternative]) -> list[Finding]:
    """Report the turns and start headings that the measurements do not decide."""
    first, findings = alternatives[0], []
    others = alternatives[1:] if first.probability < DECIDED else ()
    for number, one in enumerate(first.timelines):
        probabilities = dict(first.open_turns[number])
        for i, node in enumerate(one.nodes):
            if any(
                other.timelines[number].nodes[i].heading_change_rad != node.heading_change_rad for other in others
            ):
                probabilities[i] = first.probability
        findings += [_open_turn(one.device, one.nodes[i].time_s, probabilities[i]) for i in sorted(probabilities)]
        if any(other.start_headings_rad[number] != first.start_headings_rad[number] for other in others):
            findings.append(_open_start(one.device, first.probability))
    return findings


def _open_turn(device: str, time_s: float, probability: float) -> Finding:
    """Report that the turn at a time is not decided."""
    return Finding(
        FindingKind.PLACEMENT,
        f"{device}: after the phone was put elsewhere at {time_s:.0f} s the direction of the walk is not certain: "
        f"that of the track has a probability of {probability:.0%}; its uncertainty covers the others, and a "
        "position fix later on would decide",
        device=device,
        begin_s=time_s,
        value=probability,
    )


def _open_start(device: str, probability: float) -> Finding:
    """Report that the start heading is not decided."""
    return Finding(
        FindingKind.START_HEADING,
        f"{device}: the measurements fit several start headings; the one of the track has a probability of "
        f"{probability:.0%}, and its uncertainty covers the others: give a start heading, or one more fix",
        device=device,
        value=probability,
    )
