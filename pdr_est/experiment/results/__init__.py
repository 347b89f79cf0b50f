"""Results of benchmarks and experiments: records, files, tables, comparison and provenance."""
