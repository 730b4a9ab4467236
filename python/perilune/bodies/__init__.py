"""Planets, moons and asteroids: shapes, maps, atmospheres, clouds, rings, ground, photometry."""
