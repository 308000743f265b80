"""Forces over time of `dyn sim`."""

import numpy as np
import pytest
from command import answer, arm_file, pytestmark, run  # noqa: F401 (fixtures)


def test_sim_with_forces_over_time(arm_file, arm, tmp_path):
    forces, again, random, d = tmp_path / "forces.csv", tmp_path / "again.csv", np.random.default_rng(0), arm.data()
    rows = [(1e-3 * k, *random.normal(size=2).tolist()) for k in range(0, 50, 2)]  # each acts for two steps
    forces.write_text("\ufefftau1,t,mechanical,tau0\n" + "".join(f"{b!r},{t!r},,{a!r}\n" for t, a, b in rows), "utf-8")
    d.set_effects("armature")
    d.set_state([1, 0.5], [0, 0])
    for k in range(50):
        d.set_state(None, None, None, rows[k // 2][1:])
        d.step(1e-3, "rk4")
    setting = ("sim", arm_file, "--fixed", "--duration", "0.05", "--dt", "1e-3", "--integrator", "rk4", "--q", "1,0.5",
               "--effects", "armature")
    found = answer(*setting, "--tau-csv", forces, "--csv", again)
    assert found["q"] == d.q.tolist() and found["v"] == d.v.tolist() and 0 < found["error_estimate"] < 1e-6
    assert answer(*setting, "--tau-csv", again)["q"] == d.q.tolist()
    late = tmp_path / "late.csv"
    late.write_text("t,tau0,tau1\n0.03,1,1\n")
    found = answer(*setting, "--tau-csv", late)
    assert found["q"] != answer(*setting)["q"] and any("first row of --tau-csv is at t = 0.03 s" in w for w in found["warnings"])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "there are no rows"),
        ("t,tau0,tau1\n", "there are no rows"),
        ("t,tau0\n0,1\n", "there is no column tau1"),
        ("0,1,2\n1,1,2\n", "there is no column t:"),
        ("t,tau0,tau1\n0,1,2\n1,1\n", ":3: there are 2 columns, and the first line names 3"),
        ("t,tau0,tau1\n0,1,x\n", ':2: "x" is not a finite number'),
        ("t,tau0,tau1\n0,1,nan\n", "is not a finite number"),
        ("t,tau0,tau1\n0,1,\n", "is not a finite number"),
        ("t,tau0,tau1\n0,1,2\n0,1,2\n", "t must grow from row to row"),
        ("t,tau0,tau1,tau2\n0,1,2,3\n", 'unknown column "tau2"'),
        ("t,tau0,tau1,foo\n0,1,2,3\n", 'unknown column "foo"'),
        ("t,tau0,tau1,q2\n0,1,2,3\n", 'unknown column "q2"'),
        ("t,tau0,tau1,tau1\n0,1,2,3\n", "there are two columns tau1"),
    ],
)
def test_bad_forces_over_time(arm_file, tmp_path, text, said):
    forces = tmp_path / "forces.csv"
    forces.write_text(text)
    assert said in run("sim", arm_file, "--fixed", "--duration", "0.01", "--tau-csv", forces, status=1)


def test_forces_over_time_are_there_once(arm_file, tmp_path):
    assert "cannot be read" in run("sim", arm_file, "--fixed", "--duration", "0.01", "--tau-csv", tmp_path / "none.csv", status=1)
    assert "exclude each other: keep one" in run("sim", arm_file, "--fixed", "--duration", "0.01", "--tau", "1,1", "--tau-csv",
                                                 tmp_path / "none.csv", status=2)
