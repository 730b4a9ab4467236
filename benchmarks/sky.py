"""Cost of the sky against how faint its stars are, and of a map behind everything.

One frame of stars alone, of a catalogue drawn at random with the numbers of the real sky (four
tenths of a decade a magnitude, 9000 to 6.5), forced on down to a limiting magnitude; the last lines
are the same frame by the plan at exposures from the night's to the day's. Times are CPU times of a
frame on one thread less that of the frame without a sky, medians; below half a millisecond they are
noise of the machine. `seen` counts the stars that the frame shows.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import report

import perilune
from perilune import _core


def write_catalogue(path: Path, faintest: float) -> None:
    """Stars spread evenly over the sky, V by the slope of their counts."""
    rng = np.random.default_rng(1)
    count = int(9000 * 10 ** (0.4 * (faintest - 6.5)))
    vmag = faintest + np.log10(1.0 - rng.uniform(size=count)) / 0.4
    ra, dec = rng.uniform(0, 360, count), np.degrees(np.arcsin(rng.uniform(-1, 1, count)))
    rows = zip(ra.tolist(), dec.tolist(), vmag.tolist(), strict=True)
    lines = [f"{a:.6f},{d:.6f},{m:.3f}\n" for a, d, m in rows]
    path.write_text("ra_deg,dec_deg,vmag\n" + "".join(lines))


def measure(options: Any, sky: dict[str, Any], white: float, force: bool) -> tuple[float, int]:
    """Milliseconds of CPU time of a frame, and the stars in it."""
    tree: dict[str, Any] = {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z"},
        "root": "earth",
        "bodies": {"earth": {"kind": "earth"}},
        "sky": sky,
        "camera": {
            "width": options.width,
            "height": options.width * 3 // 4,
            "fov_deg": options.fov,
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": white},
            "trajectory": {"kind": "fixed", "target": "earth", "position_m": [0.0, 0.0, 4e8]},
        },
        "render": {"samples": 1, "force_on": ["stars"] if force else []},
    }
    pose = np.array([0.0, 0.0, 4e8, 1.0, 0.0, 0.0, 0.0])
    sim = perilune.open(tree, trajectory=lambda _: pose)
    times, seen = [], 0
    for i in range(options.repeats + 1):
        start = time.process_time()
        sample = sim.frame(0, channels=["rgb"], threads=1)
        seen = len(sample.stars)
        if i > 0:  # the first reads the files
            times.append(1e3 * (time.process_time() - start))
    return report.median(times), seen


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--width", type=int, default=1024)
    parser.add_argument("--fov", type=float, default=40.0)
    parser.add_argument("--faintest", type=float, default=9.0)
    parser.add_argument("--repeats", type=int, default=9)
    options = parser.parse_args()
    rows: list[list[object]] = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "stars.csv"
        write_catalogue(path, options.faintest)
        empty, _ = measure(options, {}, 1e-3, False)

        def line(what: str, sky: dict[str, Any], white: float, force: bool = False) -> None:
            cost, seen = measure(options, sky, white, force)
            rows.append([what, seen, cost - empty])

        for limit in np.arange(3.0, options.faintest + 0.5):
            stars = {"catalogue": str(path), "limit_magnitude": float(limit)}
            line(f"all to magnitude {limit:g}", {"stars": stars}, 1e-3, True)
        for white in (1e-5, 1e-3, 1e-1, 1e1, 1e3):
            stars = {"catalogue": str(path)}
            line(f"by the plan, white {white:g} W m-2 sr-1", {"stars": stars}, white)
        picture = Path(folder) / "map.png"
        texels = np.random.default_rng(2).integers(0, 255, (1024, 2048, 3)).astype(np.uint8)
        _core.png_write(str(picture), texels)
        line("a map of 2048 x 1024", {"background": {"map": str(picture)}}, 1e-3)
    head = ["sky", "seen", "ms"]
    result = {"rows": [dict(zip(head, row, strict=True)) for row in rows]}
    report.publish(options.json, result, [report.table(head, rows)])


if __name__ == "__main__":
    main()
