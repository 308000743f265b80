"""Pairs of an MJCF file are those that it states; a URDF's filter looks at many configurations and names what it takes."""

import libdyn as dyn
import numpy as np
import pytest

TWO = """<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/>
  <body name="a" pos="0 0 {z}"><joint name="ja" type="slide" axis="0 0 1"/><geom name="ga" type="sphere" size=".1"/>
    <body name="b" pos="0 0 .15"><joint name="jb" axis="0 1 0"/><geom name="gb" type="sphere" size=".1"/>
      <body name="c" pos=".05 0 .15"><joint name="jc" axis="0 1 0"/><geom name="gc" type="sphere" size=".2"/></body></body></body></worldbody>{more}</mujoco>"""


def that_are_tested(m):
    names = {k: s.name for k, s in enumerate(m.shapes)}
    return {frozenset((names[p.shape_a], names[p.shape_b])) for p in m.pairs if p.reason == dyn.PairReason.TESTED}


def pairs(*names):
    return {frozenset(n.split("-")) for n in names}


def load(z=0.05, more=""):
    return dyn.load_string(TWO.format(z=z, more=more))


def test_pairs_that_overlap_where_the_file_draws_them_are_tested():
    # the floor overlaps ga; ga and gc overlap
    assert that_are_tested(load()) == pairs("floor-ga", "floor-gb", "floor-gc", "ga-gc")


def test_a_body_that_is_drawn_into_the_floor_is_pushed_out():
    sim = dyn.Simulation(load(z=0.08))
    sim.run(1.0)
    assert sim.q[0] + 0.08 > 0.09


def test_excluded_pairs_and_pairs_asked_for():
    more = '<contact><exclude body1="a" body2="c"/><pair geom1="ga" geom2="gb"/></contact>'
    assert that_are_tested(load(more=more)) == pairs("floor-ga", "floor-gb", "floor-gc", "ga-gb")


def test_parents_are_filtered_only_while_the_flag_says_so():
    m = load(more='<option><flag filterparent="disable"/></option>')
    assert that_are_tested(m) == pairs("floor-ga", "floor-gb", "floor-gc", "ga-gb", "gb-gc", "ga-gc")


def test_what_is_fixed_to_the_world_is_no_parent():
    m = dyn.load_string("""<mujoco><worldbody><body name="base" pos="0 0 1"><geom name="g0" size=".1"/>
      <body name="arm" pos="0 0 .3"><joint axis="0 1 0"/><geom name="g1" size=".1"/></body></body></worldbody></mujoco>""")
    assert that_are_tested(m) == pairs("g0-g1")


def test_copies_and_files_keep_the_rule():
    m = load()
    assert that_are_tested(dyn.Builder.from_model(m).finish()) == that_are_tested(dyn.Model.from_image(m.image())) == that_are_tested(m)


@pytest.mark.parametrize("z", [0.05, 0.3])
def test_against_mujoco(z):
    mujoco = pytest.importorskip("mujoco")
    mm = mujoco.MjModel.from_xml_string(TWO.format(z=z, more="").replace('type="sphere" size=".2"', 'type="sphere" size=".9"').replace('size=".1"', 'size=".8"'))
    md = mujoco.MjData(mm)
    mujoco.mj_forward(mm, md)
    touching = {frozenset(mm.geom(int(g)).name for g in c.geom) for c in md.contact}
    m = load(z=z)
    assert touching == that_are_tested(m)


# ---------------------------------------------------------------------------------------------------- URDF
LINK = '<link name="{n}"><inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial><collision><origin xyz="{x}"/><geometry><sphere radius="{r}"/></geometry></collision></link>'
ARM = (
    '<robot name="arm">' + LINK.format(n="l0", x="0 0 0", r=0.2) + LINK.format(n="l1", x="0 0 0", r=0.05) + LINK.format(n="l2", x="{tip}", r=0.12)
    + '<joint name="j1" type="revolute"><parent link="l0"/><child link="l1"/><origin xyz="0 0 .25"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
    '<joint name="j2" type="revolute"><parent link="l1"/><child link="l2"/><origin xyz="0 0 .05"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>'
)


def arm(tip, **options):
    return dyn.load_string(ARM.replace("{tip}", tip), base="fixed", **options)


def test_a_pair_that_always_overlaps_is_taken_and_named():
    m = arm("0 0 0")
    assert [p.reason for p in m.pairs] == [dyn.PairReason.OVERLAPS]
    assert any("'l0'" in e.message and "'l2'" in e.message and "not tested" in e.message for e in m.report)


def test_a_pair_that_overlaps_in_the_neutral_configuration_alone_is_tested():
    m = arm("0 0 -.3")  # it hangs within l0 at 0, and turns out of it
    assert m.data().compute_distances(np.zeros(2))[0] < 0
    assert [p.reason for p in m.pairs] == [dyn.PairReason.TESTED]
    assert not any("not tested" in e.message for e in m.report)


def test_an_srdf_decides(tmp_path):
    srdf = tmp_path / "arm.srdf"
    srdf.write_text('<robot name="arm"><disable_collisions link1="l0" link2="l1" reason="Adjacent"/></robot>')
    assert [p.reason for p in arm("0 0 0", srdf=srdf).pairs] == [dyn.PairReason.TESTED]
    srdf.write_text('<robot name="arm"><disable_collisions link1="l0" link2="l2" reason="Never"/></robot>')
    assert [p.reason for p in arm("0 0 0", srdf=srdf).pairs] == [dyn.PairReason.DISABLED]
