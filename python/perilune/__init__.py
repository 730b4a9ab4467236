"""Perilune: annotated synthetic images of spacecraft, planets and the Moon's surface."""
