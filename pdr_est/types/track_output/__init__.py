"""Tables and drawings of a track."""
