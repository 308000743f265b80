"""Functions that bench/generated_functions.py writes for CasADi have libdyn's values: what the bench times is the same work."""

import sys

import numpy as np
import pytest
from conftest import CAPI

import libdyn as dyn

BENCH = CAPI.parent / "bench"
TOLERANCE = 1e-12  # relative to a result's largest entry: rounding of some thousand operations

# two branches on a free root, oblique axes, one joint that slides
TREE = """<robot name="tree"><link name="root">{0}</link><link name="a">{0}</link><link name="b">{0}</link><link name="c">{0}</link>
<joint name="a" type="continuous"><parent link="root"/><child link="a"/><origin xyz="0.1 0.2 -0.3" rpy="0.3 -0.2 0.9"/>
  <axis xyz="0.6 0 0.8"/></joint>
<joint name="b" type="prismatic"><parent link="a"/><child link="b"/><origin xyz="0 0.1 0.2" rpy="0 1.5707963267948966 0"/>
  <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="9"/></joint>
<joint name="c" type="continuous"><parent link="root"/><child link="c"/><origin xyz="-0.2 0 0.1"/><axis xyz="1 0 0"/></joint>
</robot>""".format('<inertial><origin xyz="0.05 -0.02 0.1" rpy="0.1 0.2 0.3"/><mass value="1.3"/>'
                   '<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001" ixz="-0.002" iyz="0.003"/></inertial>')


@pytest.fixture
def generated(monkeypatch):
    pytest.importorskip("casadi", reason="package casadi is not installed")
    monkeypatch.syspath_prepend(str(BENCH))
    import generated_functions

    yield generated_functions
    for name in ("body_frames", "counting", "generated_functions", "recursions"):
        sys.modules.pop(name, None)


def results(m, q, v, a):
    """libdyn's by algorithm, of symmetric matrices the lower triangle."""
    d = m.data()
    tau, ddq, M = (np.array(x) for x in (d.rnea(q, v, a), d.aba(q, v, a), d.crba(q)))
    inverse = [np.array(x) for x in d.rnea_derivatives(q, v, a)]
    forward = [np.array(x) for x in d.aba_derivatives(q, v, a)]
    return {"rnea": [tau], "aba": [ddq], "crba": [np.tril(M)], "rnea_derivatives": [*inverse, np.tril(M), tau],
            "aba_derivatives": [*forward[:2], np.tril(forward[2]), ddq]}


@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_every_way_to_generate_a_function_has_libdyns_values(generated, base):
    m = dyn.load_string(TREE, base, gravity=(0.4, -1.2, -9.6))
    random = np.random.default_rng(3)
    q, (v, a) = m.random(7), random.uniform(-1, 1, (2, m.nv))
    import casadi

    for algorithm, expected in results(m, q, v, a).items():
        dynamics = generated.Dynamics(m)
        for outputs in dynamics.ways(algorithm):
            found = casadi.Function(algorithm, dynamics.symbols, casadi.cse(outputs)).call([q, v, a])
            assert len(found) == len(expected)
            for x, y in zip(found, expected):
                np.testing.assert_allclose(np.squeeze(np.array(casadi.densify(x))), y, rtol=0, atol=TOLERANCE * abs(y).max())


def test_the_function_with_the_fewest_operations_is_taken(generated):
    m = dyn.load_string(TREE, "fixed")
    import casadi

    dynamics = generated.Dynamics(m)
    ways = [casadi.Function("aba", dynamics.symbols, casadi.cse(y)).n_instructions() for y in dynamics.ways("aba")]
    assert generated.function(m, "aba").n_instructions() == min(ways)


def test_joints_without_a_recursion_are_refused_by_name(generated):
    with pytest.raises(ValueError, match="panda_finger_joint2"):
        generated.bodies_of(dyn.load(CAPI.parent / "models/robots/panda.urdf", "fixed"))
