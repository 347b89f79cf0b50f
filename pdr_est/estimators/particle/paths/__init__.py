"""Summaries of the paths that the smoother draws: tracks, and mixtures for their poses."""
