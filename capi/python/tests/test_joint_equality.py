"""A joint equality of one joint: it holds the joint where its polynomial says."""

import libdyn as dyn
import pytest

HELD = """<mujoco><compiler angle="radian"/><worldbody>
  <body name="a"><joint name="i" axis="0 1 0" ref="0.1"/><geom type="capsule" size="0.02" fromto="0 0 0 0.3 0 0"/>
    <body name="b" pos="0.3 0 0"><joint name="j" axis="0 1 0"/><geom type="capsule" size="0.02" fromto="0 0 0 0.2 0 0"/></body>
  </body></worldbody><equality><joint name="hold" joint1="i" polycoef="0.3 2 0 0 0"/></equality></mujoco>"""


def held_at(model):
    data = model.data()
    data.set_step_options(dt=1e-3)
    for _ in range(2000):
        data.step()
    assert abs(data.v[0]) < 1e-9
    return data.q[0]


def test_it_is_held_at_its_reference_plus_the_constant():
    assert held_at(dyn.load_string(HELD)) == pytest.approx(0.4, abs=1e-6)


@pytest.mark.parametrize("to", ["mjcf", "urdf", "dynb"])
def test_files_keep_it(to, tmp_path):
    path = tmp_path / f"held.{'xml' if to == 'mjcf' else to}"
    dyn.load_string(HELD).save(path)
    assert held_at(dyn.load(path)) == pytest.approx(0.4, abs=1e-6)


def test_copies_keep_it_and_drop_it_with_its_joint():
    model = dyn.load_string(HELD)
    assert dyn.Builder.from_model(model).lock("j", [0.4, 0]).finish().constraint_names == ["hold"]
    assert dyn.Builder.from_model(model).lock("i", [0.4, 0]).finish().constraint_names == []
    assert held_at(dyn.Builder("two").attach(model).finish()) == pytest.approx(0.4, abs=1e-6)
