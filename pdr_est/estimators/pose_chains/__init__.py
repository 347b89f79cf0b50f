"""Poses of a walk that steps and tethers connect to neighbours in time only: Newton's method on banded matrices."""
