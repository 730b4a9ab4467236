"""One file a kind of orbit; the table of them is perilune.orbits.paths.KINDS."""
