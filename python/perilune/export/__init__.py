"""Data sets: writing, checking and counting them."""
