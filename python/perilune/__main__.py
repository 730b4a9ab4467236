"""`python -m perilune` is the command `perilune`."""

import sys

from perilune.cli import main

sys.exit(main())
