"""Scoring of tracks, steps and lengths against ground truth, one module for each kind of ground truth."""
