"""Records of the places of a walk on its floor plan."""
