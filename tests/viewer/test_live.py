"""dyn view --live: a running simulation in a browser, and whom it refuses."""

import base64
import os
import re
import resource
import socket
import subprocess
import time
from pathlib import Path

import pytest
from conftest import MODELS, dyn

ROBOT = (MODELS / "robots/go2.urdf", "--floating", "--ground")


class Live:
    def __init__(self, *arguments, **process):
        self.process = subprocess.Popen([dyn.command, "view", *map(str, arguments), "--live", "--no-browser"],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **process)
        self.address = self.process.stdout.readline().strip()
        self.port, self.word = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/([0-9a-f]{32})/", self.address).groups()

    def request(self, path, **headers):
        """The status of a request, and of the beginning of a WebSocket where headers ask for it."""
        lines = [f"GET {path} HTTP/1.1"] + [f"{name.replace('_', '-')}: {value}" for name, value in headers.items()]
        with socket.create_connection(("127.0.0.1", int(self.port)), timeout=10) as s:
            s.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
            return int(s.recv(4096).split()[1])

    def websocket(self, origin, word=None, host=None):
        headers = {"Host": host or f"127.0.0.1:{self.port}", "Upgrade": "websocket", "Connection": "Upgrade",
                   "Sec_WebSocket_Version": 13, "Sec_WebSocket_Key": base64.b64encode(os.urandom(16)).decode()}
        if origin:
            headers["Origin"] = origin
        return self.request(f"/{word or self.word}/ws", **headers)

    def stop(self):
        self.process.terminate()
        return self.process.wait(10)


@pytest.fixture
def live():
    live = Live(*ROBOT)
    yield live
    if live.process.poll() is None:
        live.stop()


def test_refuses_strangers(live):
    here = f"127.0.0.1:{live.port}"
    assert live.request(f"/{live.word}/", Host=here) == 200
    assert live.websocket(f"http://{here}") == 101
    assert live.websocket("http://evil.example") == 403
    assert live.websocket("null") == 403
    assert live.websocket(None) == 403
    assert live.websocket(f"http://{here}", word="0" * 32) == 404
    assert live.websocket(f"http://{here}", host=f"evil.example:{live.port}") == 404  # a name that was made to point here
    assert live.request("/", Host=here) == 404
    assert live.request(f"/{live.word}/", Host=here, Origin="http://evil.example") == 403


def test_listens_on_the_loopback_interface_alone(live):
    addresses = [line.split()[1] for line in open("/proc/net/tcp").readlines()[1:] if line.split()[3] == "0A"]
    assert [a.split(":")[0] for a in addresses if int(a.split(":")[1], 16) == int(live.port)] == ["0100007F"]


def test_ends_when_asked(live):
    assert live.stop() == 0


def test_waits_when_it_is_out_of_descriptors():
    few = 24
    live = Live(*ROBOT, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (few, few)))

    def seconds():
        used = Path(f"/proc/{live.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(used[11]) + int(used[12])) / os.sysconf("SC_CLK_TCK")

    try:
        open_ones = [socket.create_connection(("127.0.0.1", int(live.port)), timeout=10) for _ in range(2 * few)]
        before = seconds()
        time.sleep(1)
        assert seconds() - before < 0.3  # of the processor: one that spins takes all of it
        for s in open_ones:
            s.close()
        assert live.request(f"/{live.word}/", Host=f"127.0.0.1:{live.port}") == 200
    finally:
        live.stop()


def test_a_taken_port_is_said(live):
    second = dyn("view", *ROBOT, "--live", "--no-browser", "--port", live.port)
    assert second.returncode == 1
    assert f"port {live.port}" in second.stderr and "taken" in second.stderr


@pytest.mark.parametrize("port", [-1, 65536, "http"])
def test_a_port_that_is_none_is_said(port):
    refused = dyn("view", *ROBOT, "--live", "--no-browser", "--port", port)
    assert refused.returncode == 2 and "--port" in refused.stderr and (port == "http" or "65535" in refused.stderr)


def test_no_browser_is_said():
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")}
    process = subprocess.Popen([dyn.command, "view", *map(str, ROBOT), "--live"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               text=True, env=environment)
    address = process.stdout.readline().strip()
    said = process.stderr.readline()
    process.terminate()
    process.wait(10)
    assert "no screen" in said and address in said


def test_runs_pauses_and_resets(page, live):
    page.open(live.address)
    page.page.wait_for_function("dynView.live.state?.time > 0.2")
    page.page.click("#pause")
    page.page.wait_for_function("dynView.live.state.paused")
    stopped = page("dynView.live.state.time")
    page.page.wait_for_timeout(200)
    assert page("dynView.live.state.time") == stopped
    page.page.click("#reset")
    page.page.wait_for_function("dynView.live.state.time == 0")
    page.page.click("#pause")
    page.page.wait_for_function("dynView.live.state.time > 0.1")
    assert page.complaints == []


def test_push_by_mouse_moves_the_robot(page, live):
    page.open(live.address)
    page.page.wait_for_function("dynView.live.state?.time > 1.5")  # it lies and rests
    place = "dynView.robot.joints[1].position.toArray()"
    before = page(place)
    page.page.wait_for_timeout(300)
    assert page(place) == pytest.approx(before, abs=1e-3)
    x, y = page(
        """(() => { const v = dynView, p = v.robot.joints[1].position.clone().project(v.scene.camera), b = v.scene.canvas.getBoundingClientRect();
        return [b.left + (p.x + 1) / 2 * b.width, b.top + (1 - p.y) / 2 * b.height]; })()"""
    )
    page.page.keyboard.down("Shift")
    page.page.mouse.move(x, y)
    page.page.mouse.down()
    page.page.mouse.move(x + 120, y - 150, steps=4)
    page.page.wait_for_function(f"Math.hypot(...{place}.map((p, i) => p - {before}[i])) > 0.1", timeout=20000)
    page.page.mouse.up()
    page.page.keyboard.up("Shift")
    assert page("document.getElementById('message').textContent") == ""


def test_effects_are_switched(page, live):
    page.open(live.address)
    page.page.wait_for_function("dynView.live.state?.time > 0.1")
    page.page.uncheck("#effect-contact")
    page.page.wait_for_function("dynView.robot.joints[1].position.z < -1", timeout=20000)  # through the ground
    page.page.uncheck("#effect-gravity")
    page("window.since = dynView.live.history.length && dynView.live.state.time + 0.2")  # the switch has arrived by then
    page.page.wait_for_function("dynView.live.state.time > since + 0.5")
    falls = page("(() => { const h = dynView.live.history.filter((s) => s.time > since), k = h.length >> 1, v = (a, b) => "
                 "(b.com[2] - a.com[2]) / (b.time - a.time); return [v(h[0], h[k]), v(h[k], h.at(-1))]; })()")
    assert falls[0] < -1 and falls[1] == pytest.approx(falls[0], rel=1e-3)  # nothing pulls any more
    assert page("dynView.live.state.contacts.length") == 0


def test_bad_commands_are_answered(page, live):
    page.open(live.address)
    page.page.wait_for_function("dynView.live.state")
    for command in ("{do: 'push', frame: 9999, point: [0, 0, 0], force: [1, 0, 0]}",
                    "{do: 'push', frame: 1, point: [0], force: []}", "{do: 'dance'}", "{}", "{do: 'speed', factor: 'x'}",
                    "{do: 'effects', without: 'nonsense'}", "[1]"):
        page("document.getElementById('message').textContent = ''")
        page(f"dynView.live.socket.send(JSON.stringify({command}))")
        page.page.wait_for_function("document.getElementById('message').textContent !== ''")
    assert live.process.poll() is None
