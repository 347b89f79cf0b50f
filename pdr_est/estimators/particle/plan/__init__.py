"""A floor plan as particles see it: walkable ground, walls in the way, and directions of the nearest walls."""
