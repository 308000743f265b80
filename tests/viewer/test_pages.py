"""dyn sim, info, view, accuracy, stress --html: what the pages show, and that they need nothing else."""

import json
import os
import re
import shutil
import subprocess

import pytest
from conftest import BUILT, MODELS, Page, dyn

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


def test_nothing_from_outside_is_allowed(browser, fall):
    """By the page's own policy: it draws under it, and neither a request nor an image of another origin is made."""
    context = browser.new_context()
    tab = context.new_page()
    tab.goto(f"file://{fall[0]}")
    while not tab.evaluate("window.dynView && window.dynView.scene.drawn > 0"):
        tab.wait_for_timeout(50)
    violations = [tab.evaluate("new Promise((done) => (document.addEventListener('securitypolicyviolation', (event) => "
                               f"done(event.effectiveDirective), {{once: true}}), {act}))")
                  for act in ("fetch('http://127.0.0.1:9/x').catch(() => 0)", "new Image().src = 'http://127.0.0.1:9/y.png'")]
    context.close()
    assert violations == ["connect-src", "img-src"]


def test_a_phone_shows_the_robot(browser, fall):
    """The box of switches is folded, and the page is no wider than the screen."""
    context = browser.new_context(viewport={"width": 390, "height": 800}, has_touch=True, bypass_csp=True)
    page = Page(context.new_page()).open(f"file://{fall[0]}")
    box, view = (page(f"(() => {{ const b = document.{where}.getBoundingClientRect(); return [b.width, b.height]; }})()")
                 for where in ("getElementById('tools')", "getElementById('view')"))
    assert box[0] * box[1] < 0.05 * view[0] * view[1]
    assert page("document.documentElement.scrollWidth") <= 390
    page.page.click("#tools summary")
    assert page.page.is_visible("#show-com")
    context.close()


def test_dark_mode(browser, fall):
    """Paper and ink change places; the robot stays visible."""
    context = browser.new_context(color_scheme="dark", viewport={"width": 800, "height": 500}, bypass_csp=True)
    page = Page(context.new_page()).open(f"file://{fall[0]}")
    tones = page("['color', 'background-color'].map((x) => getComputedStyle(document.body)[x].match(/[0-9]+/g).slice(0, 3)"
                 ".reduce((sum, y) => sum + Number(y), 0))")
    assert tones[0] > 600 > 150 > tones[1]
    page("dynView.player.play(false)")
    assert page.changed("dynView.robot.root.visible = false") > 0.02
    context.close()


def test_buttons_and_fields(page, fall):
    """Fit brings back a robot that was lost; a picture is saved; curves are searched; whatever is moved has a name."""
    page.open(f"file://{fall[0]}")
    page("dynView.player.play(false), dynView.player.seek(0)")
    page("(() => { const c = dynView.scene.controls; c.target.set(30, 0, 0); c.update(); })()")
    assert page.changed("dynView.robot.root.visible = false") == 0
    page("dynView.robot.root.visible = true")
    page.page.click("#fit")
    assert page.changed("dynView.robot.root.visible = false") > 0.02
    with page.page.expect_download() as saved:
        page.page.click("#save-picture")
    data = open(saved.value.path(), "rb").read()
    assert saved.value.suggested_filename.endswith(".png") and data[:8] == b"\x89PNG\r\n\x1a\n" and len(data) > 5000
    page.page.locator("input[type=search]").first.fill("FL_")
    names = page("(() => { const f = document.querySelector('input[type=search]'); return Array.from(f.parentElement."
                 "querySelectorAll('.key > span'), (s) => [s.textContent, s.hidden]).slice(1); })()")
    assert len(names) > 12 and all(hidden == ("FL_" not in name) for name, hidden in names)
    assert page("Array.from(document.querySelectorAll('input:not(.dygraph-roller), select, #canvas, button'), (e) => "
                "e.getAttribute('aria-label') || e.closest('label')?.textContent.trim() || e.textContent.trim())"
                ".filter((name) => !name).length") == 0
    assert page.complaints == []


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
    # at once, however slow the machine, and once: what is waited for may be asked again
    page.page.wait_for_function("dynView.player.time > 0.01 && (dynView.player.playing && document.getElementById('play').click(), true)")
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


def test_info_page_shows_robot_and_tables(page, tmp_path):
    made = dyn("info", MODELS / "robots/panda.urdf", "--fixed", "--html", tmp_path / "i.html")
    assert made.returncode == 0, made.stderr
    page.open(f"file://{tmp_path}/i.html")
    assert page.complaints == []
    page("document.querySelectorAll('details').forEach((d) => (d.open = true))")
    text = page("document.getElementById('side').innerText")
    assert "panda_joint4" in text and "load report" in text and "gravity" in text


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
    made = dyn("sim", MODELS / "robots/double_pendulum.urdf", "--fixed", "--duration", 300, "--dt", 1, "--integrator",
               "implicit_midpoint", "--v", "3,1", "--html", tmp_path / "f.html")
    assert made.returncode == 1 and "does not converge" in made.stderr
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
