"""Ground against Mitsuba's picture of a mesh of the same heights: places, normals and shadows.

The mesh has 2.1 million triangles of even posts, about eight along a pixel, so what is left of the
difference at 8 cells a pixel is that between two meshes of one ground.
"""

from __future__ import annotations

import pytest
from benchmarks.reference import by_mitsuba, compare, export, ours, scenes

pytestmark = pytest.mark.needs_data
WIDTH = 64


@pytest.mark.soak
def test_finer_cells_converge_to_the_same_picture(tmp_path):
    """Under a Sun of 12 degrees, with shadows in craters; the square has none of those that ground
    outside of it throws under a lower one."""
    sim = scenes.FRAMES["ground"].open(WIDTH, tmp_path)
    scene = export.export(sim, 0)
    theirs = by_mitsuba.render(scene, 64, [1, 2], tmp_path)
    apart = {}
    for cells in (1, 8):
        finer = sim.with_overrides({"bodies.moon.terrain.cells_per_pixel": cells})
        mine = ours.render(finer, 0, 64, [1, 2])
        apart[cells] = compare.rms(mine, theirs, scene.white_radiance)
        print(f"{cells} cells: {apart[cells]:.2f} DN, mean ratio {mine.mean() / theirs.mean():.4f}")
    assert mine.mean() == pytest.approx(theirs.mean(), rel=0.003)
    assert apart[8] < 1.5
    assert apart[8] < 0.3 * apart[1]
