"""Datasets: writing, checking and statistics."""
