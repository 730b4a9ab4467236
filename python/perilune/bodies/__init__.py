"""Planets, moons and asteroids: shapes, maps, air, clouds, rings, grounds, photometry."""
