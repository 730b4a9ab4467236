"""Cameras: lens, bands, filters, image sensor, and the trajectories that place them."""
