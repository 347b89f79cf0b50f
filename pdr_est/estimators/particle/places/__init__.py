"""Walks that may begin anywhere on a plan: their modes, and how particles are shared between them."""
