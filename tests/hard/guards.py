"""Takes guards of the core away one at a time, and asks the tests whether they notice:

    python -m tests.hard.guards [NAME...]

The table is tests/hard/guards.yaml. The files that matter are copied to build/guards and
built there: the code that users get has no switch.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import yaml
from tests.hard.cases import cases

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build" / "guards"
LONGEST_S = 120
"""A test that takes longer hangs, which is noticed."""
FLAGS = ["-O1", "-w", "-std=gnu17", "-ffp-contract=off", "-fno-math-errno", "-Icsrc", "-Itests/c"]
SOURCES = (
    "base/*.c", "math/*.c", "orbit/*.c", "geom/ellipsoid.c", "shade/hapke*.c", "terrain/*_sizes.c",
    "terrain/size_*.c", "terrain/crater_profile.c", "terrain/radial_diffusion.c",
    "annotate/rim_image.c",
)  # fmt: skip
"""What the tests of the table need of csrc/: a few seconds to build, unlike the whole core."""


@dataclass(frozen=True)
class Guard:
    """One row of the table."""

    name: str
    file: str
    text: str
    naive: str
    test: str

    def cases(self) -> list[str]:
        """Rows of the table of hard cases whose test is in the file that should notice."""
        return [case.what for case in cases() if case.test.startswith(f"c/{self.test}.c::")]


def guards() -> list[Guard]:
    """All rows of the table."""
    rows = yaml.safe_load((ROOT / "tests/hard/guards.yaml").read_text(encoding="utf-8"))
    return [Guard(name, *row) for name, row in rows.items()]


def _compile(tree: Path, *arguments: str) -> str | None:
    """The compiler's words if it fails."""
    command = ["cc", *FLAGS, *arguments]
    done = subprocess.run(command, cwd=tree, capture_output=True, text=True, check=False)
    return None if done.returncode == 0 else done.stderr[-2000:]


def _prepare() -> Path:
    """A copy of the core and its tests, with an archive of what they need."""
    tree = FOLDER / "tree"
    shutil.rmtree(tree, ignore_errors=True)
    for name in ("csrc", "tests/c"):
        shutil.copytree(ROOT / name, tree / name)
    objects = []
    for pattern in SOURCES:
        for source in sorted((tree / "csrc").glob(pattern)):
            objects.append(f"{source.parent.name}_{source.stem}.o")
            broken = _compile(tree, "-c", str(source), "-o", objects[-1])
            if broken is not None:
                raise RuntimeError(broken)
    subprocess.run(["ar", "rcs", "core.a", *objects], cwd=tree, check=True)
    return tree


def _build(tree: Path, guard: Guard) -> str | None:
    """The test with the file of its guard compiled anew."""
    own = [] if guard.file.endswith(".h") else [f"csrc/{guard.file}"]
    libraries = ["core.a", "-lcmocka", "-lm", "-lpthread"]
    return _compile(tree, f"tests/c/{guard.test}.c", *own, *libraries, "-o", "tried")


def _passes(tree: Path) -> bool:
    try:
        done = subprocess.run(
            ["./tried"], cwd=tree, capture_output=True, timeout=LONGEST_S, check=False
        )
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def _without(guard: Guard, tree: Path) -> str:
    """noticed, UNNOTICED, or what else is wrong."""
    broken = _build(tree, guard)
    if broken is not None or not _passes(tree):
        return f"FAILS WITH ITS GUARD\n{broken or ''}"
    path = tree / "csrc" / guard.file
    whole = path.read_text(encoding="utf-8")
    path.write_text(whole.replace(guard.text, guard.naive), encoding="utf-8")
    try:
        broken = _build(tree, guard)
        if broken is not None:
            return f"DOES NOT BUILD\n{broken}"
        return "UNNOTICED" if _passes(tree) else "noticed"
    finally:
        path.write_text(whole, encoding="utf-8")


def main(names: list[str]) -> int:
    table = guards()
    unknown = set(names) - {guard.name for guard in table}
    if unknown:
        print(f"no guard {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2
    chosen = [guard for guard in table if not names or guard.name in names]
    tree = _prepare()
    wrong = 0
    for guard in chosen:
        found = _without(guard, tree)
        wrong += found != "noticed"
        print(f"{guard.name}, csrc/{guard.file}: {found} by {guard.test}", flush=True)
        for what in guard.cases() if found == "noticed" else []:
            print(f"    of its cases: {what}")
    print(f"{len(chosen)} guards, {len(chosen) - wrong} noticed")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
