"""The records that pass between stages: frozen, arrays inside, SI units, map frame x east and y north."""
