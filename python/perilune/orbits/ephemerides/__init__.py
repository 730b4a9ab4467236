"""States from outside: two-line elements, CCSDS ephemerides, tables, SPICE kernels."""
