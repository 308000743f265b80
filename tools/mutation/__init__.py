"""Mutants of a folder of sources, for tools/mutants."""
