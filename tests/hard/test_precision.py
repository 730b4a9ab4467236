"""Precision far from the origin: a cube of 1 m at 5 m from a camera 6 778 km from the root, over a
limb 2 000 km away.

The truth is computed here in extended precision (numpy longdouble, 64 bits of mantissa on x86) from
the numbers that the core was given; analytic edges are the projected hull of the cube and the
projected outline of the sphere.
"""

from __future__ import annotations

import numpy as np
import pytest
from tests.hard.glb import cube, write_glb

from perilune import _core

WIDTH, HEIGHT, FOCAL = 512, 384, 600.0
CUBE, BODY = 1, 2  # instance ids
R_CAMERA = 6.778e6
CHANNELS = ("position", "depth", "range", "instance", "part", "normal", "object_coords")


def to_matrix(q):
    """Rotation of a unit quaternion (w, x, y, z), in the precision of q."""
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion(axis, angle):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    return np.array([np.cos(angle / 2), *(np.sin(angle / 2) * axis)])


def times(a, b):
    w = a[0] * b[0] - a[1:] @ b[1:]
    return np.array([w, *(a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:]))])


class Scene:
    """One camera at `place` (unit direction from the root), its cube and its body."""

    def __init__(self, place, roll, seed):
        rng = np.random.default_rng(seed)
        up = np.asarray(place, float) / np.linalg.norm(place)
        self.eye = R_CAMERA * up
        # The limb of a sphere is sqrt(d^2 - r^2) away: 2 000 km fixes the radius.
        self.radius = float(np.sqrt(R_CAMERA**2 - 2e6**2))
        dip = np.arccos(2e6 / R_CAMERA)  # between nadir and the limb
        side = np.cross(up, [0.3, -0.5, 0.8])
        side /= np.linalg.norm(side)
        forward = -up * np.cos(dip) + np.cross(side, up) * np.sin(dip)
        right = np.cross(forward, up)
        right /= np.linalg.norm(right)
        R = np.stack([right, np.cross(forward, right), forward], axis=1)
        self.q_camera = times(from_matrix(R), quaternion([0, 0, 1], roll))
        forward = to_matrix(self.q_camera)[:, 2]
        aside = to_matrix(self.q_camera)[:, 0]
        self.center = self.eye + 5.0 * forward + rng.uniform(-0.4, 0.4) * aside
        self.q_cube = quaternion(rng.normal(size=3), rng.uniform(0.5, 2.5))
        self.K = np.array([[FOCAL, 0, (WIDTH - 1) / 2], [0, FOCAL, (HEIGHT - 1) / 2], [0, 0, 1.0]])

    def request(self):
        def still(t, q):
            return np.array([np.concatenate([t, q])] * 2)

        return {
            "seed": 1, "index": 0, "width": WIDTH, "height": HEIGHT, "K": self.K,
            "camera_pose": still(self.eye, self.q_camera),
            "object_poses": still(self.center, self.q_cube)[None],
            "object_scale": np.ones(1),
            "body_poses": still(np.zeros(3), np.array([1.0, 0, 0, 0]))[None],
            "body_radii": np.full((1, 3), self.radius),
            "body_albedo": np.full((1, 3), 0.3), "body_emission": np.zeros((1, 3)),
            "sun_position": 1.5e11 * self.eye / R_CAMERA, "sun_radius": 7e8,
            "sun_irradiance": 1361.0,
            "quality": {"samples": 1, "max_bounces": 0, "tolerance_dn": 1.0, "force_on": [],
                        "force_off": [], "texture_filter": 1},
            "exposure": {"mode": "fixed", "white_radiance": 300.0, "percentile": 99.0, "key": 0.8},
        }  # fmt: skip

    def rays(self):
        """Unit directions through the pixel centres, camera axes and root axes; longdouble."""
        v, u = np.mgrid[0:HEIGHT, 0:WIDTH].astype(np.longdouble)
        local = np.stack([(u - self.K[0, 2]) / FOCAL, (v - self.K[1, 2]) / FOCAL, u * 0 + 1], -1)
        R = exact_matrix(self.q_camera)
        return local, local @ R.T


def from_matrix(R):
    """Quaternion by the largest eigenvector (Bar-Itzhack 2000), robust for every rotation."""
    (a, b, c), (d, e, f), (g, h, i) = R
    K = np.array(
        [
            [a + e + i, h - f, c - g, d - b],
            [h - f, a - e - i, b + d, c + g],
            [c - g, b + d, e - a - i, f + h],
            [d - b, c + g, f + h, i - a - e],
        ]
    )
    return np.linalg.eigh(K)[1][:, -1]


def exact_matrix(q):
    q = np.asarray(q, np.longdouble)
    return to_matrix(q / np.sqrt((q * q).sum()))


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    path = write_glb(tmp_path_factory.mktemp("cube") / "cube.glb", *cube(0.5))
    return _core.Model(str(path))


def rendered(scene, model, threads=2):
    core = _core.Scene(1)
    core.add_body(
        name="ball", map=None, map_center_lon_rad=0.0, reflectance="lambert", instance_id=BODY,
        part_id=BODY, class_ids=np.array([BODY], np.uint16), regolith_map=None, air=None,
    )  # fmt: skip
    core.add_object(
        name="cube", model=model, offset=np.zeros(3), obj_id=1, instance_id=CUBE,
        part_ids=np.full(len(model.parts), CUBE, np.int32),
        class_ids=np.full((len(model.parts), 1), CUBE, np.uint16),
    )  # fmt: skip
    out = {}
    for row in _core.CHANNELS:
        if row["name"] in CHANNELS:
            tail = (row["components"],) if row["components"] else ()
            out[row["name"]] = np.empty((HEIGHT, WIDTH, *tail), row["dtype"])
    _core.Renderer(core).render(scene.request(), out, threads)
    return out


SCENES = [((1, 0, 0), 0.0), ((0.2, -0.7, 0.5), 0.4), ((-0.6, -0.6, -0.5), -1.1), ((0, 0, 1), 2.0)]


@pytest.fixture(scope="module", params=range(len(SCENES)))
def case(request, model):
    place, roll = SCENES[request.param]
    scene = Scene(place, roll, request.param)
    return scene, rendered(scene, model)


def cube_hits(scene):
    """Entry distance along z = 1 rays (inf: miss), and the pixels to the edge of the hull."""
    _, world = scene.rays()
    R = exact_matrix(scene.q_cube)
    # Positions first in double, as the core was given them, differences in longdouble.
    origin = (np.asarray(scene.eye, np.longdouble) - scene.center) @ R
    d = world @ R
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (-0.5 - origin) / d, (0.5 - origin) / d
    near, far = np.minimum(a, b).max(axis=-1), np.maximum(a, b).min(axis=-1)
    t = np.where(near < far, near, np.inf)
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    seen = ((corners - origin) @ R.T) @ exact_matrix(scene.q_camera)
    pixels = (seen[:, :2] / seen[:, 2:] * FOCAL + scene.K[:2, 2]).astype(float)
    return t, distance_to_hull(pixels)


def distance_to_hull(points):
    """Distance of every pixel centre to the outline of the convex hull of `points`."""
    hull = convex_hull(points)
    v, u = np.mgrid[0:HEIGHT, 0:WIDTH].astype(float)
    best = np.full(u.shape, np.inf)
    for (x0, y0), (x1, y1) in zip(hull, np.roll(hull, -1, axis=0), strict=True):
        dx, dy = x1 - x0, y1 - y0
        s = np.clip(((u - x0) * dx + (v - y0) * dy) / (dx * dx + dy * dy), 0.0, 1.0)
        best = np.minimum(best, np.hypot(u - x0 - s * dx, v - y0 - s * dy))
    return best


def convex_hull(points):
    """Andrew's monotone chain."""
    order = sorted(map(tuple, points))

    def half(chain_points):
        chain = []
        for p in chain_points:
            while len(chain) > 1:
                (ax, ay), (bx, by) = chain[-2:]
                if (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax) > 0:
                    break
                chain.pop()
            chain.append(p)
        return chain[:-1]

    return np.array(half(order) + half(order[::-1]))


def body_hits(scene):
    """Entry distance along z = 1 rays (inf: miss), and the pixels to the limb.

    The ray's closest approach to the centre less the radius, over its change by a pixel: along the
    image's gradient, taken by central differences of the same exact function.
    """
    _, world = scene.rays()
    eye = np.asarray(scene.eye, np.longdouble)
    a, b = (world * world).sum(-1), world @ eye
    c = eye @ eye - np.longdouble(scene.radius) ** 2
    disc = b * b - a * c
    t = np.where((disc > 0) & (b < 0), c / (-b + np.sqrt(np.maximum(disc, 0))), np.inf)
    excess = np.sqrt(np.maximum(eye @ eye - b * b / a, 0)) - scene.radius
    dv, du = np.gradient(excess.astype(float))
    return t, np.abs(excess.astype(float)) / np.hypot(du, dv)


def test_ids_are_exact_off_the_edges(case):
    scene, out = case
    cube_t, cube_edge = cube_hits(scene)
    body_t, body_edge = body_hits(scene)
    expected = np.where(np.isfinite(cube_t), CUBE, np.where(np.isfinite(body_t), BODY, 0))
    sure = (cube_edge > 0.01) & ((body_edge > 0.05) | np.isfinite(cube_t))
    wrong = sure & (out["instance"] != expected)
    assert not wrong.any(), f"{wrong.sum()} of {sure.sum()} pixels, first {np.argwhere(wrong)[:3]}"
    assert sure.mean() > 0.995
    assert {CUBE, BODY, 0} == set(np.unique(expected))
    assert (expected == CUBE).sum() > 5000
    assert (out["part"] == out["instance"]).all()


def test_no_speckle(case):
    """No pixel differs from all four neighbours, wherever it is."""
    _, out = case
    ids = np.pad(out["instance"], 1, mode="edge")
    middle = ids[1:-1, 1:-1]
    same = [
        middle == ids[1 + dy : HEIGHT + 1 + dy, 1 + dx : WIDTH + 1 + dx]
        for dy, dx in ((0, 1), (1, 0), (0, -1), (-1, 0))
    ]
    assert np.any(same, axis=0).all()


def test_positions_reproject_to_pixel_centres(case):
    scene, out = case
    hit = out["instance"] > 0
    p = out["position"][hit].astype(np.longdouble) - np.asarray(scene.eye, np.longdouble)
    assert np.isfinite(p.astype(float)).all()
    local = p @ exact_matrix(scene.q_camera)
    pixels = local[:, :2] / local[:, 2:] * FOCAL + scene.K[:2, 2]
    v, u = np.nonzero(hit)
    error = np.abs(pixels - np.stack([u, v], axis=-1)).astype(float).max(axis=1)
    ids = out["instance"][hit]
    assert error[ids == CUBE].max() < 0.01
    assert error[ids == BODY].max() < 0.01
    assert np.isnan(out["position"][~hit]).all()


@pytest.mark.parametrize("name", ["depth", "range"])
def test_depth(case, name):
    scene, out = case
    cube_t, cube_edge = cube_hits(scene)
    body_t, body_edge = body_hits(scene)
    local, _ = scene.rays()
    truth = np.where(out["instance"] == CUBE, cube_t, body_t)
    if name == "range":
        truth = truth * np.sqrt((local * local).sum(-1))
    # At the very limb the two roots meet and the depth has an infinite slope.
    sure = (
        (out["instance"] > 0) & (cube_edge > 0.01) & ((body_edge > 0.05) | (out["instance"] == 1))
    )
    relative = np.abs(out[name].astype(np.longdouble) / truth - 1)[sure].astype(float)
    assert relative.max() < 1e-6
    assert (out[name][out["instance"] == 0] == 0).all()


def test_cube_coordinates_and_normals(case):
    """Hits lie on the faces within what float32 can say; normals are the faces'."""
    scene, out = case
    hit = out["instance"] == CUBE
    coords = out["object_coords"][hit].astype(float)
    face = np.abs(np.abs(coords) - 0.5).min(axis=1)
    assert face.max() < 1e-6
    assert np.abs(coords).max() < 0.5 + 1e-6
    normals = (
        out["normal"][hit].astype(float) @ to_matrix(scene.q_camera).T @ to_matrix(scene.q_cube)
    )
    clear = np.sort(np.abs(np.abs(coords) - 0.5), axis=1)[:, 1] > 1e-3
    axis = np.abs(np.abs(coords) - 0.5).argmin(axis=1)
    expected = np.zeros_like(coords)
    expected[np.arange(len(coords)), axis] = np.sign(coords[np.arange(len(coords)), axis])
    assert np.abs(normals - expected)[clear].max() < 1e-5


def test_body_positions_lie_on_the_sphere(case):
    """Within a micrometre or so: 1e-9 m is the spacing of doubles at 6 800 km."""
    scene, out = case
    hit = out["instance"] == BODY
    p = out["position"][hit].astype(np.longdouble)
    height = np.sqrt((p * p).sum(-1)) - np.longdouble(scene.radius)
    assert np.abs(height).astype(float).max() < 1e-5


@pytest.mark.parametrize("inside_px", [0.011, -0.011])
@pytest.mark.parametrize("number", range(len(SCENES)))
def test_an_edge_that_passes_next_to_a_whole_column(model, number, inside_px):
    """The cube faces the camera, its left and upper edges 0.011 pixel from the centres of a column
    and a row: every pixel of these is decided by that."""
    place, roll = SCENES[number]
    scene = Scene(place, roll, number)
    scene.q_cube = scene.q_camera
    scene.center = scene.eye + 5.0 * to_matrix(scene.q_camera)[:, 2]
    reach = FOCAL * 0.5 / 4.5
    scene.K[0, 2] = 190 - inside_px + reach  # the edge is at u = 190 - inside_px
    scene.K[1, 2] = 120 - inside_px + reach
    out = rendered(scene, model)
    cube_t, edge = cube_hits(scene)
    expected = np.isfinite(cube_t)
    near = edge < 0.02
    assert near.sum() > 250
    assert (edge > 0.01).all()
    assert ((out["instance"] == CUBE) == expected).all()
    assert expected[near].all() == (inside_px > 0)


@pytest.mark.parametrize("number", range(len(SCENES)))
def test_the_limb_at_many_offsets(model, number):
    """Pixel centres within 0.05 to 0.1 pixel of the limb, gathered over images shifted by parts of
    a pixel: as many as a strict test needs."""
    place, roll = SCENES[number]
    close = 0
    for step in range(8):
        scene = Scene(place, roll, number)
        scene.K[:2, 2] += np.array([0.37, 0.125]) * step
        out = rendered(scene, model)
        body_t, edge = body_hits(scene)
        open_sky = out["instance"] != CUBE
        sure = open_sky & (edge > 0.05)
        assert ((out["instance"] == BODY) == np.isfinite(body_t))[sure].all()
        close += (sure & (edge < 0.1)).sum()
    assert close > 200
