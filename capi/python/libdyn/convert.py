"""States in the orders and frames of other libraries: dyn.StateLayout says how a peer stores them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from ctypes import byref, c_char_p, c_int
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import abi
from .arrays import address, numbers
from .choices import member, text
from .configuration import Configurations
from .enums import Angle, Convention, Direction
from .errors import ArgumentError, SizeError
from .library import check, lib

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Numbers
    from .enums import AngleLike, ConventionLike

_inputs = abi.outputs_of(abi.StateInput)
_outputs = abi.outputs_of(abi.StateOutput)


class State(NamedTuple):
    """q, v, a and tau; None: not given."""

    q: Numbers
    v: Numbers | None = None
    a: Numbers | None = None
    tau: Numbers | None = None


def _renamed(rename: Mapping[str, str | None] | None, joints: list[tuple[str, int, int]]):
    """Our names and the indices of a peer's joints; those that are called None are left out."""
    ours = [((rename or {}).get(name, name), q, v) for name, q, v in joints]
    kept = [x for x in ours if x[0] is not None]
    return {"joints": [x[0] for x in kept], "idx_q": [x[1] for x in kept], "idx_v": [x[2] for x in kept]}


class StateLayout:
    """Layout of the same robot's state in another library.

    convention      "pinocchio", "mujoco", "drake", "ros", or "dyn"
    joints          names of our joints in the peer's order; default: the model's order, with followers of a mimic for mujoco,
                    drake and ros, and without for the others
    idx_q, idx_v    where each begins in the peer's q and v; default: one after another
    nq, nv          sizes of the peer's q and v; default: up to the end of the last joint
    continuous      how continuous joints are stored: "plain" or "cos_sin"; default: as the convention has it
    child_frame     frame of the floating base's body that pose and velocity are of; default: the joint's own

    of_mujoco, of_pinocchio and of_drake read joints and indices from the peer's model.
    """

    def __init__(
        self,
        convention: ConventionLike,
        joints: Sequence[str] | None = None,
        *,
        idx_q: ArrayLike | None = None,
        idx_v: ArrayLike | None = None,
        nq: int = 0,
        nv: int = 0,
        continuous: AngleLike = Angle.BY_CONVENTION,
        child_frame: str | None = None,
    ):
        if isinstance(joints, str):
            raise ArgumentError("joints is a string, but must be a sequence of joint names.")
        layout = abi.initialized(abi.StateLayout)
        layout.convention = member(Convention, convention, "convention")
        layout.continuous = member(Angle, continuous, "continuous")
        layout.nq, layout.nv = nq, nv
        if child_frame is not None:
            layout.child_frame = text(child_frame, "child_frame")
        if joints is not None:
            layout.joints = (c_char_p * len(joints))(*[text(name, "joint") for name in joints])
            layout.joints_count = len(joints)
        self._keep = []
        for name, given in (("idx_q", idx_q), ("idx_v", idx_v)):
            if given is None:
                continue
            a = np.array(given, np.int32)
            if joints is None or a.shape != (len(joints),):
                raise SizeError(f"{name} has shape {a.shape}, but must have one index for each of joints.")
            self._keep.append(a)
            setattr(layout, name, address(a))
        self._layout = layout
        self.convention: Convention = Convention(layout.convention)
        self.joints: tuple[str, ...] | None = None if joints is None else tuple(joints)

    def __repr__(self) -> str:
        return f"<dyn.StateLayout {self.convention.name.lower()}, joints {'of the model' if self.joints is None else list(self.joints)}>"

    @classmethod
    def of_mujoco(cls, model: Any, rename: Mapping[str, str | None] | None = None, **options: Any) -> StateLayout:
        """Layout of a mujoco.MjModel. rename: {its joint: ours}, None leaves one out; a free joint without a name is called
        ""."""
        joints = [(model.joint(j).name, int(model.jnt_qposadr[j]), int(model.jnt_dofadr[j])) for j in range(model.njnt)]
        unnamed = [j for j, (name, *_) in enumerate(joints) if not name]
        names = rename or {}
        if unnamed and ("" not in names or (len(unnamed) > 1 and names[""] is not None)):
            bodies = ", ".join(f"{j} (of body {model.body(model.jnt_bodyid[j]).name!r})" for j in unnamed)
            raise ArgumentError(f"joints of the mujoco.MjModel have no name: {bodies}. Name them in the file; one alone can be named by "
                                'rename={"": its name in the libdyn model}.')
        return cls("mujoco", **_renamed(rename, joints), nq=model.nq, nv=model.nv, **options)

    @classmethod
    def of_pinocchio(cls, model: Any, rename: Mapping[str, str | None] | None = None, **options: Any) -> StateLayout:
        """Layout of a pinocchio.Model, with mimic joints or without. rename: {its joint: ours}, None leaves one out."""
        moving = [j for j in range(1, model.njoints) if model.joints[j].nq]
        joints = [(model.names[j], model.joints[j].idx_q, model.joints[j].idx_v) for j in moving]
        return cls("pinocchio", **_renamed(rename, joints), nq=model.nq, nv=model.nv, **options)

    @classmethod
    def of_drake(cls, plant: Any, rename: Mapping[str, str | None] | None = None, **options: Any) -> StateLayout:
        """Layout of a finalised pydrake MultibodyPlant. rename: {its joint: ours}, None leaves one out."""
        moving = [j for j in map(plant.get_joint, plant.GetJointIndices()) if j.num_positions()]
        joints = [(j.name(), j.position_start(), j.velocity_start()) for j in moving]
        return cls("drake", **_renamed(rename, joints), nq=plant.num_positions(), nv=plant.num_velocities(), **options)

    def sizes(self, model: Any) -> tuple[int, int]:
        """(nq, nv) of the peer."""
        nq, nv = c_int(), c_int()
        check(lib.dyn_state_layout_sizes(model._m, byref(self._layout), byref(nq), byref(nv)))
        return nq.value, nv.value


class States(Configurations):
    """The part of Model that converts states."""

    def to_peer(
        self, layout: StateLayout | str, q: ArrayLike, v: ArrayLike | None = None, a: ArrayLike | None = None,
        tau: ArrayLike | None = None
    ) -> State:
        """A state as another library stores it: (q, v, a, tau) of the layout's sizes; a needs v.

        layout  a dyn.StateLayout, or "pinocchio", "mujoco", "drake" or "ros" for all joints in the model's order
        """
        return self._convert(layout, Direction.TO_PEER, q, v, a, tau)

    def from_peer(
        self, layout: StateLayout | str, q: ArrayLike, v: ArrayLike | None = None, a: ArrayLike | None = None,
        tau: ArrayLike | None = None
    ) -> State:
        """The inverse of to_peer. A follower's force is added to its leader's; its own q, v, a are not read."""
        return self._convert(layout, Direction.FROM_PEER, q, v, a, tau)

    def _convert(self, layout: StateLayout | str, towards: Direction, q: Any, v: Any, a: Any, tau: Any) -> State:
        if not isinstance(layout, StateLayout):
            layout = StateLayout(layout)
        ours, theirs = (self.nq, self.nv), layout.sizes(self)
        (nq, nv), (nq_out, nv_out) = (ours, theirs) if towards is Direction.TO_PEER else (theirs, ours)
        given: list[Numbers | None] = []
        for name, x, n in (("q", q, nq), ("v", v, nv), ("a", a, nv), ("tau", tau, nv)):
            if x is not None:
                if towards is Direction.TO_PEER and type(x) is not np.ndarray and isinstance(x, Mapping):
                    x = self._named(x, name)
                x = np.ascontiguousarray(numbers(x, name))
                if x.shape != (n,):
                    raise SizeError(f"{name} has shape {x.shape}, but must have shape ({n},).")
            given.append(x)
        out = [None if x is None else np.zeros(n) for x, n in zip(given, (nq_out, nv_out, nv_out, nv_out))]
        check(lib.dyn_state_layout_convert(self._m, byref(layout._layout), towards, _inputs(*map(address, given)),
                                           _outputs(*map(address, out))))
        return State(*out)
