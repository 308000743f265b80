"""Rollouts on a local Ray cluster of several worker processes: bit for bit those of threads, also when workers are killed."""

import os
import secrets
import signal
import subprocess
import sys

import numpy as np
import pytest
from conftest import MODELS

import libdyn as dyn
from libdyn.batch import rollout

ray = pytest.importorskip("ray", reason="package ray is not installed")


@pytest.fixture(scope="module")
def cluster():
    os.environ.setdefault("RAY_worker_niceness", "0")  # 15 as it comes: they would wait long where others work
    os.environ.setdefault("RAY_AUTH_TOKEN", secrets.token_hex(32))  # or Ray writes one to the home folder
    packages = os.path.dirname(os.path.dirname(dyn.__file__))
    ray.init(num_cpus=4, include_dashboard=False, log_to_driver=False, runtime_env={"env_vars": {"PYTHONPATH": packages}})
    yield
    ray.shutdown()


@pytest.fixture(scope="module")
def scene():
    bare = dyn.load(MODELS / "robots" / "go2.urdf", base="floating")
    return dyn.Builder.from_model(bare).add_shape("universe", "half_space", name="floor").finish()


def falls(m, n):
    q0 = np.tile(m.neutral(), (n, 1))
    q0[:, 2] = np.linspace(0.35, 0.5, n)
    return {"q0": q0, "tau": np.concatenate([np.zeros((20, 6)), np.random.default_rng(1).normal(size=(20, m.nv - 6))], 1),
            "every": 50}


def same(a, b):
    assert np.array_equal(a.q, b.q) and np.array_equal(a.v, b.v) and np.array_equal(a.status, b.status)
    assert a.sensors.keys() == b.sensors.keys() and all(np.array_equal(a.sensors[k], b.sensors[k]) for k in a.sensors)
    assert np.array_equal(a.contact_count, b.contact_count) and np.array_equal(a.contacts, b.contacts)


def test_equal_to_threads(cluster, scene):
    more = {"sensors": {"com": "com"}, "contacts": 8, "effects": ("armature", "limits")}
    task = falls(scene, 20)
    here = rollout(scene, **task, **more)
    for chunk in (3, None):
        same(here, rollout(scene, **task, **more, chunk=chunk, engine="ray"))


def ours(pid):
    """Whether a process is a descendant of this one."""
    while pid > 1:
        if pid == os.getpid():
            return True
        with open(f"/proc/{pid}/stat") as file:
            pid = int(file.read().rsplit(")", 1)[1].split()[1])
    return False


def working():
    """Workers of this test's cluster that are in the middle of a task."""
    found = []
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/cmdline", "rb") as file:
                title = file.read()
            if title.startswith(b"ray::simulate") and ours(int(name)):
                found.append(int(name))
        except OSError:  # it has ended
            continue
    return found


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="looks for workers in /proc")
def test_killed_workers_lose_nothing(cluster, scene):
    """Four workers, more than processors here or not, of which two are killed one after another; those that take their place,
    too, give the same bits."""
    task, killed, seen = falls(scene, 48), [], set()

    def kill(made, of):
        busy = working()
        seen.update(busy)
        if len(killed) < 2 and made < of and busy:
            os.kill(busy[0], signal.SIGKILL)
            killed.append(busy[0])

    there = rollout(scene, **task, contacts=8, chunk=1, engine="ray", progress=kill)
    assert len(killed) == 2 and not any(os.path.exists(f"/proc/{pid}") for pid in killed)
    assert len(seen) >= 4
    same(rollout(scene, **task, contacts=8), there)


def test_failures_and_refusals(cluster, scene):
    task = falls(scene, 6)
    tau = np.tile(task.pop("tau"), (6, 1, 1))
    tau[4, 3, 7] = np.nan
    with pytest.raises(dyn.NonFiniteError, match="simulation 4: "):
        rollout(scene, **task, tau=tau, chunk=2, engine="ray")
    status = rollout(scene, **task, tau=tau, chunk=2, strict=False, engine="ray").status
    assert status.tolist() == [0, 0, 0, 0, dyn.Status.ERROR_NONFINITE, 0]
    with pytest.raises(dyn.ArgumentError, match="keep_states is not for engine='ray'"):
        rollout(scene, steps=1, keep_states=True, engine="ray")
    with pytest.raises(dyn.SizeError, match="q0 has shape"):
        rollout(scene, np.zeros((3, 5)), steps=1, engine="ray")
    with pytest.raises(dyn.CancelledError, match="cancelled after"):
        rollout(scene, **task, tau=np.nan_to_num(tau), chunk=1, engine="ray", progress=lambda made, of: False)


def test_an_address_where_no_cluster_is():
    program = "import libdyn as dyn; dyn.batch.rollout(dyn.load(%r, base='fixed'), steps=1, engine='ray')" % str(MODELS / "robots" / "double_pendulum.urdf")
    for address in ("127.0.0.1:1", "127.0.0.1:99999"):
        done = subprocess.run([sys.executable, "-c", program], env={**os.environ, "RAY_ADDRESS": address}, capture_output=True,
                              text=True, timeout=300)
        assert done.returncode and f"ArgumentError: RAY_ADDRESS is '{address}', where no cluster answers: " in done.stderr
