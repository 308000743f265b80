"""What a robot is: dyn.load, Model, and the descriptions of its joints, frames and shapes."""

from __future__ import annotations

import operator
import os
import secrets
import threading
import weakref
from collections.abc import Iterable, Mapping, Sequence
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_void_p, create_string_buffer
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from . import abi
from .arrays import Owner, Placement, address, checked, numbers, result, slot, to_placement, view
from .actuator import ModelActuators
from .constraint import ModelConstraints
from .enums import Base, Direction, Format, FrameType, JointType, MeshUse, ModelArray, PairReason, Part, ReportLevel, ShapeRole, ShapeType
from .errors import ArgumentError, SizeError, UnknownNameError
from .library import check, fail, last_error, lib
from .material import Material
from .mesh import Mesh

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .batch import Batch
    from .convert import State, StateLayout
    from .data import Data


class ReportEntry(NamedTuple):
    """Something of the file that was not used, was replaced, or is worth knowing."""

    level: ReportLevel
    message: str
    line: int
    """1-based; 0 when no line applies."""


class SaveLine(NamedTuple):
    """Something that a format has no place for (WARNING), or says in another way (INFO)."""

    level: ReportLevel
    message: str


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
    axis: np.ndarray
    axis2: np.ndarray
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
    com: np.ndarray
    """(3,), m, in the frame."""
    inertia: np.ndarray
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
    size: np.ndarray
    """(3,), m: box: full lengths; sphere: radius; cylinder, capsule, cone: radius, length; ellipsoid: semi-axes; mesh: scale."""
    mesh: str
    """Resolved path; "" for others."""
    radius: float
    """m, of rounding: points within that distance belong to the shape."""
    contype: int
    """Groups it is in, a bit each."""
    conaffinity: int
    """Groups it collides with."""
    material: Material
    """What happens where it touches."""


class DisabledPair(NamedTuple):
    """Two links that an SRDF takes out of collision tests."""

    frame1: int
    frame2: int
    reason: str


E = TypeVar("E")


def member(enum: type[E], value: Any, what: str) -> E:
    """A member of an enumeration from itself, its name in either case, or its number."""
    if isinstance(value, str):
        found = enum.__members__.get(value.upper())  # type: ignore[attr-defined]
        if found is not None:
            return found
    else:
        try:
            return enum(operator.index(value))  # type: ignore[call-arg]
        except (TypeError, ValueError):
            pass
    known = ", ".join(enum.__members__)  # type: ignore[attr-defined]
    raise ArgumentError(f"{what} is {value!r}, but must be one of {known}.")


def _kind(enum: Any, value: int) -> Any:
    """A member; the bare number when a newer library knows more of them."""
    return enum(value) if value in enum._value2member_map_ else value


def mask(flag: type[E], value: Any, what: str) -> int:
    """A bit mask from a member, a number, a name, or several of them."""
    if isinstance(value, str):
        return int(member(flag, value, what))  # type: ignore[call-overload]
    if isinstance(value, Iterable) and not isinstance(value, int):
        bits = 0
        for one in value:
            bits |= mask(flag, one, what)
        return bits
    try:
        bits = operator.index(value)
    except TypeError:
        raise ArgumentError(f"{what} is {value!r}, but must be a mask of {flag.__name__}.") from None
    if not 0 <= bits < 1 << 32:
        raise ArgumentError(f"{what} is {bits}, but must be a mask of {flag.__name__}, 0 to 2^32 - 1.")
    return bits


def text(s: str, what: str) -> bytes:
    if not isinstance(s, str):
        raise ArgumentError(f"{what} is {s!r}, but must be a string.")
    if "\0" in s:
        raise ArgumentError(f"{what} holds a zero character: {s!r}.")
    return s.encode("utf-8", "surrogateescape")


def _string(s: bytes | None) -> str:
    return "" if s is None else s.decode("utf-8", "surrogateescape")


def _options(base: Any, strict: bool, cos_sin: bool, package_dirs: Any, gravity: Any, srdf: Any, meshes: Any, slots: Any, contacts: Any, confined: bool):
    options = abi.LoadOptions()
    lib.dyn_load_options_init(byref(options))
    if base is not None:
        options.base = member(Base, base, "base")
    options.strict, options.cos_sin = bool(strict), bool(cos_sin)
    if isinstance(package_dirs, (str, bytes, os.PathLike)):
        package_dirs = [package_dirs]
    folders = [os.fsencode(p) for p in package_dirs]
    if folders:
        options.package_dirs = (c_char_p * len(folders))(*folders)
        options.package_dirs_count = len(folders)
    if gravity is not None:
        options.gravity[:] = checked(gravity, (3,), "gravity").tolist()
    if srdf is not None:
        options.srdf = os.fsencode(srdf)
    options.meshes = member(MeshUse, meshes, "meshes")
    options.constraint_slots, options.contact_capacity, options.confined = slots, contacts, bool(confined)
    return options


def load(
    path: str | os.PathLike,
    base: str | Base | None = None,
    *,
    strict: bool = False,
    cos_sin: bool = False,
    package_dirs: str | os.PathLike | Sequence[str | os.PathLike] = (),
    gravity: ArrayLike | None = None,
    srdf: str | os.PathLike | None = None,
    meshes: str | MeshUse = MeshUse.NONE,
    constraint_slots: int = 8,
    contact_capacity: int = 0,
    confined: bool = False,
) -> Model:
    """Reads a robot from a URDF file, or a model from an MJCF file.

    base          "fixed": the root link is welded to the world; "floating": a free flyer carries it. A root link with
                  mass needs one of them.
    strict        physics that would be dropped is an error
    cos_sin       continuous joints store (cos, sin)
    package_dirs  where package://NAME/... is looked up
    gravity       (3,), m/s^2, world axes; default (0, 0, -9.81), of an MJCF model the file's
    meshes        what stands for collision meshes: "none", their names alone; "hull", their convex hulls (report says which are not
                  convex); "triangles". Other than "none", a mesh that cannot be read is an error
    constraint_slots  spare slots for constraints that a data of the model has
    contact_capacity  contact points that a step has room for, the deepest; 0: what the shapes need
    confined      for files that are not trusted: included files and meshes outside of the file's folder and package_dirs are errors
    srdf          an SRDF file for this robot: its states become named configurations, its pairs Model.disabled_pairs
    """
    name = os.fsencode(path)
    if b"\0" in name:
        raise ArgumentError(f"path holds a zero character: {path!r}.")
    out = c_void_p()
    options = _options(base, strict, cos_sin, package_dirs, gravity, srdf, meshes, constraint_slots, contact_capacity, confined)
    check(lib.dyn_model_load(name, byref(options), byref(out)))
    return Model(out.value)


def load_string(
    urdf: str,
    base: str | Base | None = None,
    *,
    strict: bool = False,
    cos_sin: bool = False,
    package_dirs: str | os.PathLike | Sequence[str | os.PathLike] = (),
    gravity: ArrayLike | None = None,
    srdf: str | os.PathLike | None = None,
    meshes: str | MeshUse = MeshUse.NONE,
    constraint_slots: int = 8,
    contact_capacity: int = 0,
    confined: bool = False,
) -> Model:
    """Reads a robot from the text of a URDF or MJCF; otherwise as dyn.load."""
    out = c_void_p()
    options = _options(base, strict, cos_sin, package_dirs, gravity, srdf, meshes, constraint_slots, contact_capacity, confined)
    check(lib.dyn_model_load_string(text(urdf, "urdf"), byref(options), byref(out)))
    return Model(out.value)


def from_buffer(buffer) -> Model:
    """The model that lies in a buffer (numpy.memmap of a .dynb, shared memory, ...), used where it is: nothing is copied. The buffer lies on a boundary
    of 64 bytes and must not change; the model keeps it alive."""
    memory, out = np.frombuffer(buffer, np.uint8), c_void_p()
    check(lib.dyn_model_from_buffer(memory.ctypes.data, memory.size, byref(out)))
    return Model(out.value, memory)


_integrate, _difference, _interpolate = lib.dyn_integrate, lib.dyn_difference, lib.dyn_interpolate


def _size(n: int) -> int:
    if n < 0:
        fail(2)
    return n


def _teller(lines: list[SaveLine]):
    return abi.SAVE_REPORT(lambda _, level, message: lines.append(SaveLine(_kind(ReportLevel, level), message.decode("utf-8", "replace"))))


class _Scratch(threading.local):
    """Inputs and outputs of the configuration functions: a model is shared by threads, so each has its own."""

    def __init__(self, model: weakref.ref, nq: int, nv: int):
        self.q, self.q0, self.q1 = (slot((nq,), name, model) for name in ("q", "q0", "q1"))
        self.lower, self.upper = slot((nq,), "lower", model), slot((nq,), "upper", model)
        self.v = slot((nv,), "v", model)
        self.nq, self.nv = result((nq,)), result((nv,))


class Model(ModelConstraints, ModelActuators):
    """What the robot is: immutable, and safe to share between threads. From dyn.load, dyn.load_string or dyn.Builder.

    q has nq numbers, v, a and tau have nv; they differ on manifolds: use integrate and difference, never q + v.
    Wherever q, v, a or tau is expected, a dict {joint name: numbers} is accepted, too: joints that it does not name
    are neutral or zero.
    """

    def __init__(self, handle: int, buffer: Any = None):
        self._owner = Owner(handle, lib.dyn_model_free, buffer)
        self._m = handle
        self.nq: int = _size(lib.dyn_nq(handle))
        """Size of q."""
        self.nv: int = _size(lib.dyn_nv(handle))
        """Size of v, a and tau."""
        self.njoints: int = _size(lib.dyn_njoints(handle))
        """Joints that move, and the universe (joint 0)."""
        self.nframes: int = _size(lib.dyn_nframes(handle))
        """Frames; frame 0 is the universe."""
        self.nbodies: int = _size(lib.dyn_nbodies(handle))
        """Links, the universe not counted."""
        self.nshapes: int = _size(lib.dyn_nshapes(handle))
        self.npairs: int = _size(lib.dyn_npairs(handle))
        self.name: str = _string(lib.dyn_model_name(handle))
        self._frame_ids: dict[str, int] = {}
        self._scratch = _Scratch(weakref.ref(self), self.nq, self.nv)

    def __repr__(self) -> str:
        return f"<dyn.Model {self.name!r}: nq {self.nq}, nv {self.nv}, {self.njoints} joints, {self.nframes} frames>"

    def save(self, path: str | os.PathLike, strict: bool = False) -> list[SaveLine]:
        """Writes the model as URDF (.urdf), MJCF (.xml, .mjcf) or compiled (.dynb): see dyn_model_save. What the format has no place for is in the
        list as WARNING, and an error with strict; what it says in another way as INFO."""
        name = os.fsencode(path)
        if b"\0" in name:
            raise ArgumentError(f"path holds a zero character: {path!r}.")
        lines: list[SaveLine] = []
        check(lib.dyn_model_save(self._m, name, bool(strict), _teller(lines), None))
        return lines

    def to_bytes(self, format: str | Format, strict: bool = False) -> bytes:
        """What save writes."""
        kind, size, none = member(Format, format, "format"), c_size_t(), _teller([])
        check(lib.dyn_model_save_memory(self._m, kind, bool(strict), none, None, None, 0, byref(size)))
        out = create_string_buffer(size.value)
        check(lib.dyn_model_save_memory(self._m, kind, bool(strict), none, None, out, len(out), byref(size)))
        return out.raw

    def image(self, narrow: bool = False, names: bool = True) -> bytes:
        """What dyn.from_buffer and dyn_model_from_buffer take: the bytes of a .dynb. narrow: for machines without SIMD; names: False leaves them out, with
        the load report."""
        size, flags = c_size_t(), (1 if narrow else 0) | (0 if names else 2)
        check(lib.dyn_model_image(self._m, flags, None, 0, byref(size)))
        out = create_string_buffer(size.value)
        check(lib.dyn_model_image(self._m, flags, out, len(out), byref(size)))
        return out.raw

    @property
    def size(self) -> int:
        """Bytes of the compiled model."""
        return lib.dyn_model_size(self._m)

    @property
    def total_mass(self) -> float:
        """kg."""
        return lib.dyn_total_mass(self._m)

    # ------------------------------------------------------------------------------------------- names and infos

    def joint_id(self, name: str) -> int:
        """Id of a joint; a name that does not exist is an error that lists near misses."""
        found = lib.dyn_joint_id(self._m, text(name, "joint"))
        if found < 0:
            raise UnknownNameError(last_error())
        return found

    def joint_name(self, joint: int) -> str:
        return _string(lib.dyn_joint_name(self._m, self._index(joint, self.njoints, "joint")))

    def frame_id(self, name: str, type: str | FrameType | None = None) -> int:
        """Id of a frame. A link and a joint may share a name: joints and user frames come first, or give the type."""
        if type is None:
            found = lib.dyn_frame_id(self._m, text(name, "frame"))
        else:
            found = lib.dyn_frame_id_of_type(self._m, text(name, "frame"), member(FrameType, type, "type"))
        if found < 0:
            raise UnknownNameError(last_error())
        return found

    def frame_name(self, frame: int) -> str:
        return _string(lib.dyn_frame_name(self._m, self._index(frame, self.nframes, "frame")))

    def joint(self, joint: int | str) -> JointInfo:
        """Description of a joint, by id or name."""
        id = self._joint(joint)
        info = abi.JointInfo()
        check(lib.dyn_joint_info(self._m, id, byref(info)))
        return JointInfo(
            id, _string(info.name), _kind(JointType, info.type), info.parent, info.idx_q, info.idx_v, info.nq, info.nv,
            info.mimic_leader, info.mimic_ratio, info.mimic_offset, np.array(info.axis), np.array(info.axis2), info.pitch,
            to_placement(np.array(info.placement)),
        )  # fmt: skip

    def frame(self, frame: int | str) -> FrameInfo:
        """Description of a frame, by id or name."""
        id = self._frame(frame)
        info = abi.FrameInfo()
        check(lib.dyn_frame_info(self._m, id, byref(info)))
        return FrameInfo(
            id, _string(info.name), _kind(FrameType, info.type), info.joint, to_placement(np.array(info.placement)), info.mass,
            np.array(info.com), np.array(info.inertia).reshape(3, 3, order="F"),
        )  # fmt: skip

    def shape(self, shape: int) -> ShapeInfo:
        """Description of a shape of the file."""
        id = self._index(shape, self.nshapes, "shape")
        info = abi.ShapeInfo()
        check(lib.dyn_shape_info(self._m, id, byref(info)))
        return ShapeInfo(
            id, _string(info.name), _kind(ShapeType, info.type), _kind(ShapeRole, info.role), info.frame,
            to_placement(np.array(info.placement)), np.array(info.size), _string(info.mesh), info.radius, info.contype,
            info.conaffinity, Material.of(info.material),
        )  # fmt: skip

    def shape_mesh(self, shape: int) -> Mesh:
        """What a shape of type CONVEX, TRIANGLES or HEIGHT_FIELD is made of, in the shape's frame."""
        out = c_void_p()
        check(lib.dyn_shape_mesh(self._m, self._index(shape, self.nshapes, "shape"), byref(out)))
        return Mesh(out.value)

    @cached_property
    def disabled_pairs(self) -> tuple[DisabledPair, ...]:
        """Pairs of links that an SRDF takes out of collision tests."""
        out = []
        for i in range(_size(lib.dyn_ndisabled_pairs(self._m))):
            frame1, frame2, reason = c_int(), c_int(), c_char_p()
            check(lib.dyn_disabled_pair(self._m, i, byref(frame1), byref(frame2), byref(reason)))
            out.append(DisabledPair(frame1.value, frame2.value, _string(reason.value)))
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
            check(lib.dyn_pair(self._m, pair, byref(a), byref(b), byref(reason)))
            out.append(Pair(a.value, b.value, PairReason(reason.value)))
        return tuple(out)

    @cached_property
    def shapes(self) -> tuple[ShapeInfo, ...]:
        return tuple(self.shape(i) for i in range(self.nshapes))

    @cached_property
    def report(self) -> tuple[ReportEntry, ...]:
        """The load report: everything in the file that was not used, was replaced, or is worth knowing."""
        entries = []
        for i in range(_size(lib.dyn_report_count(self._m))):
            entry = abi.ReportEntry()
            check(lib.dyn_report_entry(self._m, i, byref(entry)))
            entries.append(ReportEntry(_kind(ReportLevel, entry.level), _string(entry.message), entry.line))
        return tuple(entries)

    def _index(self, value: Any, count: int, what: str) -> int:
        try:
            index = operator.index(value)
        except TypeError:
            raise ArgumentError(f"{what} is {value!r}, but must be an id (0 to {count - 1}).") from None
        if not 0 <= index < count:
            raise ArgumentError(f"{what} is {index}, but ids go from 0 to {count - 1}.")
        return index

    def _joint(self, joint: int | str) -> int:
        return self.joint_id(joint) if isinstance(joint, str) else self._index(joint, self.njoints, "joint")

    def _frame(self, frame: int | str) -> int:
        if isinstance(frame, str):
            id = self._frame_ids.get(frame)
            if id is None:
                id = self._frame_ids[frame] = self.frame_id(frame)
            return id
        return self._index(frame, self.nframes, "frame")

    # ------------------------------------------------------------------------------------------- numbers of the model

    def array(self, which: str | ModelArray) -> np.ndarray:
        """Read-only view of the model's numbers: limits, armature, damping, friction, springs, gravity."""
        which = member(ModelArray, which, "which")
        start = lib.dyn_model_array(self._m, which)
        of_q = (ModelArray.LOWER_LIMIT, ModelArray.UPPER_LIMIT, ModelArray.SPRING_REFERENCE)
        n = 3 if which == ModelArray.GRAVITY else self.nq if which in of_q else self.nv
        if start is None and n:
            fail(2)
        return view(start, n, None, (1, 0), self._owner)

    @cached_property
    def lower_limit(self) -> np.ndarray:
        """(nq,), rad or m; -inf where there is none."""
        return self.array(ModelArray.LOWER_LIMIT)

    @cached_property
    def upper_limit(self) -> np.ndarray:
        """(nq,), rad or m; inf where there is none."""
        return self.array(ModelArray.UPPER_LIMIT)

    @cached_property
    def velocity_limit(self) -> np.ndarray:
        """(nv,), rad/s or m/s; inf where there is none."""
        return self.array(ModelArray.VELOCITY_LIMIT)

    @cached_property
    def effort_limit(self) -> np.ndarray:
        """(nv,), N m or N; inf where there is none."""
        return self.array(ModelArray.EFFORT_LIMIT)

    @cached_property
    def armature(self) -> np.ndarray:
        """(nv,), kg m^2 or kg: added to the diagonal of M."""
        return self.array(ModelArray.ARMATURE)

    @cached_property
    def damping(self) -> np.ndarray:
        """(nv,), N m s/rad or N s/m."""
        return self.array(ModelArray.DAMPING)

    @cached_property
    def friction(self) -> np.ndarray:
        """(nv,), N m or N: dry friction."""
        return self.array(ModelArray.FRICTION)

    @cached_property
    def stiffness(self) -> np.ndarray:
        """(nv,), N m/rad or N/m: springs."""
        return self.array(ModelArray.STIFFNESS)

    @cached_property
    def spring_reference(self) -> np.ndarray:
        """(nq,), rad or m: the configuration where springs are at rest."""
        return self.array(ModelArray.SPRING_REFERENCE)

    @cached_property
    def gravity(self) -> np.ndarray:
        """(3,), m/s^2, world axes."""
        return self.array(ModelArray.GRAVITY)

    @property
    def configuration_names(self) -> tuple[str, ...]:
        """Names of the stored configurations; the first is "neutral"."""
        count = _size(lib.dyn_nconfigurations(self._m))
        return tuple(_string(lib.dyn_configuration_name(self._m, i)) for i in range(count))

    def configuration(self, name: str) -> np.ndarray:
        """A named configuration: q, (nq,)."""
        q = np.empty(self.nq)
        check(lib.dyn_configuration(self._m, text(name, "name"), address(q)))
        return q

    @property
    def configurations(self) -> dict[str, np.ndarray]:
        """Every named configuration: {name: q}."""
        return {name: self.configuration(name) for name in self.configuration_names}

    def q_permutation(self, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
        """(idx_q, idx_v): the first index in q and in v of each named joint, in the order of names."""
        if isinstance(names, str):
            raise ArgumentError("names is a string, but must be a sequence of joint names.")
        encoded = [text(n, "name") for n in names]
        idx_q, idx_v = np.empty(len(encoded), np.int32), np.empty(len(encoded), np.int32)
        pointers = (c_char_p * len(encoded))(*encoded)
        check(lib.dyn_q_permutation(self._m, pointers, len(encoded), address(idx_q), address(idx_v)))
        return idx_q, idx_v

    # ------------------------------------------------------------------------------------------- states

    def _named(self, values: Mapping[str, Any], what: str) -> np.ndarray:
        """A vector from {joint name: numbers}; what is not named is neutral or zero."""
        position = what not in ("v", "a", "tau")
        out = self.neutral() if position else np.zeros(self.nv)
        for name, value in values.items():
            info = self.joint(name)
            first, n = (info.idx_q, info.nq) if position else (info.idx_v, info.nv)
            if info.mimic_leader >= 0:
                leader = self.joint_name(info.mimic_leader)
                raise ArgumentError(f"{what}: joint {name!r} follows {leader!r} and has no numbers of its own: set {leader!r}.")
            given = np.atleast_1d(numbers(value, f"{what}[{name!r}]"))
            if given.shape != (n,):
                raise SizeError(f"{what}[{name!r}] has shape {given.shape}, but must have shape ({n},).")
            out[first : first + n] = given
        return out

    def to_peer(
        self, layout: StateLayout | str, q: ArrayLike, v: ArrayLike | None = None, a: ArrayLike | None = None, tau: ArrayLike | None = None
    ) -> State:
        """A state as another library stores it: (q, v, a, tau) of the layout's sizes; a needs v.

        layout  a dyn.StateLayout, or "pinocchio", "mujoco", "drake" or "ros" for all joints in the model's order
        """
        from .convert import convert_state

        return convert_state(self, layout, Direction.TO_PEER, q, v, a, tau)

    def from_peer(
        self, layout: StateLayout | str, q: ArrayLike, v: ArrayLike | None = None, a: ArrayLike | None = None, tau: ArrayLike | None = None
    ) -> State:
        """The inverse of to_peer. A follower's force is added to its leader's; its own q, v, a are not read."""
        from .convert import convert_state

        return convert_state(self, layout, Direction.FROM_PEER, q, v, a, tau)

    def data_size(self, parts: Any = Part.ALL) -> int:
        """Bytes that a data of these parts needs."""
        size = lib.dyn_data_size(self._m, mask(Part, parts, "parts"))
        if size == 0:
            raise ArgumentError(last_error())
        return size

    def data(self, parts: Any = Part.ALL, memory: Any = None) -> Data:
        """New data at the neutral configuration and rest: one for each thread.

        parts   a dyn.Part, or several, or their names: groups of buffers; a call that needs an absent one says so
        memory  a writable buffer of at least data_size(parts) bytes to place the data in, instead of the heap
        """
        from .data import Data

        return Data(self, parts, memory)

    def batch(self, threads: int | None = None, parts: Any = Part.ALL) -> Batch:
        """Every algorithm over arrays of states, with several threads (None: as many as this process has processors)."""
        from .batch import Batch

        return Batch(self, threads, parts)

    def inertial_parameters(self) -> np.ndarray:
        """pi of all joints' bodies, (10 (njoints - 1),): ten a body, [m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz] in the joint's frame."""
        pi = np.empty(10 * (self.njoints - 1))
        check(lib.dyn_inertial_parameters(self._m, address(pi)))
        return pi

    # ------------------------------------------------------------------------------------------- configurations

    def integrate(self, q: ArrayLike, v: ArrayLike) -> np.ndarray:
        """q (+) v, (nq,): where q gets to with the constant velocity v in one second; pass v * dt."""
        s = self._scratch
        out, start = s.nq
        check(_integrate(self._m, s.q(q), s.v(v), start))
        return out.copy()

    def difference(self, q0: ArrayLike, q1: ArrayLike) -> np.ndarray:
        """q1 (-) q0, (nv,): the v with integrate(q0, v) = q1. Shortest rotation."""
        s = self._scratch
        out, start = s.nv
        check(_difference(self._m, s.q0(q0), s.q1(q1), start))
        return out.copy()

    def interpolate(self, q0: ArrayLike, q1: ArrayLike, u: float) -> np.ndarray:
        """q0 (+) u (q1 (-) q0), (nq,)."""
        s = self._scratch
        out, start = s.nq
        check(_interpolate(self._m, s.q0(q0), s.q1(q1), u, start))
        return out.copy()

    def distance(self, q0: ArrayLike, q1: ArrayLike) -> float:
        """Norm of difference(q0, q1)."""
        s, out = self._scratch, c_double()
        check(lib.dyn_distance(self._m, s.q0(q0), s.q1(q1), byref(out)))
        return out.value

    def neutral(self) -> np.ndarray:
        """The neutral configuration, (nq,)."""
        out, start = self._scratch.nq
        check(lib.dyn_neutral(self._m, start))
        return out.copy()

    def random(self, seed: int | None = None, lower: ArrayLike | None = None, upper: ArrayLike | None = None) -> np.ndarray:
        """A random configuration, (nq,), uniform between lower and upper (default: the model's limits; what is infinite
        there is drawn from [-1, 1], angles from [-pi, pi]). The same seed gives the same q; None draws a seed."""
        seed = secrets.randbits(64) if seed is None else operator.index(seed)
        if not 0 <= seed < 1 << 64:
            raise ArgumentError(f"seed is {seed}, but must be from 0 to 2^64 - 1.")
        s = self._scratch
        out, start = s.nq
        check(lib.dyn_random(self._m, seed, s.lower(lower), s.upper(upper), start))
        return out.copy()

    def normalize(self, q: ArrayLike) -> np.ndarray:
        """A copy of q, (nq,), with unit quaternions and (cos, sin) pairs."""
        q = np.array(self._named(q, "q") if isinstance(q, Mapping) else checked(q, (self.nq,), "q"))
        check(lib.dyn_normalize(self._m, address(q)))
        return q

    def is_normalized(self, q: ArrayLike, tolerance: float = 1e-9) -> bool:
        """Whether every quaternion and (cos, sin) pair has norm 1 within tolerance."""
        out = c_int()
        check(lib.dyn_is_normalized(self._m, self._scratch.q(q), tolerance, byref(out)))
        return bool(out.value)

    def integrate_jacobians(self, q: ArrayLike, v: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """(d/dq, d/dv) of integrate(q, v) on tangent spaces, (nv, nv) each."""
        s, dq, dv = self._scratch, np.empty((self.nv, self.nv), order="F"), np.empty((self.nv, self.nv), order="F")
        check(lib.dyn_integrate_jacobians(self._m, s.q(q), s.v(v), address(dq), address(dv)))
        return dq, dv

    def difference_jacobians(self, q0: ArrayLike, q1: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """(d/dq0, d/dq1) of difference(q0, q1), (nv, nv) each."""
        s, d0, d1 = self._scratch, np.empty((self.nv, self.nv), order="F"), np.empty((self.nv, self.nv), order="F")
        check(lib.dyn_difference_jacobians(self._m, s.q0(q0), s.q1(q1), address(d0), address(d1)))
        return d0, d1
