"""How robots look on a page: shapes, meshes, colours, inertias."""

import pytest
from conftest import dyn


def seen_from_the_side(page):
    """The picture's red, green, blue and opacity where the middle of each visual shape is."""
    page.page.click("#look-side")
    page.settle()
    return page(
        """(() => { const { scene, robot, overlays } = dynView, canvas = scene.canvas;
        overlays.show("com", false);
        scene.redraw(), scene.draw();
        const flat = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
        flat.drawImage(canvas, 0, 0);
        return robot.layers[robot.hasVisual ? "visual" : "collision"].map((mesh) => {
          const p = new mesh.position.constructor(0, 0, 0).applyMatrix4(mesh.matrixWorld).project(scene.camera);
          return Array.from(flat.getImageData((p.x + 1) / 2 * canvas.width, (1 - p.y) / 2 * canvas.height, 1, 1).data); }); })()"""
    )


def test_shapes_have_the_colours_of_their_files(page, tmp_path):
    """Seen from the side: a red box whose material is the robot's, a green one, half a blue one's light, one of no colour."""
    boxes = {"red": '<material name="paint"/>', "green": '<material name=""><color rgba="0 0.9 0 1"/></material>',
             "blue": '<material name="b"><color rgba="0 0 1 0.4"/></material>', "none": ""}
    links = "".join(f'<visual><origin xyz="{k} 0 0"/><geometry><box size="0.8 1 1"/></geometry>{material}</visual>'
                    for k, material in enumerate(boxes.values()))
    body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    (tmp_path / "c.urdf").write_text('<robot name="c"><material name="paint"><color rgba="0.9 0 0 1"/></material><link '
                                     f'name="a">{body}{links}</link></robot>')
    geoms = "".join(f'<geom type="box" size="0.4 0.5 0.5" pos="{k} 0 0" {looks}/>'
                    for k, looks in enumerate(['material="paint"', 'rgba="0 0.9 0 1"', 'material="paint" rgba="0 0 1 0.4"', ""]))
    (tmp_path / "c.xml").write_text('<mujoco><asset><material name="paint" rgba="0.9 0 0 '
                                    f'1"/></asset><worldbody><body><freejoint/>{geoms}</body></worldbody></mujoco>')
    for file, base in (("c.urdf", ["--floating"]), ("c.xml", [])):
        made = dyn("view", tmp_path / file, *base, "--html", tmp_path / "c.html")
        assert made.returncode == 0, made.stderr
        page.open(f"file://{tmp_path}/c.html")
        red, green, blue, plain = seen_from_the_side(page)
        assert red[0] > 3 * max(red[1], red[2]) and red[3] == 255
        assert green[1] > 3 * max(green[0], green[2])
        assert blue[2] > 1.2 * max(blue[0], blue[1]) and 60 < blue[3] < 230  # what is behind it is seen, too
        assert max(plain[:3]) < 2 * min(plain[:3])
        assert page.complaints == []


def test_inertia_ellipsoids_have_the_links_inertia(page, tmp_path):
    """A solid ellipsoid x = M u, |u| <= 1 has the inertia m / 5 (tr(M M') 1 - M M')."""
    values = {"ixx": 0.031, "iyy": 0.047, "izz": 0.055, "ixy": 0.006, "ixz": -0.004, "iyz": 0.003}
    (tmp_path / "e.urdf").write_text(
        '<robot name="e"><link name="a"><inertial><mass value="3"/><inertia ' + " ".join(f'{k}="{v}"' for k, v in values.items())
        + "/></inertial>"
        '<visual><geometry><box size="0.4 0.3 0.2"/></geometry></visual></link></robot>'
    )
    assert dyn("view", tmp_path / "e.urdf", "--floating", "--html", tmp_path / "e.html").returncode == 0
    page.open(f"file://{tmp_path}/e.html")
    e = page("dynView.overlays.groups.inertia.map((mesh) => mesh.matrix.elements)")
    assert len(e) == 1
    product = [[sum(e[0][4 * k + i] * e[0][4 * k + j] for k in range(3)) for j in range(3)] for i in range(3)]
    trace = sum(product[i][i] for i in range(3))
    for i in range(3):
        for j in range(3):
            expected = values["i" + "".join(sorted("xyz"[i] + "xyz"[j]))]
            assert 3 / 5 * ((trace if i == j else 0) - product[i][j]) == pytest.approx(expected, abs=1e-9)


def test_a_robot_without_shapes_is_drawn_as_lines(page, tmp_path):
    body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    (tmp_path / "bare.urdf").write_text(
        f'<robot name="bare"><link name="a"/><link name="b">{body}</link><link name="c">{body}</link>'
        '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/></joint>'
        '<joint name="k" type="continuous"><parent link="b"/><child link="c"/><origin xyz="0 0 1"/><axis xyz="0 1 '
        '0"/></joint></robot>'
    )
    assert dyn("view", tmp_path / "bare.urdf", "--fixed", "--html", tmp_path / "bare.html").returncode == 0
    page.open(f"file://{tmp_path}/bare.html")
    assert page("dynView.robot.layers.skeleton.filter((line) => line.visible).length") == 1
    assert "no shapes" in page("document.getElementById('side').innerText")


def test_meshes_are_drawn(page, tmp_path):
    """A visual mesh file: a tetrahedron of 1 m, scaled by 0.5."""
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    (tmp_path / "t.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners)
                                    + "".join("f " + " ".join(str(i + 1) for i in f) + "\n" for f in faces))
    (tmp_path / "t.urdf").write_text(
        '<robot name="t"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" '
        'iyz="0"/></inertial><visual><geometry><mesh filename="t.obj" scale="0.5 0.5 '
        '0.5"/></geometry></visual><visual><geometry><mesh filename="gone.obj"/></geometry></visual></link></robot>'
    )
    made = dyn("view", tmp_path / "t.urdf", "--floating", "--html", tmp_path / "t.html")
    assert made.returncode == 0, made.stderr
    page.open(f"file://{tmp_path}/t.html")
    boxes = page("dynView.robot.layers.visual.map((m) => (m.geometry.computeBoundingBox(), m.geometry.boundingBox.max.toArray()))")
    assert boxes == [pytest.approx([0.5, 0.5, 0.5], abs=1e-4)]
    assert "gone.obj" in page("document.getElementById('side').innerText")


def test_meshes_have_the_colours_of_their_files(page, tmp_path):
    """Cubes: one of red and green faces, one of it in the robot's blue, one whose file says nothing, one of many colours; with
    few triangles and with too many for the page."""
    corners = [(x, y, z) for x in (-0.4, 0.4) for y in (-0.4, 0.4) for z in (-0.4, 0.4)]
    faces = {"red": ["1 3 7 5", "2 6 8 4", "1 5 6 2"], "green": ["3 4 8 7", "1 2 4 3",
                                                                 "5 7 8 6"]}  # below, above, front; the rest
    (tmp_path / "m.mtl").write_text("newmtl red\nKd 0.9 0.05 0.05\nnewmtl green\nKd 0.05 0.9 0.05\n")
    vertices = "".join("v {} {} {}\n".format(*c) for c in corners)
    # grains inside of the cube: 100 000 triangles
    grains = "".join(f"v {0.001 * (k % 100):.4f} {0.001 * (k // 100 % 100):.4f} {0.001 * (k // 10000):.4f}\nv 0.3 0.3 {3e-6 * k:.6f}\nv 0.3 0.2 0\n" for k in range(100000))
    grains += "".join(f"f {3 * k + 9} {3 * k + 10} {3 * k + 11}\n" for k in range(100000))
    text = ("mtllib m.mtl\n" + vertices + "{}"
            + "".join(f"usemtl {name}\n" + "".join(f"f {face}\n" for face in list) for name, list in faces.items()))
    (tmp_path / "few.obj").write_text(text.format(""))
    (tmp_path / "plain.obj").write_text(vertices + "".join(f"f {face}\n" for list in faces.values() for face in list))
    (tmp_path / "many.obj").write_text(text.format("") + "usemtl green\n" + grains)
    red, green = (0.9, 0.05, 0.05), (0.05, 0.9, 0.05)
    coloured = "".join("v {} {} {} {} {} {}\n".format(*c, *(red if c[1] < 0 else green)) for c in corners)
    (tmp_path / "vertices.obj").write_text(coloured + "".join(f"f {face}\n" for list in faces.values() for face in list))
    body = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    paint = '<material name="b"><color rgba="0.05 0.05 0.9 1"/></material>'
    for files in (("few", "few", "plain", "vertices"), ("many",)):
        visuals = "".join(f'<visual><origin xyz="{k} 0 0"/><geometry><mesh filename="{name}.obj"/></geometry>{paint if k == 1 else ""}</visual>' for k, name in enumerate(files))
        (tmp_path / "c.urdf").write_text(f'<robot name="c"><link name="a">{body}{visuals}</link></robot>')
        made = dyn("view", tmp_path / "c.urdf", "--floating", "--html", tmp_path / "c.html")
        assert made.returncode == 0, made.stderr
        page.open(f"file://{tmp_path}/c.html")
        seen = seen_from_the_side(page)
        assert all(seen[0][0] > 3 * other for other in seen[0][1:3])
        if files == ("many",):
            assert "fewer triangles" in page("document.getElementById('side').innerText")
        else:
            assert (seen[1][2] > 3 * max(seen[1][:2]) and max(seen[2][:3]) < 2 * min(seen[2][:3])
                    and seen[3][0] > 3 * max(seen[3][1:3]))
            page.page.click("#look-top")
            assert page("dynView.robot.layers.visual.map((mesh) => mesh.material.vertexColors ? "
                        "mesh.geometry.attributes.color.count / 3 : 0)") == [12, 0, 0, 12]
        assert page.complaints == []
