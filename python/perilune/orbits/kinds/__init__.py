"""One file per kind of orbit; their table is perilune.orbits.paths.KINDS."""
