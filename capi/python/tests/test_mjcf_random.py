"""Random MJCF files beside MuJoCo: sizes, initial and key configurations, M, bias, springs and pairs."""

import random
import sys
from pathlib import Path

import libdyn as dyn
import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="package mujoco is not installed")
sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "bench"))
from beside_mujoco import Beside, forces  # noqa: E402


class Files:
    """A model of several files, drawn at random."""

    def __init__(self, folder, seed):
        self.folder, self.r, self.bodies, self.count = folder, random.Random(seed), [], 0
        self.degrees = self.r.random() < 0.5
        self.classes = ["one", "two", "three"]
        self.joints = []

    def numbers(self, n, low=-1.0, high=1.0):
        return " ".join(f"{self.r.uniform(low, high):.6g}" for _ in range(n))

    def angle(self, low, high):
        return f"{self.r.uniform(low, high) * (57.29577951308232 if self.degrees else 1):.6g}"

    def element(self, tag, content="", /, **attributes):
        """With its attributes in random order."""
        items = [(k, v) for k, v in attributes.items() if v is not None]
        self.r.shuffle(items)
        return f"<{tag} " + " ".join(f'{k.rstrip("_")}="{v}"' for k, v in items) + (f">{content}</{tag}>" if content else "/>")

    def name(self, kind):
        self.count += 1
        return f"{kind}{self.count}"

    def pose(self):
        turn = {
            "quat": lambda: self.numbers(4, 0.1, 1),
            "euler": lambda: " ".join(self.angle(-2, 2) for _ in range(3)),
            "axisangle": lambda: self.numbers(3, 0.1, 1) + " " + self.angle(-2, 2),
            "xyaxes": lambda: "1 0.1 0 -0.1 1 " + self.numbers(1),
            "zaxis": lambda: self.numbers(3, 0.1, 1),
        }
        out = {"pos": self.numbers(3)} if self.r.random() < 0.8 else {}
        if self.r.random() < 0.7:
            kind = self.r.choice(list(turn))
            out[kind] = turn[kind]()
        return out

    def class_of(self):
        return self.r.choice([None, None, *self.classes])

    def geom(self, sized=True):
        kind = self.r.choice(["sphere", "capsule", "box", "cylinder", "ellipsoid"])
        size = {"sphere": 1, "capsule": 2, "box": 3, "cylinder": 2, "ellipsoid": 3}[kind]
        mass = self.r.choice([{}, {"mass": self.numbers(1, 0.1, 2)}, {"density": self.numbers(1, 100, 2000)}])
        masks = (
            {} if self.r.random() < 0.6 else {"contype": self.r.choice([0, 1, 2, 3]), "conaffinity": self.r.choice([0, 1, 2, 3])}
        )
        pose = self.pose()
        if kind != "sphere" and kind != "ellipsoid" and kind != "box" and self.r.random() < 0.4:
            pose, size = {"fromto": self.numbers(6)}, 1
        return self.element(
            "geom",
            name=self.name("g"),
            type=kind,
            size=self.numbers(size, 0.05, 0.3),
            class_=self.class_of(),
            **mass,
            **masks,
            **pose,
        )

    def joints_of_a_body(self):
        """At most six degrees of freedom, and a ball last, as MuJoCo wants."""
        count = self.r.choice([0, 1, 1, 1, 2, 3])
        return [self.joint(self.r.choice(["hinge", "hinge", "slide"] + ["ball"] * (k == count - 1))) for k in range(count)]

    def joint(self, kind):
        name = self.name("j")
        out = {"name": name, "type": kind, "class_": self.class_of()}
        if kind != "ball":
            self.joints.append(name)
            out["axis"] = self.numbers(3, 0.1, 1)
            if self.r.random() < 0.4:
                out["ref"] = self.angle(-1, 1) if kind == "hinge" else self.numbers(1)
            if self.r.random() < 0.4:
                low, high = (self.angle(-2, -1), self.angle(1, 2)) if kind == "hinge" else ("-1", "2")
                out["range"], out["limited"] = f"{low} {high}", "true"
            if self.r.random() < 0.3:
                out["springref"] = self.angle(-1, 1) if kind == "hinge" else self.numbers(1)
        for what in ("damping", "stiffness", "armature"):
            if self.r.random() < 0.3:
                out[what] = self.numbers(1, 0.1, 2)
        if self.r.random() < 0.5:
            out["pos"] = self.numbers(3)
        return self.element("joint", **out)

    def body(self, depth, root):
        name = self.name("b")
        self.bodies.append(name)
        inside = []
        if root and self.r.random() < 0.3:
            inside.append(self.r.choice(["<freejoint/>", '<joint type="free" armature="0" stiffness="0"/>']))
        else:
            inside += self.joints_of_a_body()
        inside += [self.geom() for _ in range(self.r.choice([1, 1, 2]))]
        if self.r.random() < 0.3:
            inside.append(
                f'<inertial pos="{self.numbers(3, -0.1, 0.1)}" mass="{self.numbers(1, 0.5, 2)}" '
                + self.r.choice(
                    [
                        f'diaginertia="{self.numbers(3, 0.1, 0.15)}" quat="{self.numbers(4, 0.1, 1)}"',
                        f'fullinertia="0.1 0.12 0.14 {self.numbers(3, -0.01, 0.01)}"',
                    ]
                )
                + "/>"
            )
        if self.r.random() < 0.3:
            inside.append(f'<site name="{self.name("s")}" pos="{self.numbers(3)}"/>')
        if depth:
            inside += [self.content(depth - 1, False) for _ in range(self.r.choice([0, 1, 1, 2]))]
        first, rest = inside[0], inside[1:]
        self.r.shuffle(rest)
        inside = [first, *rest] if "free" in first else self.shuffled(inside)
        return self.element("body", "".join(inside), name=name, childclass=self.class_of(), **self.pose())

    def shuffled(self, items):
        """Joints keep their order, which is that of the coordinates."""
        joints = iter([i for i in items if i.startswith("<joint")])
        mixed = list(items)
        self.r.shuffle(mixed)
        return [next(joints) if i.startswith("<joint") else i for i in mixed]

    def content(self, depth, root):
        body = self.body(depth, root)
        if "free" in body.split("<geom")[0]:
            return body
        for _ in range(self.r.choice([0, 0, 1, 2])):
            body = self.element("frame", body + (self.geom() if not root else ""), childclass=self.class_of(), **self.pose())
        return body

    def defaults(self):
        def of():
            return self.element(
                "geom", density=self.numbers(1, 500, 1500), contype=self.r.choice([0, 1, 2]), condim=self.r.choice([1, 3, 4])
            ) + self.element(
                "joint",
                damping=self.numbers(1, 0, 1),
                armature=self.numbers(1, 0, 0.1),
                stiffness=self.r.choice([None, self.numbers(1, 0, 3)]),
            )

        three = f'<default class="three">{of()}</default>'
        return f'<default>{of()}<default class="one">{of()}<default class="two">{of()}{three}</default></default></default>'

    def write(self):
        compiler = {
            "angle": "degree" if self.degrees else "radian",
            "eulerseq": self.r.choice(["xyz", "XYZ", "zyx", "zXy", "YZY"]),
            "inertiafromgeom": self.r.choice(["auto", "true", None]),
            "autolimits": self.r.choice(["true", "false", None]),
            "boundmass": self.r.choice([None, "0.3"]),
            "settotalmass": self.r.choice([None, None, "17"]),
        }
        trees = [self.content(self.r.choice([1, 2, 3]), True) for _ in range(self.r.choice([1, 2, 3]))]
        copy = self.element(
            "replicate",
            '<body><joint type="slide" axis="0 0 1" name="r"/><geom name="rg" size=".05"/></body>',
            count=self.r.choice([1, 2, 11]),
            offset=self.numbers(3),
            euler=f"0 0 {self.angle(0, 1)}",
            sep="-",
        )
        (self.folder / "parts" / "deep").mkdir(parents=True, exist_ok=True)
        (self.folder / "parts" / "defaults.xml").write_text(f"<mujocoinclude>{self.defaults()}</mujocoinclude>")
        (self.folder / "parts" / "deep" / "tree.xml").write_text(f"<mujocoinclude>{trees[0]}</mujocoinclude>")
        mocap = (
            '<body name="target" mocap="true" pos="0 0 3"><geom size=".01" contype="0" conaffinity="0"/></body>'
            if self.r.random() < 0.5
            else ""
        )
        excluded = (
            self.element("exclude", body1=self.r.choice(self.bodies), body2=self.r.choice(self.bodies))
            if self.r.random() < 0.5
            else ""
        )
        motors = "".join(
            self.element(
                "position",
                joint=j,
                kp=self.numbers(1, 1, 9),
                kv=self.numbers(1, 0, 1),
                gear=self.numbers(1, 0.5, 2),
                ctrlrange="-1 1",
                ctrllimited="true",
            )
            for j in self.joints[:2]
        )
        sections = [
            self.element("compiler", **compiler),
            f'<option gravity="{self.numbers(3, -10, 10)}" timestep="0.003"/>',
            '<include file="parts/defaults.xml"/>',
            f'<worldbody>{mocap}<geom type="plane" size="1 1 1" pos="0 0 -9"/><include file="parts/deep/tree.xml"/>'
            f"{''.join(trees[1:])}{copy}</worldbody>",
            f"<contact>{excluded}</contact>",
            f"<actuator>{motors}</actuator>",
        ]
        path = self.folder / "model.xml"
        path.write_text("<mujoco>" + "".join(sections) + "</mujoco>")
        mm = mujoco.MjModel.from_xml_path(str(path))
        random_numbers = np.random.default_rng(self.r.randrange(1000))
        qpos = mm.qpos0 + random_numbers.uniform(-1, 1, mm.nq)
        key = self.element(
            "key",
            name="k",
            time="1.5",
            qpos=" ".join(map(repr, qpos.tolist())),
            qvel=self.numbers(mm.nv),
            ctrl=self.numbers(mm.nu) if mm.nu else None,
            mpos="1 2 3" if mocap else None,
        )
        sections.append(f"<keyframe>{key}</keyframe>")
        self.r.shuffle(sections)
        path.write_text("<mujoco>" + "".join(sections) + "</mujoco>")
        return path


def pairs_of_mujoco(mm):
    """Pairs of geoms that the filters leave, by the documented rules: masks, one body, parent and child, excluded bodies."""
    out = set()
    for a in range(mm.ngeom):
        for b in range(a):
            if not (mm.geom_contype[a] & mm.geom_conaffinity[b] or mm.geom_contype[b] & mm.geom_conaffinity[a]):
                continue
            i, j = mm.body_weldid[mm.geom_bodyid[[a, b]]]
            up, vp = mm.body_weldid[mm.body_parentid[[i, j]]]
            if i == j or (i and j and (up == j or vp == i)):
                continue
            bodies = sorted(mm.geom_bodyid[[a, b]])
            if (bodies[0] << 16) + bodies[1] in mm.exclude_signature:
                continue
            out.add(frozenset((mm.geom(a).name, mm.geom(b).name)))
    return out


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.filterwarnings("ignore::libdyn.LoadWarning")
def test_random_files_are_compiled_as_by_mujoco(tmp_path, seed):
    path = Files(tmp_path, seed).write()
    mm, m = mujoco.MjModel.from_xml_path(str(path)), dyn.load(path)
    assert (m.nq, m.nv, m.nu, m.step_options.dt) == (mm.nq, mm.nv, mm.nu, mm.opt.timestep)
    beside, data = Beside(mm, m), m.data()
    np.testing.assert_allclose(data.q, beside.q(mm.qpos0), rtol=0, atol=1e-14)
    for part, off in forces(beside, states=2).items():
        assert off < 1e-10, part
    data.reset("k")
    md = mujoco.MjData(mm)
    mujoco.mj_resetDataKeyframe(mm, md, 0)
    turned = beside.q(md.qpos)
    for k in beside.quaternions:  # MuJoCo keeps the length of the file
        turned[k : k + 4] /= np.linalg.norm(turned[k : k + 4])
    np.testing.assert_allclose(m.normalize(data.q), turned, rtol=0, atol=1e-14)
    np.testing.assert_allclose(data.v, beside.velocity_map(md.qpos) @ md.qvel, rtol=0, atol=1e-14)
    assert data.field("time") == md.time == 1.5 and np.array_equal(data.field("ctrl"), md.ctrl)
    tested = {
        frozenset((m.shapes[p.shape_a].name, m.shapes[p.shape_b].name)) for p in m.pairs if p.reason is dyn.PairReason.TESTED
    }
    assert tested == pairs_of_mujoco(mm)
