"""The page of a floor plan."""
