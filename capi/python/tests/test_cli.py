"""The command `dyn`: help, bad usage, bad robots, streams, the locale, `dyn bench`."""

import os
import subprocess

import pytest
from command import CLI, GO2, answer, arm_file, pytestmark, run  # noqa: F401 (fixtures)

import libdyn as dyn


def test_help_and_version():
    assert dyn.__version__ in run("--version")
    for words in ([], ["info"], ["eval"], ["ik"], ["sim"], ["bench"]):
        assert "Usage" in run(*words, "--help")
    assert all(name in run("--help") for name in ("info", "eval", "ik", "sim", "bench"))
    assert "Joint 0 and frame 0 are the universe" in run("info", "--help")


@pytest.mark.parametrize(
    "words",
    [
        [], ["fly"], ["info"], ["info", "--nonsense", GO2], ["info", GO2, "--fixed", "--floating"], ["eval", GO2, "--fixed"],
        ["eval", GO2, "--fixed", "--compute", "tau,nonsense"], ["eval", GO2, "--fixed", "--compute", ","],
        ["eval", GO2, "--fixed", "--compute", "frame_velocity"], ["eval", GO2, "--fixed", "--compute", "J", "--reference",
                                                                  "body"],
        ["eval", GO2, "--fixed", "--compute", "g", "--q", "1", "x"], ["eval", GO2, "--fixed", "--compute", "g", "--q", "nan"],
        ["eval", GO2, "--fixed", "--compute", "g", "--q", "1", "--state", "s.json"],
        ["sim", GO2, "--fixed"], ["sim", GO2, "--fixed", "--duration", "0"], ["sim", GO2, "--fixed", "--duration", "-1"],
        ["sim", GO2, "--fixed", "--duration", "nan"], ["sim", GO2, "--fixed", "--duration", "inf"],
        ["sim", GO2, "--fixed", "--duration", "1", "--dt", "0"], ["sim", GO2, "--fixed", "--duration", "1", "--dt", "-0.1"],
        ["sim", GO2, "--fixed", "--duration", "1", "--dt", "inf"], ["sim", GO2, "--fixed", "--duration", "1", "--dt", "abc"],
        ["sim", GO2, "--fixed", "--duration", "1e9", "--dt", "1e-9"],
        ["sim", GO2, "--fixed", "--duration", "1", "--integrator", "euler"],
        ["sim", GO2, "--fixed", "--duration", "1", "--csv", GO2], ["bench", GO2, "--fixed", "--seconds", "0"],
    ],
)  # fmt: skip
def test_bad_usage(words):
    run(*words, status=2)


def test_unknown_quantity_says_where_the_known_are():
    error = run("eval", GO2, "--fixed", "--compute", "Mass", status=2)
    assert '"Mass"' in error and "dyn eval --help" in error
    known = run("eval", "--help")
    assert "Minv" in known and "frame_classical_acceleration" in known


def test_bad_robots(tmp_path):
    assert "nowhere.urdf" in run("info", tmp_path / "nowhere.urdf", status=1)
    (tmp_path / "bad.urdf").write_text("<robot")
    assert "bad.urdf" in run("info", tmp_path / "bad.urdf", status=1)
    error = run("info", GO2, status=1)
    assert "--fixed or --floating" in error


def test_pipes(arm_file):
    if os.path.exists("/dev/full"):
        with open("/dev/full", "w") as full:
            done = subprocess.run([CLI, "info", arm_file, "--fixed"], stdout=full, stderr=subprocess.PIPE, text=True)
        assert done.returncode == 1 and "cannot be written" in done.stderr
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run([CLI, "info", arm_file, "--fixed", "--json"], stdout=write, stderr=subprocess.PIPE, text=True)
    os.close(write)
    assert done.returncode == 1 and "Broken pipe" in done.stderr


def test_locale_does_not_matter(arm_file):
    env = {**os.environ, "LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8"}
    words = ("eval", arm_file, "--fixed", "--compute", "g", "--q", "0.5,0.25", "--json")
    assert run(*words, env=env) == run(*words)


def test_bench(arm_file):
    rows = answer("bench", arm_file, "--fixed", "--seconds", "0.2")["algorithms"]
    names = [r["name"] for r in rows]
    steps = {f"step_{i.name.lower()}" for i in dyn.Integrator}
    assert len(set(names)) == len(names) and set(dyn.ALGORITHMS) - {"step"} | steps | {"forward_kinematics", "all_terms"} <= set(names)
    for row in rows:
        assert set(row) == {"name", "after", "ns_p50", "ns_p99", "percent_of_1ms", "ratio_to_rnea", "instructions"}
        assert 0 < row["ns_p50"] <= row["ns_p99"] and row["percent_of_1ms"] == row["ns_p50"] / 1e4
        assert row["instructions"] is None or row["instructions"] > 0
    assert "rnea" in run("bench", arm_file, "--fixed", "--seconds", "0.1")
