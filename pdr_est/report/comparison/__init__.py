"""The page of an experiment: how variants compare over many walks."""
