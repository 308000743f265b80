"""`dyn stress`: every hard case within its tolerance; those that take minutes when DYN_SLOW is set (tools/test --slow)."""

import json
import os
import subprocess

import pytest
from command import CLI

pytestmark = pytest.mark.skipif(not CLI, reason="the command dyn is not built")


def run(*words, timeout=900):
    return subprocess.run([CLI, "stress", *words], capture_output=True, text=True, timeout=timeout)


def listed():
    lines = run("--list").stdout.splitlines()[1:] if CLI else []
    return [(line.split()[0], line.rstrip().endswith("(--long)")) for line in lines]


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    page = tmp_path_factory.mktemp("stress") / "stress.html"
    done = run("--json", "--html", str(page), *(["--long"] if os.environ.get("DYN_SLOW") else []))
    assert done.returncode in (0, 1), done.stderr
    return {case["name"]: case for case in json.loads(done.stdout)["cases"]}, page.read_text(), done.returncode


@pytest.mark.parametrize("name, slow", listed())
def test_case(answers, name, slow):
    if slow and not os.environ.get("DYN_SLOW"):
        pytest.skip("takes minutes")
    case = answers[0][name]
    assert set(case) >= {"name", "metric", "reference", "result", "error", "tolerance", "passed", "wall_s"}
    assert case["passed"], f"{case['metric']}: {case['error']} is more than {case['tolerance']} {case.get('failure', '')}"
    assert case["error"] <= case["tolerance"]


def test_page_and_status(answers):
    cases, page, status = answers
    assert status == (0 if all(case["passed"] for case in cases.values()) else 1)
    assert page.startswith("<!DOCTYPE html>") and page.count("<section") == len(cases) and "http" not in page
    assert page.count("<svg") > len(cases) / 2


def test_table():
    done = run("cradle", "rotations-values")
    assert done.returncode == 0 and "2 of 2 passed" in done.stdout and done.stderr == ""
    assert (done.stdout.splitlines()[0].split()
            == ["case", "metric", "reference", "result", "error", "tolerance", "verdict", "time,", "s"])


def test_unknown_names_are_told_the_known():
    done = run("pendulam")
    assert done.returncode == 2 and done.stdout == "" and '"pendulam"' in done.stderr and "double-pendulum-10s" in done.stderr


def test_page_that_cannot_be_written():
    done = run("cradle", "--html", "/nowhere/x.html")
    assert done.returncode == 1 and "/nowhere/x.html" in done.stderr
