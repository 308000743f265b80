"""dyn sim, info, view, accuracy, stress --html: what the pages show, and that they need nothing else."""

import json
import os
import re
import shutil
import subprocess
import sys

import pytest
from conftest import BUILT, MODELS, ROOT, dyn

GO2 = (MODELS / "robots/go2.urdf", "--floating", "--ground")


@pytest.fixture(scope="session")
def fall(bundle, tmp_path_factory):
    """A quadruped whose legs give way: half a second."""
    path = tmp_path_factory.mktemp("pages") / "fall.html"
    made = dyn("sim", *GO2, "--duration", 0.5, "--html", path, "--json", "--no-error-estimate")
    assert made.returncode == 0, made.stderr
    return path, json.loads(made.stdout)


def test_opens_offline_without_complaints(page, fall):
    page.open(f"file://{fall[0]}")
    page.page.wait_for_timeout(300)
    assert page.complaints == []
    assert page.requests == []


def test_robot_is_visible(page, fall):
    page.open(f"file://{fall[0]}")
    page("dynView.player.play(false), dynView.player.seek(0)")
    assert 0.02 < page.changed("dynView.robot.root.visible = false") < 0.5


def test_forces_are_visible(page, fall):
    page.open(f"file://{fall[0]}")
    page("dynView.player.play(false), dynView.player.seek(0.1)")
    assert page.changed("document.getElementById('show-contacts').click()") > 5e-4


def test_scrubbing_changes_the_pose(page, fall):
    page.open(f"file://{fall[0]}")
    page("dynView.player.play(false), dynView.player.seek(0)")
    height = "dynView.robot.joints[1].position.z"
    start = page(height)
    scrub = "(() => { const s = document.getElementById('scrub'); s.value = 0.5; s.dispatchEvent(new Event('input')); })()"
    assert page.changed(scrub) > 0.01
    assert page(height) < start - 0.05


def test_poses_are_those_of_the_simulation(page, fall):
    page.open(f"file://{fall[0]}")
    page("dynView.player.play(false), dynView.player.seek(0.5)")
    q = fall[1]["q"]
    assert (page("dynView.robot.joints[1].position.toArray()")
            == pytest.approx(q[:3], abs=2e-5))  # 16 bits of what the robot covers
    turn = page("dynView.robot.joints[1].quaternion.toArray()")
    assert abs(sum(x * y for x, y in zip(turn, q[3:7]))) == pytest.approx(1, abs=1e-8)
    evaluated = json.loads(dyn("eval", *GO2[:2], "--compute", "placements", "--q", *q, "--json").stdout)["placements"]
    names = page("dynView.head.model.frames.map((f) => f.name)")
    elements = page("dynView.robot.frames.map((f) => f.matrixWorld.elements)")
    for name in ("FL_foot", "FR_calf", "RL_hip", "base"):
        assert elements[names.index(name)][12:15] == pytest.approx(evaluated[name]["translation"], abs=1e-4)


def test_contact_forces_carry_the_weight(page, tmp_path):
    """A ball on the ground: one contact, its force the weight."""
    (tmp_path / "ball.xml").write_text(
        '<mujoco><worldbody><geom type="plane" size="1 1 1"/><body pos="0 0 0.1"><freejoint/><geom type="sphere" size="0.1" '
        'mass="2"/></body></worldbody></mujoco>'
    )
    assert dyn("sim", tmp_path / "ball.xml", "--duration", 0.2, "--html", tmp_path / "ball.html").returncode == 0
    page.open(f"file://{tmp_path}/ball.html")
    contacts = page("dynView.recording.contactsAt(dynView.recording.moments - 1).map((c) => ({force: c.force, position: "
                    "[...c.position]}))")
    assert len(contacts) == 1
    assert contacts[0]["force"] == pytest.approx([0, 0, 2 * 9.81], rel=1e-4, abs=1e-3)
    assert contacts[0]["position"][2] == pytest.approx(0, abs=1e-4)
    # the arrow ends where the force says
    box = page("(() => { const o = dynView.overlays; const m = o.heads.matrix.clone(); o.heads.getMatrixAt(0, m); return "
               "m.elements[14] / dynView.scene.size; })()")
    assert box == pytest.approx(0.67, rel=1e-3)


def test_plays_and_stops(page, fall):
    page.open(f"file://{fall[0]}")
    page("dynView.player.play(false), dynView.player.seek(0)")
    page.page.select_option("#speed", "0.05")
    page.page.click("#play")
    page.page.wait_for_function("dynView.player.time > 0.01 && (document.getElementById('play').click(), true)")  # at once, however slow the machine
    stopped = page("dynView.player.time")
    page.page.wait_for_timeout(100)
    assert page("dynView.player.time") == stopped
    assert 0.01 < stopped < 0.5


def test_plots_are_there_and_follow(page, fall):
    page.open(f"file://{fall[0]}")
    titles = page("dynView.plots.map((p) => p.plot.title)")
    assert {"contact forces", "energy", "q", "v", "tau", "residual", "penetration", "time of a step", "ledger"} <= set(titles)
    page("document.querySelectorAll('details').forEach((d) => (d.open = true))")
    page.settle()
    assert page("[...document.querySelectorAll('.plot')].filter((plot) => plot.querySelector('canvas')).length") == len(titles)
    page("dynView.player.play(false), dynView.player.seek(0.25)")
    at = page("dynView.plots.map((p) => p.graph.toDataXCoord(new DOMMatrix(p.line.style.transform).e))")
    assert at == pytest.approx([0.25] * len(at), abs=5e-3)
    page.page.locator(".plot").first.click(position={"x": 70, "y": 50})
    assert page("dynView.player.time") < 0.1
    # curves are drawn, each in its colour, and go when their name is clicked
    coloured = """(() => { const c = dynView.plots.find((p) => p.plot.title === 'energy').graph.hidden_;
        const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let n = 0;
        for (let i = 0; i < d.length; i += 4) n += d[i + 3] > 0 && d[i] < 100 && d[i + 2] > 150; return n; })()"""  # #1f77b4
    assert page(coloured) > 100
    page.page.locator("details:has(.plot)", has_text="energy").first.locator(".key > span").nth(1).click()
    assert page(coloured) == 0


def test_a_part_of_a_plot_is_shown_larger_in_all(page, fall):
    page.open(f"file://{fall[0]}")
    page("dynView.player.play(false)")
    plot = page.page.locator(".plot").first
    plot.hover(position={"x": 120, "y": 60})
    page.page.mouse.down()
    plot.hover(position={"x": 200, "y": 62})
    page.page.mouse.up()
    windows = page("dynView.plots.filter((p) => p.graph).map((p) => p.graph.xAxisRange())")
    assert len(windows) > 1 and 0 < windows[0][0] < windows[0][1] < 0.5 and all(w == pytest.approx(windows[0]) for w in windows)
    plot.dblclick(position={"x": 120, "y": 60})
    windows = page("dynView.plots.filter((p) => p.graph).map((p) => p.graph.xAxisRange())")
    assert all(w == pytest.approx([0, 0.5], abs=1e-6) for w in windows)


def test_tables_tell_error_and_time_of_effects(page, fall):
    page.open(f"file://{fall[0]}")
    text = page("document.getElementById('side').innerText")
    assert "error ledger" in text and "energy defect" in text
    assert "time per effect" in text and re.search(r"contact\s+[\d.-]+", text)


def test_picking_tells_the_link(page, fall):
    page.open(f"file://{fall[0]}")
    page("dynView.player.play(false), dynView.player.seek(0)")
    page.page.click("#look-side")
    page.settle()
    x, y = page(
        """(() => { const v = dynView, p = v.robot.joints[1].position.clone().project(v.scene.camera), b = v.scene.canvas.getBoundingClientRect();
        return [b.left + (p.x + 1) / 2 * b.width, b.top + (1 - p.y) / 2 * b.height]; })()"""
    )
    page.page.mouse.click(x, y)
    text = page("document.getElementById('link').innerText")
    assert text.startswith("base") and "kg" in text and "root_joint" in text and "q\t" in text


def test_switches_show_and_hide(page, fall):
    page.open(f"file://{fall[0]}")
    page("dynView.player.play(false), dynView.player.seek(0)")
    for name in ("frames", "inertia", "com", "collision", "skeleton"):
        assert page.changed(f"document.getElementById('show-{name}').click()") > 1e-4, name


def test_thirty_seconds_of_a_humanoid_are_under_5_mb_and_light_to_draw(page, tmp_path):
    made = dyn("sim", MODELS / "robots/humanoid.urdf", "--floating", "--ground", "--duration", 30, "--dt", 5e-3,
               "--no-error-estimate", "--html", tmp_path / "h.html")
    assert made.returncode == 0, made.stderr
    assert (tmp_path / "h.html").stat().st_size < 5e6
    page.open(f"file://{tmp_path}/h.html")
    assert page("dynView.recording.moments") >= 1790  # 60 a second
    page("dynView.player.play(false), dynView.player.seek(1)")
    page.settle()
    calls, triangles = page("(({ calls, triangles }) => [calls, triangles])(dynView.scene.renderer.info.render)")
    assert calls < 200 and triangles < 200_000  # what any graphics card draws 60 times a second
    # what the page itself does for a frame, all plots open and nothing rasterised: as little late as early
    page("document.querySelectorAll('details').forEach((d) => (d.open = true))")
    page.settle()
    early, late = (page(FRAME_WORK % t) for t in (1, 29))
    assert early["redrawn"] == late["redrawn"] == 0  # a cursor moves over the plots, which stay as they are
    assert early["objects"] == late["objects"] < 400  # whose places are computed
    assert max(early["gl"], late["gl"]) < 1000 and max(early["draws"], late["draws"]) < 120
    session = page.page.context.new_cdp_session(page.page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    time = lambda: next(m["value"] for m in session.send("Performance.getMetrics")["metrics"]
                        if m["name"] == "ThreadTime")  # of the page's thread, on a processor
    page("window.frames600()")
    before = time()
    page("window.frames600()")
    print(f"a frame takes the page {1e3 * (time() - before) / 600:.2f} ms of a processor, of 16.7 ms at 60 a second")


FRAME_WORK = """(() => {
  const { player, scene, plots } = dynView, gl = scene.renderer.getContext(), counts = { gl: 0, draws: 0, redrawn: 0, objects: 0 };
  const frame = (t) => (player.seek(t), scene.draw());
  scene.scene.traverse(() => ++counts.objects);
  for (const { graph } of plots) graph.updateOptions({ drawCallback: () => ++counts.redrawn }, true);
  const own = [];
  for (const name in gl) {
    if (typeof gl[name] !== "function") continue;
    const draws = /^draw/.test(name), call = gl[name].bind(gl);
    gl[name] = (...all) => (++counts.gl, draws ? ++counts.draws : call(...all));
    own.push(name);
  }
  frame(%g);
  for (const name of own) delete gl[name];
  for (const name of ["drawArrays", "drawElements", "drawArraysInstanced", "drawElementsInstanced"]) gl[name] = () => {};
  window.frames600 = () => { for (let k = 0; k < 600; ++k) frame(1 + k / 22); };
  return counts; })()"""


def test_long_recordings_are_thinned_and_say_so(tmp_path):
    made = dyn("sim", MODELS / "robots/double_pendulum.urdf", "--fixed", "--duration", 1500, "--dt", 0.01, "--no-error-estimate",
               "--html", tmp_path / "p.html")
    assert made.returncode == 0, made.stderr
    text = (tmp_path / "p.html").read_text()
    assert len(text) < 5e6
    assert "thinned to" in text


def test_names_that_look_like_markup_stay_names(page, tmp_path):
    name = "</script><script>window.broken = true</script>"
    escaped = name.replace("<", "&lt;").replace(">", "&gt;")
    (tmp_path / "evil.urdf").write_text(
        f'<robot name="{escaped}"><link name="{escaped}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" '
        'ixz="0" iyz="0"/></inertial><collision><geometry><sphere radius="0.1"/></geometry></collision></link></robot>'
    )
    made = dyn("view", tmp_path / "evil.urdf", "--floating", "--html", tmp_path / "evil.html")
    assert made.returncode == 0, made.stderr
    page.open(f"file://{tmp_path}/evil.html")
    assert page("window.broken") is None
    made = dyn("accuracy", tmp_path / "evil.urdf", "--floating", "--duration", 0.1, "--budget", "1s", "--html",
               tmp_path / "a.html")
    assert made.returncode == 0, made.stderr
    page.page.goto(f"file://{tmp_path}/a.html")
    assert page("window.broken") is None and name in page("document.querySelector('h1').textContent")
    page.open(f"file://{tmp_path}/evil.html")
    assert page("dynView.head.model.name") == name and page("document.querySelector('header b').textContent") == name


def test_view_moves_joints_by_hand(page, tmp_path):
    made = dyn("view", MODELS / "robots/gripper.urdf", "--fixed", "--html", tmp_path / "g.html")
    assert made.returncode == 0, made.stderr
    page.open(f"file://{tmp_path}/g.html")
    assert page.complaints == []
    info = json.loads(dyn("info", MODELS / "robots/gripper.urdf", "--fixed", "--json").stdout)
    state = {}
    for slider in page.page.locator(".joint input").all():
        low, high = float(slider.get_attribute("min")), float(slider.get_attribute("max"))
        state[slider.get_attribute("data-joint")] = x = low + 0.7 * (high - low)
        slider.fill(str(x))
    assert len(state) == info["nv"]
    (tmp_path / "s.json").write_text(json.dumps({"q": state}))
    placements = json.loads(dyn("eval", MODELS / "robots/gripper.urdf", "--fixed", "--compute", "placements,com", "--state",
                                tmp_path / "s.json", "--json").stdout)
    assert page("dynView.overlays.com.position.toArray()") == pytest.approx(placements["com"], abs=1e-6)
    placements = placements["placements"]
    shown = dict(zip(page("dynView.head.model.frames.map((f) => f.name)"),
                     page("dynView.robot.frames.map((f) => f.matrixWorld.elements)")))
    for name, placement in placements.items():
        if name in shown:
            assert shown[name][12:15] == pytest.approx(placement["translation"], abs=1e-6), name


def frames_follow_sliders(page, model, html, count):
    """Frames are where the library says for the q that the page shows, once each slider was moved."""
    made = dyn("view", model, "--html", html)
    assert made.returncode == 0, made.stderr
    page.open(f"file://{html}")
    sliders = page.page.locator(".joint input").all()
    assert len(sliders) == count
    for k, slider in enumerate(sliders):
        low, high = float(slider.get_attribute("min")), float(slider.get_attribute("max"))
        slider.fill(str(low + (0.55 + 0.017 * k) * (high - low)))
    q = page("Array.from(dynView.kinematics.q)")
    placements = json.loads(dyn("eval", model, "--compute", "placements", "--q", *q, "--json").stdout)["placements"]
    names = page("dynView.head.model.frames.map((f) => f.name)")
    elements = page("dynView.robot.frames.map((f) => f.matrixWorld.elements)")
    for name, e in zip(names[1:], elements[1:]):
        assert e[12:15] == pytest.approx(placements[name]["translation"], abs=1e-6), name
        assert ([e[4 * j + i] for i in range(3) for j in range(3)]
                == pytest.approx([x for row in placements[name]["rotation"] for x in row], abs=1e-6)), name
    assert page.complaints == []


def test_view_moves_joints_of_several_coordinates(page, tmp_path):
    """Every type of joint that an MJCF or the builder has, in one chain: frames are where the library says for the q that the
    page shows."""
    made = subprocess.run([sys.executable, "-c", CHAIN, tmp_path / "c.dynb"], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(ROOT / "capi/python"),
                               "DYN_LIBRARY": str(BUILT.parents[1] / "lib")})
    assert made.returncode == 0, made.stderr
    frames_follow_sliders(page, tmp_path / "c.dynb", tmp_path / "c.html", 6 + 3 + 3 + 3 + 3 + 2 + 2 + 1 + 1)  # nv of each


def test_view_moves_composite_joints(page, tmp_path):
    """Chains in one joint, also of joints of several coordinates and behind fixed parts, one below another and beside a
    follower."""
    made = subprocess.run([sys.executable, "-c", COMPOSITES, tmp_path / "c.dynb"], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(ROOT / "capi/python"),
                               "DYN_LIBRARY": str(BUILT.parents[1] / "lib")})
    assert made.returncode == 0, made.stderr
    frames_follow_sliders(page, tmp_path / "c.dynb", tmp_path / "c.html", 2 + 1 + 11 + 2)


COMPOSITES = """
import sys
import libdyn as dyn
X = [0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1, 0.1, 0.2, 0.3]
Y = [1, 0, 0, 0, 0, 1, 0, -1, 0, 0.3, -0.1, 0.2]
inertia = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]
hinge = dict(type="revolute", axis=(0.6, 0, 0.8), placement=X)
b = dyn.Builder("composites")
b.add_joint("simple", "composite", placement=Y, parts=[hinge, dict(type="prismatic", axis=(0, 1, 0), placement=Y)])
b.add_joint("lead", "revolute", parent="simple", placement=X, axis=(1, 0, 0), lower=[-1.5], upper=[1.5])
b.add_joint("follow", "revolute", parent="lead", placement=X, axis=(0, 1, 0), mimic="lead", mimic_ratio=0.7, mimic_offset=0.1)
parts = [dict(type="spherical", placement=X), dict(type="fixed", placement=X), dict(type="revolute_unbounded", axis=(0, 0.6, 0.8), placement=Y)]
parts += [dict(type="helical", axis=(0, 1, 0), pitch=0.2), dict(type="planar", placement=X, axis=(0, 0, -1)), dict(type="spherical", placement=Y)]
b.add_joint("many", "composite", parent="follow", placement=X, parts=parts, armature=[0.1] * 11)
b.add_joint("last", "composite", parent="many", placement=Y, parts=[dict(type="universal", axis=(0, 0, 1), axis2=(1, 0, 0), placement=X)])
for name in ("simple", "lead", "follow", "many", "last"):
    b.add_body(f"of {name}", name, 1, inertia=inertia)
b.finish().save(sys.argv[1])
"""

CHAIN = """
import sys
import libdyn as dyn
types = ["free_flyer", "spherical", "spherical_zyx", "planar", "translation", "cylindrical", "universal", "revolute_unbounded", "helical"]
b, above = dyn.Builder("chain"), None
for k, type in enumerate(types):
    b.add_joint(f"j{k}", type, parent=above, placement=[1, 0, 0, 0, 0, 1, 0, -1, 0, 0.1, 0.2, 0.3], axis=(0.6, 0, 0.8) if k % 2 else (0, 0, -1), axis2=(0, 1, 0), pitch=0.1)
    b.add_body(f"b{k}", f"j{k}", 1, inertia=[[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
    above = f"j{k}"
b.finish().save(sys.argv[1])
"""


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


def test_info_page_shows_robot_and_tables(page, tmp_path):
    made = dyn("info", MODELS / "robots/panda.urdf", "--fixed", "--html", tmp_path / "i.html")
    assert made.returncode == 0, made.stderr
    page.open(f"file://{tmp_path}/i.html")
    assert page.complaints == []
    page("document.querySelectorAll('details').forEach((d) => (d.open = true))")
    text = page("document.getElementById('side').innerText")
    assert "panda_joint4" in text and "load report" in text and "gravity" in text


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


def test_accuracy_and_stress_pages(page, tmp_path):
    made = dyn("accuracy", MODELS / "robots/double_pendulum.urdf", "--fixed", "--q", "1.2,0.4", "--duration", 0.2, "--budget",
               "3s", "--target", "1e-3m", "--html", tmp_path / "a.html")
    assert made.returncode == 0, made.stderr
    page.page.goto(f"file://{tmp_path}/a.html")
    assert page("document.querySelectorAll('svg circle').length") > 5
    assert page("[...document.querySelectorAll('svg')].map((s) => s.getBoundingClientRect()).filter((b) => b.width > 100 && "
                "b.height > 50).length") == 2
    assert "--integrator" in page("document.body.innerText")  # the recommendation
    made = dyn("stress", "pendulums", "--html", tmp_path / "s.html")
    page.page.goto(f"file://{tmp_path}/s.html")
    assert page("document.querySelectorAll('svg polyline').length") > 0
    assert "passed" in page("document.body.innerText")
    assert page.complaints == [] and page.requests == []


def test_a_simulation_that_fails_leaves_what_it_was_until_then(page, tmp_path):
    made = dyn("sim", MODELS / "robots/double_pendulum.urdf", "--fixed", "--duration", 300, "--dt", 1, "--integrator", "rk4",
               "--v", "100,-300", "--html", tmp_path / "f.html")
    assert made.returncode == 1 and "overflows" in made.stderr
    page.open(f"file://{tmp_path}/f.html")
    assert page.complaints == []
    assert page("dynView.recording.moments") > 1
    assert "the simulation failed" in page("document.getElementById('side').innerText")


def test_refusals(tmp_path):
    robot = tmp_path / "robot.urdf"
    robot.write_text((MODELS / "robots/double_pendulum.urdf").read_text())
    for command in (("sim", robot, "--duration", 1), ("info", robot), ("view", robot)):
        refused = dyn(*command, "--fixed", "--html", robot)
        assert refused.returncode == 2 and "overwritten" in refused.stderr
    refused = dyn("view", robot, "--fixed", "--html", tmp_path / "no/such/folder.html")
    assert refused.returncode == 1 and "cannot be written" in refused.stderr


def test_without_the_template_it_says_what_is_missing(tmp_path):
    """The command where the page is not beside it: as when it was built where no packages for it were to be had."""
    (tmp_path / "bin").mkdir()
    shutil.copy(BUILT, tmp_path / "bin/dyn")
    library = BUILT.parents[1] / "lib"

    for command in ("view", "info"):
        made = subprocess.run([tmp_path / "bin/dyn", command, MODELS / "robots/double_pendulum.urdf", "--fixed", "--html",
                               tmp_path / "x.html"], capture_output=True, text=True,
                               env={**os.environ, "LD_LIBRARY_PATH": str(library)})
        assert made.returncode == 1 and "npm" in made.stderr and "libjs-three" in made.stderr and "viewer.html" in made.stderr
        assert not (tmp_path / "x.html").exists()
