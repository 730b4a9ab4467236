"""States from files: two-line elements, CCSDS ephemerides, tables, SPICE kernels."""
