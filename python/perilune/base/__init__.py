"""What knows of no configuration: files, hooks, random numbers, rotations, spectra, HTML."""
