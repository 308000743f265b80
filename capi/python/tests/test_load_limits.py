"""Limits of a load: what a file may ask for, in Python and in the command."""

import subprocess

import libdyn as dyn
import pytest
from command import CLI

BALL = '<geom type="sphere" size="0.1"/>'


def mjcf(world: str, rest: str = "") -> str:
    return f"<mujoco><worldbody>{world}</worldbody>{rest}</mujoco>"


NESTED = mjcf('<replicate count="10">' * 9 + f"<body><freejoint/>{BALL}</body>" + "</replicate>" * 9)
PAIR = mjcf(f'<body name="a"><freejoint/>{BALL}</body><body name="b"><freejoint/>{BALL}</body>',
            '<equality><weld body1="a" body2="b"/></equality><keyframe><key/><key/></keyframe>')


@pytest.mark.parametrize(("limit", "value", "words"), [
    ("max_bodies", 1, "more than 1 bodies"),
    ("max_shapes", 1, "more than 1 shapes"),
    ("max_constraint_rows", 5, "more than 5 rows of constraints"),
    ("max_keys", 1, "more than 1 named configurations"),
    ("max_bytes", 1000, "more than 1000 bytes of memory"),
    ("max_seconds", 1e-9, "more than 1e-09 s of processor time"),
])
def test_each_limit_refuses_by_its_name(limit, value, words):
    with pytest.raises(dyn.LimitError, match=f"{words}.*{limit}"):
        dyn.load_string(PAIR, **{limit: value})
    assert dyn.load_string(PAIR, **{limit: 0}).nv == 12


def test_limits_are_checked():
    with pytest.raises(dyn.ArgumentError, match="max_keys is no limit"):
        dyn.load_string(PAIR, max_keys=-1)
    with pytest.raises(dyn.ArgumentError, match="max_bytes"):
        dyn.load_string(PAIR, max_bytes=2**63)
    assert dyn.load_string(PAIR, max_bytes=2**40).nv == 12


def test_nested_replicas_are_refused_at_once():
    with pytest.raises(dyn.LimitError, match="copies.*max_bodies"):
        dyn.load_string(NESTED)


def test_the_command_takes_limits(tmp_path):
    file = tmp_path / "pair.xml"
    file.write_text(PAIR)
    done = subprocess.run([CLI, "info", file, "--max-shapes", "1"], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1 and "more than 1 shapes" in done.stderr
    assert subprocess.run([CLI, "info", file, "--max-shapes", "2"], capture_output=True, timeout=60, check=False).returncode == 0


def test_info_of_a_long_chain_takes_memory_of_what_it_prints(tmp_path):
    """A chain of 4000 links: its derivatives alone would take gigabytes."""
    links = "".join(
        f'<link name="l{i}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        f'<joint name="j{i}" type="continuous"><parent link="l{i - 1}"/><child link="l{i}"/><axis xyz="0 1 0"/></joint>'
        for i in range(1, 4001))
    file = tmp_path / "chain.urdf"
    file.write_text(f'<robot name="r"><link name="l0"/>{links}</robot>')
    limited = f'ulimit -v 2000000 && exec "{CLI}" info --fixed "{file}"'
    done = subprocess.run(["bash", "-c", limited], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0 and "nv 4000" in done.stdout, done.stderr
