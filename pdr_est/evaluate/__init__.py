"""Evaluation against ground truth: time association, alignment, error metrics, consistency of covariances."""
