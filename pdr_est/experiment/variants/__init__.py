"""Variants of the settings: on one axis for benchmarks, or from the variants and sweeps of an experiment file."""
