"""Robust dead reckoning: maximum a posteriori fusion of several devices on one body."""
