"""Rows that are off execute nothing: counts of callgrind for the frames of test_rows_off.c.

    python3 tests/c/rows_off.py PROGRAM LIBRARY

PROGRAM is test_rows_off, LIBRARY the static library of the core, whose members tell which function
is of which file. After a frame's plan is made (what comes next is pl_snapshot_cull) no instruction
of what ROWS lists may be executed in the frame without the row; and some must be in another frame,
or this would pass for functions that are never called.
"""

from __future__ import annotations

import bisect
import re
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

# A file: all of its functions; or a function.
ROWS = {
    "soft_sun": ("pl_sun_sample", "pl_limb_sample"),
    "limb_darkening": ("limb.c",),
    "emitters": ("emitters.c",),
    "planetshine": ("pl_planetshine_build", "body_radiance.c"),
    "caustics": ("caustic_table.c", "caustics.c"),
    "regolith": ("hapke.c", "hapke_rough.c"),
    "volumes": ("volume.c", "volume_march.c", "volume_columns.c", "volume_medium.c"),
    "rings": ("ring_medium.c", "average.c", "pl_rings_cut", "pl_rings_scatter"),
    "clouds": ("cloud_medium.c", "clouds.c", "pl_media_apply", "pl_media_toward_sun"),
    "relief": ("relief.c",),
    "glint": ("water.c",),
    "night_lights": ("pl_ground_light", "towns.c"),
    "distortion": ("lens.c", "lens_models.c"),
    "vignetting": ("vignetting.c", "shading.c"),
    "point_spread": ("point_spread.c", "psf.c", "convolve.c", "fft.c"),
    "fixed_pattern": ("fixed_pattern.c",),
    "smear": ("smear.c",),
    "dark_current": ("dark_current.c",),
    "defects": ("defects.c",),
    "shot_noise": ("shot_noise.c",),
    "cosmic_rays": ("cosmic_rays.c",),
    "blooming": ("blooming.c",),
    "read_noise": ("read_noise.c",),
    "lens_flare": ("lens_flare.c",),
    "black_sun": ("black_sun.c",),
    "compression": ("jpeg_write.c",),
    "filters": ("filters.c",),
    "depth_of_field": ("pl_image_confusion_m",),
    "motion_blur": ("slice.c",),
    "rolling_shutter": ("pl_moving_render",),
    "sub_cell_normals": ("sub_cell.c",),
    "crater_rays": ("crater_rays.c", "ground_tile_rays.c", "pl_height_field_rays"),
}


def global_files(library: str) -> dict[str, str]:
    """Source file of each function that other files see."""
    lines = subprocess.run(["nm", "-A", library], capture_output=True, text=True, check=True).stdout
    found = re.findall(r":([\w.]+)\.o:\s*[0-9a-f]+ T (\w+)$", lines, re.MULTILINE)
    return {name: file for file, name in found}


def functions(program: str, library: str) -> list[tuple[int, int, str, str]]:
    """Address, size, name and source file of each function, by address."""
    files = global_files(library)
    lines = subprocess.run(["readelf", "-sW", program], capture_output=True, text=True, check=True)
    out, file = [], ""
    for line in lines.stdout.splitlines():
        cells = line.split()
        if len(cells) < 8 or not cells[0].rstrip(":").isdigit():
            continue
        kind, name = cells[3], cells[7]
        if kind == "FILE":
            file = name
        elif kind == "FUNC" and int(cells[2], 0) > 0:
            out.append((int(cells[1], 16), int(cells[2], 0), name, files.get(name, file)))
    return sorted(out)


def instructions(dump: Path, table: list[tuple[int, int, str, str]]) -> dict[str, int]:
    """Instructions executed in each file and each function of the program."""
    starts = [row[0] for row in table]
    counts: dict[str, int] = defaultdict(int)
    own, call = False, False
    for line in dump.read_text().splitlines():
        if line.startswith("ob="):
            own = line.endswith("test_rows_off")
        elif line.startswith("calls="):
            call = True  # the next line is what the called function executed
        elif line.startswith("0x"):
            cells = line.split()
            at = bisect.bisect_right(starts, int(cells[0], 16)) - 1
            if own and not call and at >= 0 and int(cells[0], 16) < starts[at] + table[at][1]:
                for key in (table[at][2].partition(".")[0], table[at][3]):
                    counts[key] += int(cells[-1])
            call = False
    return counts


def profiles(program: str, library: str) -> dict[str, dict[str, int]]:
    """Of each frame, by the row that is off; "all", "moving", "ground": none is."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder, "counts")
        command = ["valgrind", "--tool=callgrind", "--dump-instr=yes", "--compress-strings=no",
                   "--compress-pos=no", "--zero-before=pl_snapshot_cull",
                   "--dump-after=rows_off_frame*", f"--callgrind-out-file={out}",
                   program]  # fmt: skip
        run = subprocess.run(command, capture_output=True, text=True)
        if run.returncode != 0:
            sys.exit(f"{' '.join(command)}: {run.stdout}{run.stderr}")
        names = re.findall(r"^frame (\w+)$", run.stdout, re.MULTILINE)
        table = functions(program, library)
        return {
            name: instructions(out.with_name(f"counts.{i}"), table)
            for i, name in enumerate(names, 1)
        }


def main() -> None:
    found = profiles(*sys.argv[1:])
    if set(found) != {"all", "moving", "ground", *ROWS}:
        sys.exit(f"frames of the program: {sorted(found)}")
    faults = []
    for row, parts in ROWS.items():
        for part in parts:
            on = max(counts.get(part, 0) for counts in found.values())
            off = found[row].get(part, 0)
            print(f"{row:16} {part:20} {on:>10} instructions, off {off}")
            if on == 0 or off > 0:
                faults.append(f"{row}: {part}")
    if faults:
        sys.exit("executed although off, or never: " + ", ".join(faults))


if __name__ == "__main__":
    main()
