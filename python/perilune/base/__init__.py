"""Helpers independent of the configuration: files, hooks, random numbers, rotations, spectra,
HTML."""
