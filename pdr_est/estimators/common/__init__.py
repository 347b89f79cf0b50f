"""Common ground of all estimators: timelines of nodes, motion model, initial states, tethers and input checks."""
