"""Runs of benchmarks and experiments: the work on one walk, in processes of this computer or on a Dask cluster."""
