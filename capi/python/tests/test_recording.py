"""Recordings: arrays, tables, pages; and pages that are live."""

import base64
import csv
import json
import os
import socket
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from command import CLI
from conftest import MODELS

import libdyn as dyn
from libdyn import page, sliders

SCENE = MODELS / "scenes" / "go2_stands.xml"
EXAMPLE = """<mujoco><worldbody><body name="ball" pos="0 0 .3"><freejoint name="free"/>
<geom type="sphere" size=".1"/><site name="s"/></body><geom type="plane" size="5 5 1"/></worldbody>
<sensor><accelerometer name="imu" site="s"/><touch name="touch" site="s"/></sensor></mujoco>"""


@pytest.fixture
def pages(monkeypatch):
    if not CLI:
        pytest.skip("the command dyn is not built")
    monkeypatch.setenv("DYN_CLI", CLI)
    try:
        page.still(dyn.load_string(EXAMPLE))
    except dyn.UnsupportedError as error:
        if "there is no page to fill" in str(error):
            pytest.skip("built without a viewer")
        raise


def ball():
    return dyn.Simulation(dyn.load_string(EXAMPLE), dt=1e-3)


def test_recording_changes_nothing():
    """Steps are bit for bit those that are not recorded."""
    a, b = dyn.Simulation(SCENE, "standing"), dyn.Simulation(SCENE, "standing")
    with a.record(every=3) as r:
        a.run(0.3)
    b.run(0.3)
    assert np.array_equal(a.q, b.q) and np.array_equal(a.v, b.v) and len(r) == 51
    a.step()
    assert len(r) == 51, "it has ended"
    a, b = ball(), ball()
    a.record(every=1)
    a.run(0.5), b.run(0.5)
    assert np.array_equal(a.q, b.q)


def test_arrays():
    sim = ball()
    run, r = None, sim.record(every=1)
    run = sim.run(0.3)
    assert np.array_equal(r.q, run.q) and np.array_equal(r.v, run.v) and np.array_equal(r.t, run.t)
    assert r.tau.shape == r.v.shape and r.ctrl.shape == (301, 0) and r.actuator_force.shape == (301, 0)
    np.testing.assert_allclose(r.energy[:150].sum(1), r.energy[0].sum(), rtol=1e-2)  # it falls: 0.5 g t dt in height
    touches = np.array([len(c) for c in r.contacts])
    assert touches[0] == 0 and touches[-1] == 1 and r.sensors["imu"].shape == (301, 3)
    np.testing.assert_allclose(r.sensors["imu"][1:150], 0, atol=1e-9)
    assert (r.sensors["touch"][touches == 0] == 0).all() and "301 moments" in repr(r)
    sim.reset()
    sim.step(5)
    assert len(r) == 301, "a reset ends it"
    assert len(ball().record(every=5)) == 1
    with pytest.raises(dyn.ArgumentError, match="every"):
        sim.record(every=0)


def test_about_sixty_a_second_by_default():
    sim = ball()
    r = sim.record()
    sim.run(1.0)
    assert 55 <= len(r) <= 65


def test_csv(tmp_path):
    sim = dyn.Simulation(SCENE, "standing")
    r = sim.record(every=10)
    sim.run(0.1)
    r.to_csv(tmp_path / "r.csv")
    with open(tmp_path / "r.csv", newline="") as file:
        head, *rows = csv.reader(file)
    assert head[:2] == ["t", "q.root_joint[0]"] and "ctrl.FL_hip" in head and "force.RR_calf" in head and "contacts" in head
    table = np.array(rows, float)
    assert np.array_equal(table[:, 1 : 1 + sim.model.nq], r.q), "all digits"
    assert np.array_equal(table[:, head.index("kinetic")], r.energy[:, 0])


def test_parquet(tmp_path):
    sim = ball()
    r = sim.record()
    sim.run(0.1)
    try:
        import pyarrow.parquet as parquet
    except ImportError:
        with pytest.raises(dyn.UnsupportedError, match="pip install pyarrow"):
            r.to_parquet(tmp_path / "r.parquet")
        return
    r.to_parquet(tmp_path / "r.parquet")
    assert np.array_equal(parquet.read_table(tmp_path / "r.parquet")["t"], r.t)


def test_mcap(tmp_path):
    sim = ball()
    r = sim.record()
    sim.run(0.1)
    try:
        from mcap.reader import make_reader
    except ImportError:
        with pytest.raises(dyn.UnsupportedError, match="pip install mcap"):
            r.to_mcap(tmp_path / "r.mcap")
        return
    r.to_mcap(tmp_path / "r.mcap")
    with open(tmp_path / "r.mcap", "rb") as file:
        messages = [(c.topic, m.log_time, json.loads(m.data)) for _, c, m in make_reader(file).iter_messages()]
    rows = [x for topic, _, x in messages if topic == "/moment"]
    assert [x["t"] for x in rows] == r.t.tolist()
    assert [t for topic, t, _ in messages if topic == "/tf"] == [round(1e9 * t) for t in r.t]
    last = [x for topic, _, x in messages if topic == "/tf"][-1]["transforms"]
    (seen,) = [x for x in last if x["child_frame_id"] == "ball"]
    assert list(seen["translation"].values()) == pytest.approx(r.q[-1, :3].tolist(), abs=1e-12)


def unpacked(numbers, x):
    """What the page's reader makes of {at, n, as}."""
    if x["as"] == "q16":
        step, lower = np.array(x["step"]), np.array(x["lower"])
        moves = step > 0
        rows = x["n"] // len(step)
        out = np.tile(lower, (rows, 1))
        stored = np.frombuffer(numbers, "<u2", rows * moves.sum(), x["at"]).reshape(rows, -1)
        out[:, moves] += step[moves] * stored
        return out
    return np.frombuffer(numbers, {"f32": "<f4", "u16": "<u2", "u32": "<u4"}[x["as"]], x["n"], x["at"])


def test_page(pages, tmp_path):
    """The page of a recording has the keys of that of dyn sim, and its numbers are those of the recording."""
    sim = dyn.Simulation(SCENE, "standing")
    with sim.record(every=10) as r:
        sim.run(0.5)
    r.to_html(tmp_path / "r.html")
    text = (tmp_path / "r.html").read_text()
    head, numbers = page.read(text)
    subprocess.run([CLI, "sim", SCENE, "--configuration", "standing", "--duration", "0.1", "--no-error-estimate", "--html",
                    tmp_path / "s.html"], check=True, capture_output=True)
    theirs, _ = page.read((tmp_path / "s.html").read_text())
    assert theirs["recording"].keys() == head["recording"].keys() and theirs["model"].keys() == head["model"].keys()
    titles = {plot["title"] for plot in theirs["recording"]["plots"]} - {"time of a step", "ledger"}
    assert titles == {plot["title"] for plot in head["recording"]["plots"]} and theirs["kind"] == head["kind"]
    shown = head["recording"]
    np.testing.assert_allclose(unpacked(numbers, shown["time"]), r.t, atol=1e-6)
    plots = {plot["title"]: unpacked(numbers, plot["values"]) for plot in shown["plots"]}
    np.testing.assert_allclose(plots["q"], r.q, atol=1e-4)
    np.testing.assert_allclose(plots["energy"][:, 2], r.energy.sum(1), atol=1e-3)
    assert unpacked(numbers, shown["contacts"]["first"])[-1] == sum(map(len, r.contacts))
    forces = unpacked(numbers, shown["contacts"]["force"]).reshape(-1, 3)
    np.testing.assert_allclose(forces, [c.force_on_b for each in r.contacts for c in each], rtol=1e-6, atol=1e-6)
    d = sim.model.data()
    d.forward_kinematics(r.q[-1])
    base = d.frame_placement("base")
    np.testing.assert_allclose(unpacked(numbers, shown["positions"])[-1, :3], base.translation, atol=1e-4)
    np.testing.assert_allclose(unpacked(numbers, shown["turns"])[-1, :4], base.quaternion, atol=1e-4)
    assert 'srcdoc="' in r._repr_html_() and 'srcdoc="' in sim._repr_html_()


def test_page_with_tendons(pages, tmp_path):
    sim = dyn.Simulation(dyn.load_string("""<mujoco><worldbody><site name="a" pos="0 0 1"/><body pos="0 0 .5">
      <joint name="j" axis="0 1 0"/><geom type="capsule" size=".02" fromto="0 0 0 .4 0 0"/><site name="b" pos=".3 0 .05"/>
      </body></worldbody>
      <tendon><spatial name="t"><site site="a"/><site site="b"/></spatial></tendon>
      <actuator><muscle name="m" tendon="t" lengthrange=".3 .9" force="10"/></actuator></mujoco>"""))
    with sim.record() as r:
        sim.run(0.2, lambda s: [1.0], returns="ctrl")
    r.to_html(tmp_path / "r.html")
    head, numbers = page.read((tmp_path / "r.html").read_text())
    pieces = unpacked(numbers, head["recording"]["tendons"]["pieces"])
    assert pieces.shape == (len(r), 7)
    np.testing.assert_allclose(pieces[:, :3], np.tile([0, 0, 1], (len(r), 1)), atol=1e-12)
    assert pieces[0, 6] == 0 and pieces[-1, 6] > 0.9, "the muscle's activation"


def test_long_recordings_are_thinned(pages, monkeypatch):
    sim = ball()
    with sim.record(every=1) as r:
        sim.run(1.0)
    head, _ = page.read(page.recorded(sim.model, r))
    assert head["recording"]["moments"] <= 67
    monkeypatch.setattr(page, "MOST", 1000)
    head, _ = page.read(page.recorded(sim.model, r))
    assert head["recording"]["moments"] < 20 and any("thinned" in note for note in head["notes"])


def test_view(pages, tmp_path, go2, capsys):
    sim = ball()
    r = sim.record()
    sim.run(0.1)
    for what, kind in ((go2, "model"), (r, "simulation")):
        file = dyn.view(what, path=tmp_path / "v.html", open=False)
        assert page.read(Path(file).read_text())[0]["kind"] == kind
    with pytest.raises(dyn.ArgumentError, match="a Model, a Simulation or a Recording"):
        dyn.view(3)


def test_without_the_command(monkeypatch, tmp_path):
    monkeypatch.setenv("DYN_CLI", "")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr("libdyn.files._prefixes", lambda: [])
    sim = ball()
    r = sim.record()
    with pytest.raises(dyn.LibraryError, match="DYN_CLI"):
        r.to_html(tmp_path / "r.html")
    assert "moments" in r._repr_html_() and "<table>" in sim._repr_html_()


# --------------------------------------------------------------------------------------------------- live


class Client:
    """A page, as far as the server can tell."""

    def __init__(self, viewer, origin=None, word=None, host=None):
        self.socket = socket.create_connection(("127.0.0.1", viewer.port), timeout=30)
        here = f"127.0.0.1:{viewer.port}"
        words = [f"GET /{word or viewer.word}/ws HTTP/1.1", f"Host: {host or here}", "Upgrade: websocket",
                 "Connection: Upgrade", "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==", "Sec-WebSocket-Version: 13",
                 f"Origin: {origin or 'http://' + here}"]
        self.socket.sendall(("\r\n".join(words) + "\r\n\r\n").encode())
        self.file = self.socket.makefile("rb")
        self.status = int(self.file.readline().split()[1])
        self.headers = {}
        while (line := self.file.readline().strip()):
            name, _, value = line.decode().partition(": ")
            self.headers[name] = value

    def say(self, command):
        payload, mask = json.dumps(command).encode(), b"\1\2\3\4"
        assert len(payload) < 126
        self.socket.sendall(bytes([0x81, 0x80 | len(payload)]) + mask + bytes(b ^ mask[k % 4] for k, b in enumerate(payload)))

    def hear(self):
        opcode, n = self.file.read(2)
        n = struct.unpack(">H", self.file.read(2))[0] if n == 126 else n
        payload = self.file.read(n)
        return json.loads(payload) if opcode & 15 == 1 else np.frombuffer(payload, "<f4") if opcode & 15 == 2 else None

    def state(self, until):
        """The first state for which until(state) holds."""
        for _ in range(2000):
            x = self.hear()
            if isinstance(x, np.ndarray) and until(x):
                return x
        raise AssertionError("it does not come")


@pytest.fixture
def viewer(pages):
    with dyn.Simulation(SCENE, "standing").view(open=False) as v:
        yield v


def test_live(viewer):
    """A page sees the states, pauses, pushes, resets; the controller is called for each step."""
    sim, calls = viewer.simulation, []
    viewer.controller = lambda s: calls.append(s.time)
    t = threading.Thread(target=viewer.run)
    t.start()
    page_ = Client(viewer)
    assert page_.status == 101 and page_.headers["Sec-WebSocket-Accept"] == "s3pPLMBiTxaQ9kYGzzhZRbK+xOo="  # of RFC 6455
    m = sim.model
    x = page_.state(lambda x: x[0] > 0.1)
    assert len(x) == 10 + 7 * (m.njoints - 1) + 3 + m.nq + m.nv + 9 * int(x[9]) and x[1] == 0
    page_.say({"do": "speed", "factor": 4})
    page_.state(lambda x: x[2] == 4)
    base = 10 + 7 * (m.njoints - 1) + 3
    page_.say({"do": "push", "frame": m.frame_id("base"), "point": [0, 0, 0], "force": [0, 200, 0]})
    page_.state(lambda x: x[base + 1] > 0.02)
    page_.say({"do": "push", "frame": m.frame_id("base"), "point": [0, 0, 0], "force": [0, 0, 0]})
    page_.say({"do": "pause", "on": True})
    still = page_.state(lambda x: x[1] == 1)[0]
    assert page_.state(lambda x: True)[0] == still
    page_.say({"do": "reset"})
    page_.state(lambda x: x[0] == 0)
    page_.say({"do": "dance"})
    while not isinstance(said := page_.hear(), dict):
        pass
    assert "dance" in said["error"]
    viewer.close()
    t.join(20)
    assert not t.is_alive() and len(calls) > 50 and not viewer.is_running()


def test_sliders_and_single_steps(viewer):
    """A control that the page holds stays over the controller's; a step of a pause is one."""
    sim, dt = viewer.simulation, viewer.simulation.dt  # before another thread has the data
    viewer.controller = lambda s: {"ctrl": np.full(s.model.nu, 0.1)}
    t = threading.Thread(target=viewer.run)
    t.start()
    page_ = Client(viewer)
    page_.state(lambda x: x[0] > 0.02)
    page_.say({"do": "control", "index": 2, "value": -1.5})
    while not (isinstance(said := page_.hear(), dict) and said.get("held")):
        pass
    assert said["held"] == [2] and said["controls"][2] == -1.5 and said["controls"][1] == 0.1 and sim.ctrl[2] == -1.5
    page_.say({"do": "pause", "on": True})
    before = float(page_.state(lambda x: x[1] == 1)[0])
    for k in range(1, 4):
        page_.say({"do": "step"})
        page_.state(lambda x: x[0] > before + (k - 0.5) * dt)
    assert sim.time == pytest.approx(before + 3 * dt, abs=1e-6)
    page_.say({"do": "release"})
    while not (isinstance(said := page_.hear(), dict) and said.get("held") == []):
        pass
    for wrong in ({"index": 99, "value": 0}, {"index": 0}, {"index": 0, "value": "x"}):
        page_.say({"do": "control", **wrong})
        while not (isinstance(said := page_.hear(), dict) and "error" in said):
            pass
    viewer.close()
    t.join(20)
    assert not t.is_alive() and viewer.held == {}


def test_ranges_of_sliders(go2):
    found = sliders.of(dyn.load(SCENE))
    assert len(found) == 12 and not found.torques and all(x["lower"] < 0.1 < x["upper"] or "calf" in x["name"]
                                                          for x in found.described)
    torques = sliders.of(go2)
    assert torques.torques and [x["name"] for x in torques.described][:2] == ["tau FL_hip_joint", "tau FL_thigh_joint"]
    assert torques.described[0]["upper"] == go2.effort_limit[6] == -torques.described[0]["lower"]
    sim = dyn.Simulation(go2)
    torques.hold(sim, {1: 2.5})
    assert sim.tau[7] == 2.5 and torques.values(sim)[1] == 2.5 and np.count_nonzero(sim.tau) == 1
    torques.release(sim, {1: 2.5})
    assert not sim.tau.any()


def test_a_loop_of_ones_own(viewer):
    page_ = Client(viewer)
    while not viewer._pages:
        time.sleep(0.01)
    for _ in range(20):
        viewer.simulation.step()
        viewer.sync()
        time.sleep(0.01)
    assert page_.state(lambda x: x[0] > 0)[0] > 0
    viewer._gone_since = time.monotonic() - 10
    assert not viewer.is_running(), "its page was closed"


def test_a_duration(viewer):
    t = threading.Thread(target=viewer.run, args=(0.1,))
    t.start()
    page_ = Client(viewer)
    t.join(20)
    page_.socket.close()
    assert viewer.simulation.time == pytest.approx(0.1)


@pytest.mark.parametrize("given, status", [({"word": "guess"}, 404), ({"host": "evil.example"}, 404),
                                           ({"origin": "http://evil.example"}, 403)])
def test_others_are_refused(viewer, given, status):
    assert Client(viewer, **given).status == status


def test_a_page_that_reads_nothing_is_dropped(viewer):
    page_ = Client(viewer)
    while not viewer._pages:
        time.sleep(0.01)
    began = time.monotonic()
    while viewer._pages and time.monotonic() - began < 30:
        viewer._send(bytes(200_000), 2)
    assert not viewer._pages and time.monotonic() - began < 20
    page_.socket.close()


def test_what_is_no_message(viewer):
    """Bytes that are no WebSocket message end that page's connection alone."""
    bad = Client(viewer)
    bad.socket.sendall(os.urandom(4000))
    bad.socket.close()
    page_ = Client(viewer)
    page_.say([1, 2])
    while not viewer._commands:
        time.sleep(0.01)
    viewer.sync()
    assert viewer.is_running()
