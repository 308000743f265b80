"""Pages of models with tendons: their paths, and nothing of them in other pages."""

import pytest
from conftest import MODELS, dyn
from test_live import Live

ARM = """<mujoco><worldbody><site name="hook" pos=".3 0 .1"/><body name="arm"><joint name="j" axis="0 1 0"/>
<geom name="ball" type="sphere" size=".08"/><geom type="capsule" fromto="0 0 0 0 0 -.5" size=".02"/><site name="s" pos=".02 0 -.4"/></body>
</worldbody><tendon><spatial name="muscle"><site site="hook"/><geom geom="ball"/><site site="s"/></spatial>
<spatial name="cord"><site site="hook"/><site site="s"/></spatial></tendon>
<actuator><muscle name="m" tendon="muscle" force="20" lengthrange=".2 .9"/></actuator></mujoco>"""
PIECES = "dynView.recording.tendonsAt({})"


@pytest.fixture
def arm(tmp_path):
    file = tmp_path / "arm.xml"
    file.write_text(ARM)
    return file


def test_paths_follow_the_simulation(page, arm, tmp_path):
    made = dyn("sim", arm, "--duration", 0.5, "--ctrl", 1, "--html", tmp_path / "a.html", "--no-error-estimate")
    assert made.returncode == 0, made.stderr
    page.open(f"file://{tmp_path}/a.html")
    page("dynView.player.play(false), dynView.player.seek(0)")
    last = page("dynView.recording.moments - 1")
    first, end = (page(f"Array.from({PIECES.format(k)})") for k in (0, last))
    assert first[:3] == pytest.approx([0.3, 0, 0.1], abs=1e-4) and first[-4:-1] == pytest.approx([0.02, 0, -0.4], abs=1e-3)
    assert first[-4:-1] != pytest.approx(end[-4:-1], abs=1e-2)
    assert first[6] == pytest.approx(0, abs=1e-3) and end[6] > 0.9 and end[-1] == -1  # activation; the cord has none
    assert page.changed("document.getElementById('show-tendons').click()") > 2e-4
    assert page.complaints == []


def test_paths_are_drawn_live(page, arm):
    live = Live(arm)
    page.open(live.address)
    page.page.wait_for_function("window.dynView.live.state && window.dynView.live.state.tendons.length >= 14")
    assert page("dynView.overlays.groups.tendons[0].geometry.attributes.position.count") >= 4
    live.stop()
    assert not [c for c in page.complaints if "WebSocket" not in c]


def test_joints_moved_by_hand_take_the_paths_away(page, arm, tmp_path):
    made = dyn("view", arm, "--html", tmp_path / "v.html")
    assert made.returncode == 0, made.stderr
    page.open(f"file://{tmp_path}/v.html")
    count = "dynView.overlays.groups.tendons[0].geometry.attributes.position.count"
    assert page(count) >= 4
    page("(() => { const s = document.querySelector('.joint input'); s.value = 0.5; s.dispatchEvent(new Event('input')); })()")
    assert page(count) == 0


def test_info_lists_them(page, arm, tmp_path):
    made = dyn("info", arm, "--html", tmp_path / "i.html")
    assert made.returncode == 0, made.stderr
    page.open(f"file://{tmp_path}/i.html")
    page("document.querySelectorAll('details').forEach((d) => (d.open = true))")
    text = page("document.getElementById('side').innerText")
    assert "cord" in text and "tendon muscle" in text


def test_nothing_in_pages_of_other_models(page, tmp_path):
    made = dyn("info", MODELS / "robots/panda.urdf", "--fixed", "--html", tmp_path / "i.html")
    assert made.returncode == 0, made.stderr
    page.open(f"file://{tmp_path}/i.html")
    assert page("dynView.head.recording.tendons === undefined && !document.getElementById('show-tendons')")
    assert page("dynView.overlays.groups.tendons.length") == 0
