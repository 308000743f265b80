"""Doors in an environment made from PyPI, with the wheel and its extras: all their tests, and the blocks of their page. With
DYN_SLOW (tools/test --slow): it downloads 500 MB."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

if not os.environ.get("DYN_SLOW"):
    pytest.skip("downloads 500 MB: tools/test --slow", allow_module_level=True)

TESTS = Path(__file__).resolve().parent


def test_all_doors(wheel, tmp_path):
    """All but PyTorch's, whose packages for x86-64 take 3 GB: there is none for the processor alone on PyPI."""
    python = tmp_path / "venv/bin/python"
    subprocess.run([sys.executable, "-m", "venv", tmp_path / "venv"], check=True)
    extras = f"{wheel[0]}[casadi,crocoddyl,jax,scipy]"
    subprocess.run([python, "-m", "pip", "install", "-q", "--only-binary", ":all:", extras, "pytest"], check=True)
    environment = {k: v for k, v in os.environ.items() if k not in ("DYN_LIBRARY", "DYN_SLOW", "PYTHONPATH")}
    files = [*sorted(TESTS.glob("test_doors*.py")), "test_documents.py"]
    command = [python, "-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", *files, "-k", "doors"]
    done = subprocess.run(command, cwd=TESTS, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    skipped = re.findall(r"^SKIPPED .*: (.*)$", done.stdout, re.M)
    assert all("torch" in reason or "--slow" in reason for reason in skipped), skipped
    assert int(re.search(r"(\d+) passed", done.stdout)[1]) > 90
