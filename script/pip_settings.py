"""Writes where pip was told to look for packages, as settings of uv that a shell evaluates."""

from __future__ import annotations

import ast
import shlex
import subprocess
import sys

NAMES = {
    "find-links": "UV_FIND_LINKS",
    "constraint": "UV_CONSTRAINT",
    "index-url": "UV_DEFAULT_INDEX",
    "cert": "SSL_CERT_FILE",
}

listed = subprocess.run(
    [sys.executable, "-m", "pip", "config", "list"], capture_output=True, text=True, check=True
)
for line in listed.stdout.splitlines():
    name, _, value = line.partition("=")
    variable = NAMES.get(name.rpartition(".")[2])
    if variable is not None:
        # uv's lists of links have commas between them.
        words = ast.literal_eval(value).split()
        text = ("," if variable == "UV_FIND_LINKS" else " ").join(words)
        sys.stdout.write(f"export {variable}={shlex.quote(text)}\n")
