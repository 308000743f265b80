"""What the library says, as Python says it: its own names and choices, None, no shell."""

import numpy as np
import pytest
from conftest import ARM, INERTIAL

import libdyn as dyn
from libdyn.interface import INTERFACE
from libdyn.messages import in_python

C_WORDS = r"DYN_|dyn_|\bNULL\b|--\w|struct_size"


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ("load with base = DYN_BASE_FIXED or DYN_BASE_FLOATING; on the command line --fixed or --floating",
         'load with base="fixed" or base="floating"'),
        ("for a robot that floats say base = DYN_BASE_FLOATING (--floating)", 'for a robot that floats say base="floating"'),
        ("call dyn_crba first", "call Data.crba first"),
        ("com was not computed: call dyn_com first", "com was not computed: call Data.compute_com first"),
        ("dyn_builder_add_joint: spec is NULL", "Builder.add_joint: spec is None"),
        ("ask dyn_model_joint_info or dyn_geometry_distance", "ask Model.joint or dyn.geometry_distance"),
        ("needs part DYN_PART_MASS: name it in dyn_data_new", "needs part dyn.Part.MASS: name it in Model.data"),
        ("use DYN_PART_... values", "use members of dyn.Part"),
        ("solver 7 is none of DYN_CONTACT_SOLVER_TYPE_PGS, _ADMM, _NEWTON", 'solver 7 is none of "pgs", "admm", "newton"'),
        ("pairs of reason DYN_PAIR_REASON_MESH", "pairs of reason dyn.PairReason.MESH"),
        ("make one with a dynMesh", "make one with a dyn.Mesh"),
        ("joint 'dynamo_1' of NULLARBOR", "joint 'dynamo_1' of NULLARBOR"),
    ],
)
def test_words(said, expected):
    assert in_python(said) == expected


def test_every_member_has_its_word():
    for enum in INTERFACE["enums"]:
        for value in enum["values"]:
            assert "DYN_" not in in_python(value["identifier"])


CALLS = [
    (lambda m: dyn.load_string(ARM.replace('<link name="base"/>', f'<link name="base">{INERTIAL}</link>')), 'base="fixed"'),
    (lambda m: m.data().cholesky(), r"call Data\.crba first"),
    (lambda m: m.data().com, r"call Data\.compute_com first"),
    (lambda m: m.data("kinematics").crba(m.neutral()), r"dyn\.Part\.MASS.*Model\.data"),
    (lambda m: m.data().frame_velocity("tool"), r"Data\.forward_kinematics"),
    (lambda m: m.data(1 << 30), r"members of dyn\.Part"),
    (lambda m: m.data().set_step_options(dt=-1.0), r"^Data\.set_step_options"),
    (lambda m: m.data(memory=np.zeros(10, np.uint8)), r"Model\.data_size"),
    (lambda m: dyn.Builder("x").add_joint("j", "revolute", "nowhere").finish(), "nowhere"),
    (lambda m: m.data().set_effects(1 << 30), r"members of dyn\.Effect"),
]


@pytest.mark.parametrize(("call", "expected"), CALLS)
def test_errors_speak_python(arm, call, expected):
    with pytest.raises(dyn.Error, match=expected) as error:
        call(arm)
    with pytest.raises(AssertionError):
        error.match(C_WORDS)


def test_help_speaks_python():
    for name in ("rnea", "compute_com", "frame_jacobian", "minv"):
        text = getattr(dyn.Data, name).__doc__
        assert text and "dyn_" not in text and "NULL" not in text, text
    assert "Data.crba" in dyn.Data.M.__doc__
    assert dyn.JointType.SPHERICAL.__doc__ and dyn.JointType.__doc__
