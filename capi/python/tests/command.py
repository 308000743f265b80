"""The command `dyn` for tests. DYN_CLI names it; otherwise a build tree or PATH does."""

import json
import os
import shutil
import subprocess

import pytest
from conftest import ARM, CAPI, MODELS

ROBOTS = MODELS / "robots"
GO2 = str(ROBOTS / "go2.urdf")


def find():
    if os.environ.get("DYN_CLI"):
        return os.environ["DYN_CLI"]
    built = [p for pattern in ("build*/bin/dyn", "build*/*/bin/dyn") for p in CAPI.parent.glob(pattern)
             if "wheel_" not in p.parent.parent.name]  # of another processor
    return str(max(built, key=lambda p: p.stat().st_mtime)) if built else shutil.which("dyn")


CLI = find()
pytestmark = pytest.mark.skipif(not CLI, reason="the command dyn is not built")


def run(*words, status=0, **kwargs):
    done = subprocess.run([CLI, *map(str, words)], capture_output=True, text=True, timeout=120, **kwargs)
    assert done.returncode == status, done.stderr or done.stdout
    if status:
        assert done.stdout == "" and done.stderr.startswith("dyn: ") and done.stderr.count("dyn: ") == 1
    return done.stderr if status else done.stdout


def answer(*words):
    def refuse(text):
        raise AssertionError(f"{text} is not JSON")

    return json.loads(run(*words, "--json"), parse_constant=refuse)


@pytest.fixture
def arm_file(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(ARM)
    return path


@pytest.fixture
def state_file(tmp_path):
    def write(content):
        path = tmp_path / "state.json"
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return path

    return write
