"""Pictures and videos of models: what is where in them, in closed form; what is in front; floors, shadows; files."""

import copy
import struct
import subprocess
import sys
import zlib

import numpy as np
import pytest
from conftest import MODELS

import libdyn as dyn
from libdyn.picture import png
from libdyn.raster import raster
from libdyn.video import Video, ffmpeg

FRONT = dyn.Camera((0, 0, 0), 4.0, 0.0, 0.0, 40.0)  # from +x: y to the right, z up


def balls(*places, floor=False, type="sphere", size=(0.5,)):
    """Shapes of the world: red, green, blue."""
    b = dyn.Builder("balls")
    if floor:
        b.add_shape("universe", "half_space", name="floor")
    for k, p in enumerate(places):
        colour = [0.1, 0.1, 0.1, 1.0]
        colour[k % 3] = 0.9
        b.add_shape("universe", type, size, (np.eye(3), p), role="visual", name=f"s{k}", rgba=colour)
    return b.add_joint("free", "free_flyer").add_body("none", "free", 1.0, inertia=np.eye(3)).finish()


def shot(model, camera=FRONT, width=200, height=200, q=None, **options):
    return dyn.Renderer(model, width, height, camera, **options).render(model.neutral() if q is None else q).astype(int)


def of(picture, k):
    """Pixels whose colour is mostly that of k."""
    others = [i for i in range(3) if i != k]
    return picture[..., k] > 1.8 * picture[..., others].max(-1)


def test_triangles_that_share_an_edge_share_no_pixel():
    """Random points of a square make a triangulation; each pixel is covered once."""
    random = np.random.default_rng(1)
    grid = np.stack(np.meshgrid(np.arange(9.0), np.arange(9.0)), -1) * 5
    inner = grid[1:-1, 1:-1]
    inner += random.uniform(-2, 2, inner.shape)
    inner[3, 3] = np.round(inner[3, 3]) + 0.5  # on the middle of a pixel
    triangles = []
    for i in range(8):
        for j in range(8):
            a, b, c, d = grid[i, j], grid[i, j + 1], grid[i + 1, j + 1], grid[i + 1, j]
            triangles += [[a, b, c], [a, c, d]]
    count = np.zeros(40 * 40, int)
    for t in triangles:
        count[raster(np.array([t]), np.ones((1, 3)), 40, 40)[0]] += 1
    assert (count == 1).all()


def test_shares_of_corners():
    corners = np.array([[[3.0, 2], [60, 9], [20, 50]]])
    pixels, which, shares = raster(corners, np.ones((1, 3)), 64, 64)
    assert (which == 0).all() and abs(len(pixels) - 0.5 * abs(57 * 48 - 17 * 7)) < 60
    at = np.stack([pixels % 64 + 0.5, pixels // 64 + 0.5], 1)
    np.testing.assert_allclose(shares @ corners[0], at, atol=1e-9)


def test_a_ball_has_its_size():
    """A sphere of radius r at distance d is a disc of radius f r / sqrt(d^2 - r^2), to 3 %: the surface has 14 x 24 faces."""
    found = of(shot(balls((0, 0, 0))), 0)
    f = 100 / np.tan(np.deg2rad(20))
    radius = f * 0.5 / np.sqrt(4.0**2 - 0.5**2)
    assert found.sum() == pytest.approx(np.pi * radius**2, rel=0.03)
    rows, columns = np.nonzero(found)
    assert abs(rows.mean() - 99.5) < 0.5 and abs(columns.mean() - 99.5) < 0.5


def test_where_things_are():
    """Seen from +x: +y is on the right, +z is above."""
    picture = shot(balls((0, 0.8, 0), (0, 0, 0.8)))
    rows, columns = np.nonzero(of(picture, 0))
    f = 100 / np.tan(np.deg2rad(20))
    assert columns.mean() == pytest.approx(99.5 + f * 0.8 / 4, abs=2.5) and abs(rows.mean() - 99.5) < 0.6
    rows, columns = np.nonzero(of(picture, 1))
    assert rows.mean() == pytest.approx(99.5 - f * 0.8 / 4, abs=2.5) and abs(columns.mean() - 99.5) < 0.6


@pytest.mark.parametrize("order", [1, -1])
def test_what_is_nearer_hides_what_is_behind(order):
    places = [(1.5, 0, 0), (-0.8, 0, 0)][::order]
    picture = shot(balls(*places))
    near, far = (0, 1) if order == 1 else (1, 0)
    assert of(picture, near).sum() > 1000 and not of(picture, far).any()


def test_shapes_and_their_colours():
    """Each type is as wide as its size says."""
    f = 100 / np.tan(np.deg2rad(20)) / 4
    sizes = {"box": ((0.2, 0.6, 0.6), 0.6), "cylinder": ((0.3, 0.6), 0.6), "capsule": ((0.3, 0.2), 0.8),
             "cone": ((0.3, 0.6), 0.6), "ellipsoid": ((0.2, 0.3, 0.4), 0.8)}
    for type, (size, high) in sizes.items():
        rows, columns = np.nonzero(of(shot(balls((0, 0, 0), type=type, size=size)), 0))
        assert columns.max() - columns.min() + 1 == pytest.approx(0.6 * f, rel=0.12), type
        assert rows.max() - rows.min() + 1 == pytest.approx(high * f, rel=0.12), type


def test_a_floor_hides_what_is_below():
    above = dyn.Camera((0, 0, 0), 4.0, 0.0, 30.0, 40.0)
    whole, half = (of(shot(balls((0, 0, 0), floor=floor), above), 0).sum() for floor in (False, True))
    assert 0.55 < half / whole < 0.85  # more than half of a sphere is seen from 30 degrees
    below = dyn.Camera((0, 0, 0), 4.0, 0.0, -30.0, 40.0)
    assert np.array_equal(*(of(shot(balls((0, 0, 0), floor=floor), below), 0) for floor in (False, True))), "a floor has no back"


def test_shadows_lie_where_the_sun_says():
    """The sun goes along (-0.8, 1.2, -2.4): the shadow's middle is where that direction meets the floor."""
    model, camera = balls((0, 0, 1.2), floor=True, size=(0.3,)), dyn.Camera((0, 0, 0), 8.0, 0.0, 89.9, 40.0)
    difference = shot(model, camera, shadows=False).sum(-1) - shot(model, camera).sum(-1)
    assert (difference[of(shot(model, camera), 0)] < 120).all()
    rows, columns = np.nonzero((difference > 40) & ~of(shot(model, camera), 0))
    f = 100 / np.tan(np.deg2rad(20)) / 8  # from above, with +y to the right and -x upwards
    assert columns.mean() == pytest.approx(99.5 + 0.6 * f, abs=3) and rows.mean() == pytest.approx(99.5 - 0.4 * f, abs=3)


def test_the_camera_follows_a_floating_base(go2):
    renderer = dyn.Renderer(go2, 64, 48)
    q = go2.neutral()
    first = renderer.render(q)
    q[:3] = 5, -3, 0.5
    assert np.array_equal(renderer.render(q), first) and (first.std((0, 1)) > 5).all()
    still = dyn.Renderer(go2, 64, 48, dyn.Camera(follow="universe"))
    still.render(go2.neutral())
    assert still.render(q).std() < first.std(), "it went out of the picture"


def test_meshes_and_what_cannot_be_read(tmp_path):
    corners = "".join(f"v {x} {y} {z}\n" for x in (-0.3, 0.3) for y in (-0.3, 0.3) for z in (-0.3, 0.3))
    faces = ["1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4"]
    (tmp_path / "cube.obj").write_text(corners + "".join(f"f {face}\n" for face in faces))
    b = dyn.Builder("m").add_joint("free", "free_flyer").add_body("link", "free", 1.0, inertia=np.eye(3))
    b.add_shape("link", "mesh", (1, 1, 1), role="visual", mesh=str(tmp_path / "cube.obj"), rgba=(0.9, 0.1, 0.1, 1))
    b.add_shape("link", "mesh", (1, 1, 1), role="visual", mesh=str(tmp_path / "gone.obj"))
    renderer = dyn.Renderer(b.finish(), 200, 200, FRONT)
    picture = renderer.render([0, 0, 0, 0, 0, 0, 1]).astype(int)
    assert len(renderer.notes) == 1 and "gone.obj" in renderer.notes[0]
    side = 0.6 * 100 / np.tan(np.deg2rad(20)) / 3.7  # of the nearest face
    assert of(picture, 0).sum() == pytest.approx(side**2, rel=0.03)


def test_a_mesh_of_many_triangles_is_thinned(tmp_path):
    n = 160
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, n, endpoint=False), np.linspace(0.01, np.pi - 0.01, n), indexing="ij")
    points = np.stack([np.sin(v) * np.cos(u), np.sin(v) * np.sin(u), np.cos(v)], -1).reshape(-1, 3) * 0.5
    a = (np.arange(n)[:, None] * n + np.arange(n - 1)).ravel()
    b = ((np.arange(n)[:, None] + 1) % n * n + np.arange(n - 1)).ravel()
    mesh = dyn.Mesh.from_arrays(points, np.concatenate([np.stack([a, a + 1, b], 1), np.stack([b, a + 1, b + 1], 1)]))
    m = dyn.Builder("m").add_shape("universe", "triangles", surface=mesh, rgba=(0.9, 0.1, 0.1, 1)).finish()
    renderer = dyn.Renderer(m, 200, 200, FRONT)
    assert len(mesh.triangles) > 50000 and len(renderer._corners) <= 20000
    seen, whole = of(renderer.render([]).astype(int), 0).sum(), of(shot(balls((0, 0, 0))), 0).sum()
    assert seen == pytest.approx(whole, rel=0.02)


def test_tendons_show_how_muscles_pull():
    """From blue to red, along the path."""
    m = dyn.load_string("""<mujoco><worldbody><site name="a" pos="0 -1 0"/><body><joint axis="1 0 0" name="j"/>
      <geom type="box" size=".1 1 .2" pos="0 0 -1" rgba=".5 .5 .5 1"/><site name="b" pos="0 1 0"/></body></worldbody>
      <tendon><spatial name="t"><site site="a"/><site site="b"/></spatial></tendon>
      <actuator><muscle tendon="t" lengthrange="1 3" force="1"/></actuator></mujoco>""")
    renderer = dyn.Renderer(m, 200, 200, FRONT)
    for act, k in ((None, 2), ([0.0], 2), ([1.0], 0)):
        picture = renderer.render([0.0], act).astype(int)
        row = of(picture, k)[99:101].any(0)
        f = 100 / np.tan(np.deg2rad(20)) / 4
        assert row.sum() == pytest.approx(2 * f, abs=6) and not of(picture, 2 - k).any()


def test_no_shapes():
    m = dyn.Builder("bare").add_joint("j", "revolute").add_body("x", "j", 1.0, inertia=np.eye(3)).finish()
    assert shot(m, dyn.Camera()).shape == (200, 200, 3)


def test_refusals(go2):
    for wrong, said in (({"width": 0}, "width"), ({"width": 10**5, "height": 10**4}, "too large"), ({"role": "both"}, "role"),
                        ({"camera": dyn.Camera(fov=0)}, "fov"), ({"camera": dyn.Camera(distance=-1)}, "distance"),
                        ({"camera": dyn.Camera((0, 0))}, "target"), ({"camera": dyn.Camera(follow="tail")}, "tail")):
        with pytest.raises(dyn.Error, match=said):
            dyn.Renderer(go2, **wrong)
    with pytest.raises(dyn.SizeError):
        dyn.Renderer(go2).render([1, 2])


def test_png(tmp_path, go2):
    """The file's rows, unfiltered, are the picture."""
    picture = dyn.Renderer(go2, 33, 20).render(go2.neutral())
    dyn.write_png(picture, tmp_path / "go2.png")
    data = (tmp_path / "go2.png").read_bytes()
    assert data == png(picture) and data[:8] == b"\x89PNG\r\n\x1a\n"
    chunks, at = {}, 8
    while at < len(data):
        n = struct.unpack(">I", data[at : at + 4])[0]
        assert struct.unpack(">I", data[at + 8 + n : at + 12 + n])[0] == zlib.crc32(data[at + 4 : at + 8 + n])
        chunks[data[at + 4 : at + 8]], at = data[at + 8 : at + 8 + n], at + 12 + n
    assert struct.unpack(">II", chunks[b"IHDR"][:8]) == (33, 20)
    rows = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(20, 1 + 3 * 33)
    assert (rows[:, 0] == 1).all()
    assert np.array_equal(np.cumsum(rows[:, 1:].reshape(20, 33, 3), axis=1, dtype=np.uint8), picture)


def test_a_picture_of_a_simulation():
    sim = dyn.Simulation(MODELS / "scenes/go2_stands.xml", "standing")
    first = sim.picture(64, 48)
    assert first.shape == (48, 64, 3) and np.array_equal(sim.picture(64, 48), first)
    assert np.array_equal(copy.copy(sim).picture(64, 48), first)
    sim.data.set_state(v={"root_joint": [0, 0, 2.0, 0, 0, 0]})
    sim.step(100)
    assert not np.array_equal(sim.picture(64, 48), first) and sim.picture(32, 24, dyn.Camera(azimuth=90)).shape == (24, 32, 3)


@pytest.fixture
def encoder():
    try:
        return ffmpeg()
    except dyn.UnsupportedError:
        pytest.skip("neither ffmpeg nor the package imageio-ffmpeg is installed")


def test_a_video(encoder, tmp_path):
    """A sphere that rises 1 m/s: frames are 1/20 s apart; at half the speed there are twice as many."""
    b = dyn.Builder("b").add_joint("j", "prismatic").add_body("x", "j", 1.0, inertia=np.eye(3)).set_gravity([0, 0, 0])
    sim = dyn.Simulation(b.add_shape("x", "sphere", [0.5], rgba=(0.9, 0.1, 0.1, 1)).finish(), v=[1.0], dt=1e-2)
    with sim.record(every=10) as recording:
        sim.run(0.5)
    for speed, frames in ((1.0, 11), (0.5, 21)):
        recording.to_mp4(tmp_path / "b.mp4", 65, 64, camera=FRONT, fps=20, smooth=False, speed=speed)
        words = [encoder, "-loglevel", "error", "-i", tmp_path / "b.mp4", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
        raw = subprocess.run(words, capture_output=True, check=True).stdout
        seen = np.frombuffer(raw, np.uint8).reshape(-1, 64, 66, 3).astype(int)
        assert len(seen) == frames
        rows = [np.nonzero(of(x, 0))[0].mean() for x in seen[: 8 * frames // 10]]  # while all of it is in the picture
        f = 32 / np.tan(np.deg2rad(20)) / 4
        np.testing.assert_allclose(np.diff(rows), -f * speed / 20, atol=0.5)
    with pytest.raises(dyn.FileError, match="no/b.mp4"):
        recording.to_mp4(tmp_path / "no/b.mp4", 32, 32)
    with pytest.raises(dyn.ArgumentError, match="speed"):
        recording.to_mp4(tmp_path / "b.mp4", speed=0)
    with pytest.raises(dyn.ArgumentError, match="fps"):
        recording.to_mp4(tmp_path / "b.mp4", fps=0)
    with Video(tmp_path / "c.mp4", 32, 32) as video, pytest.raises(dyn.SizeError, match="uint8 of shape"):
        video.add(np.zeros((3, 3, 3), np.uint8))


def test_without_ffmpeg(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(dyn.UnsupportedError, match="pip install imageio-ffmpeg"):
        ffmpeg()
