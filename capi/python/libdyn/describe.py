"""Joints, frames, shapes, pairs and the load report of a model."""

from __future__ import annotations

from ctypes import byref, c_char_p, c_int, c_void_p
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from . import abi
from .arrays import Placement, address, to_placement
from .choices import kind, size, string
from .enums import FrameType, JointType, PairReason, ReportLevel, ShapeRole, ShapeType
from .handles import ModelHandle
from .library import check, lib
from .material import Material
from .mesh import Mesh
from .messages import in_python

if TYPE_CHECKING:
    from .arrays import Numbers


class ReportEntry(NamedTuple):
    """Something of the file that was not used, was replaced, or is worth knowing."""

    level: ReportLevel
    message: str
    line: int
    """1-based; 0 when no line applies."""


class JointInfo(NamedTuple):
    id: int
    name: str
    type: JointType
    parent: int
    """Parent joint; 0 is the universe."""
    idx_q: int
    idx_v: int
    nq: int
    nv: int
    mimic_leader: int
    """Joint that it follows, or -1."""
    mimic_ratio: float
    mimic_offset: float
    axis: Numbers
    axis2: Numbers
    pitch: float
    """Helical: metres per radian."""
    placement: Placement
    """Joint frame in the parent joint's frame, at the neutral configuration."""


class FrameInfo(NamedTuple):
    id: int
    name: str
    type: FrameType
    joint: int
    """Joint that carries it."""
    placement: Placement
    """In that joint's frame."""
    mass: float
    """kg: of the link or frame itself; merged links keep their own."""
    com: Numbers
    """(3,), m, in the frame."""
    inertia: Numbers
    """(3, 3), kg m^2, about the centre of mass, axes of the frame."""


class Pair(NamedTuple):
    """Two collision shapes, and whether new data tests them."""

    shape_a: int
    shape_b: int
    reason: PairReason


class ShapeInfo(NamedTuple):
    id: int
    name: str
    type: ShapeType
    role: ShapeRole
    frame: int
    """BODY frame that carries it."""
    placement: Placement
    """In that frame."""
    size: Numbers
    """(3,), m; what they are for each type: the table of shapes in the page of lists."""
    mesh: str
    """Resolved path; "" for others."""
    radius: float
    """m, of rounding: points within that distance belong to the shape."""
    contype: int
    """Groups it is in, a bit each."""
    conaffinity: int
    """Groups it collides with."""
    material: Material
    """Material of its contacts."""
    rgba: tuple[float, float, float, float] | None
    """Red, green, blue, opacity, 0 to 1; None where its file does not say."""


class DisabledPair(NamedTuple):
    """Two links that an SRDF takes out of collision tests."""

    frame1: int
    frame2: int
    reason: str


class Description(ModelHandle):
    """The part of Model that says what it is made of."""

    def joint_name(self, joint: int) -> str:
        return string(lib.dyn_model_joint_name(self._m, self._index(joint, self.njoints, "joint")))

    def frame_name(self, frame: int) -> str:
        return string(lib.dyn_model_frame_name(self._m, self._index(frame, self.nframes, "frame")))

    def joint(self, joint: int | str) -> JointInfo:
        """Description of a joint, by id or name."""
        id = self._joint(joint)
        info = abi.JointInfo()
        check(lib.dyn_model_joint_info(self._m, id, byref(info)))
        return JointInfo(
            id, string(info.name), kind(JointType, info.type), info.parent, info.idx_q, info.idx_v, info.nq, info.nv,
            info.mimic_leader, info.mimic_ratio, info.mimic_offset, np.array(info.axis), np.array(info.axis2), info.pitch,
            to_placement(np.array(info.placement)),
        )  # fmt: skip

    def frame(self, frame: int | str) -> FrameInfo:
        """Description of a frame, by id or name."""
        id = self._frame(frame)
        info = abi.FrameInfo()
        check(lib.dyn_model_frame_info(self._m, id, byref(info)))
        return FrameInfo(
            id, string(info.name), kind(FrameType, info.type), info.joint, to_placement(np.array(info.placement)), info.mass,
            np.array(info.com), np.array(info.inertia).reshape(3, 3, order="F"),
        )  # fmt: skip

    def shape(self, shape: int) -> ShapeInfo:
        """Description of a shape of the file."""
        id = self._index(shape, self.nshapes, "shape")
        info = abi.ShapeInfo()
        check(lib.dyn_model_shape_info(self._m, id, byref(info)))
        rgba = np.empty(4)
        check(lib.dyn_model_shape_rgba(self._m, id, address(rgba)))
        return ShapeInfo(
            id, string(info.name), kind(ShapeType, info.type), kind(ShapeRole, info.role), info.frame,
            to_placement(np.array(info.placement)), np.array(info.size), string(info.mesh), info.radius, info.contype,
            info.conaffinity, Material.of(info.material), tuple(rgba.tolist()) if rgba[3] >= 0 else None,
        )  # fmt: skip

    def shape_mesh(self, shape: int) -> Mesh:
        """Returns the mesh of a shape of type CONVEX, TRIANGLES or HEIGHT_FIELD, in the shape's frame."""
        out = c_void_p()
        check(lib.dyn_model_shape_mesh(self._m, self._index(shape, self.nshapes, "shape"), byref(out)))
        return Mesh(out.value)

    @cached_property
    def disabled_pairs(self) -> tuple[DisabledPair, ...]:
        """Pairs of links that an SRDF takes out of collision tests."""
        out = []
        for i in range(size(lib.dyn_model_ndisabled_pairs(self._m))):
            frame1, frame2, reason = c_int(), c_int(), c_char_p()
            check(lib.dyn_model_disabled_pair(self._m, i, byref(frame1), byref(frame2), byref(reason)))
            out.append(DisabledPair(frame1.value, frame2.value, string(reason.value)))
        return tuple(out)

    @cached_property
    def joints(self) -> tuple[JointInfo, ...]:
        """All joints; joints[0] is the universe."""
        return tuple(self.joint(i) for i in range(self.njoints))

    @cached_property
    def frames(self) -> tuple[FrameInfo, ...]:
        """All frames; frames[0] is the universe."""
        return tuple(self.frame(i) for i in range(self.nframes))

    @cached_property
    def pairs(self) -> tuple[Pair, ...]:
        """Pairs of collision shapes, by number: all but those of one body and of a body and its parent."""
        out, a, b, reason = [], c_int(), c_int(), c_int()
        for pair in range(self.npairs):
            check(lib.dyn_model_pair(self._m, pair, byref(a), byref(b), byref(reason)))
            out.append(Pair(a.value, b.value, PairReason(reason.value)))
        return tuple(out)

    @cached_property
    def shapes(self) -> tuple[ShapeInfo, ...]:
        return tuple(self.shape(i) for i in range(self.nshapes))

    @cached_property
    def report(self) -> tuple[ReportEntry, ...]:
        """The load report: everything in the file that was not used, was replaced, or is worth knowing."""
        entries = []
        for i in range(size(lib.dyn_model_report_count(self._m))):
            entry = abi.ReportEntry()
            check(lib.dyn_model_report_entry(self._m, i, byref(entry)))
            entries.append(ReportEntry(kind(ReportLevel, entry.level), in_python(string(entry.message)), entry.line))
        return tuple(entries)


def coordinate_names(model: Description, of_q: bool) -> list[str]:
    """Names of the numbers of q (or v): the joint's, with a number behind it where it has several."""
    out = [""] * (model.nq if of_q else model.nv)
    for j in model.joints[1:]:
        first, n = (j.idx_q, j.nq) if of_q else (j.idx_v, j.nv)
        for k in range(n):
            out[first + k] = f"{j.name}[{k}]" if n > 1 else j.name
    return out
