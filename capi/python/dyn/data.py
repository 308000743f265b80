"""What a robot is doing: Data, its fields and the algorithms."""

from __future__ import annotations

import weakref
from ctypes import byref, c_double, c_uint32, c_void_p
from typing import TYPE_CHECKING, Any, Callable, NamedTuple

import numpy as np

from . import abi
from . import ik as inverse_kinematics
from .actuator import Driving
from .arrays import Owner, Placement, address, checked, numbers, result, slot, to_placement, view
from .collision import CollisionQueries
from .constraint import ConstraintCalls
from .contact import ContactQueries
from .enums import Effect, IkReason, Part, Reference, Term
from .errors import ArgumentError, UnknownNameError
from .library import check, fail, last_error, lib
from .model import Model, mask, member, text
from .simulation import Stepping

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class FieldInfo(NamedTuple):
    """A quantity that data holds, as the library describes it."""

    id: int
    name: str
    shape: str
    unit: str
    frame: str
    producer: str
    """The call that computes it; "" for the state."""
    sentence: str
    part: Part


class Energy(NamedTuple):
    """Joules; potential is zero at the world's origin."""

    kinetic: float
    potential: float

    @property
    def mechanical(self) -> float:
        return self.kinetic + self.potential


class InverseDerivatives(NamedTuple):
    """Of tau on the tangent space, (nv, nv) each; dtau_da is M."""

    dtau_dq: np.ndarray
    dtau_dv: np.ndarray
    dtau_da: np.ndarray


class ForwardDerivatives(NamedTuple):
    """Of ddq on the tangent space, (nv, nv) each; ddq_dtau is M^-1."""

    ddq_dq: np.ndarray
    ddq_dv: np.ndarray
    ddq_dtau: np.ndarray


class Centroidal(NamedTuple):
    """About the centre of mass, axes of the world."""

    Ag: np.ndarray
    """(6, nv): hg = Ag v."""
    dAg: np.ndarray
    """(6, nv): dhg = Ag a + dAg v."""
    hg: np.ndarray
    """Momentum, (6,)."""
    dhg: np.ndarray
    """Its time derivative, (6,)."""
    Ig: np.ndarray
    """Inertia of the whole, (6, 6): [m 1, 0; 0, I]."""


class CentroidalDerivatives(NamedTuple):
    """On the tangent space, (6, nv) each."""

    dh_dq: np.ndarray
    dhdot_dq: np.ndarray
    dhdot_dv: np.ndarray
    dhdot_da: np.ndarray


class FrameVelocityDerivatives(NamedTuple):
    """On the tangent space, (6, nv) each."""

    dv_dq: np.ndarray
    dv_dv: np.ndarray


class FrameAccelerationDerivatives(NamedTuple):
    """On the tangent space, (6, nv) each."""

    da_dq: np.ndarray
    da_dv: np.ndarray
    da_da: np.ndarray


class CenterOfMassVelocityDerivatives(NamedTuple):
    """On the tangent space, (3, nv) each."""

    dvcom_dq: np.ndarray
    dvcom_dv: np.ndarray


class SecondOrderProduct(NamedTuple):
    """Second derivatives of lambda . tau on the tangent space, (nv, nv) each: rows by the first variable, columns by the second."""

    dqdq: np.ndarray
    dvdv: np.ndarray
    dqdv: np.ndarray
    dadq: np.ndarray


class SecondOrderDerivatives(NamedTuple):
    """On the tangent space, (nv, nv, nv) each: [i, j, k] of tau_i by the first variable's j, then the second one's k."""

    d2tau_dqdq: np.ndarray
    d2tau_dvdv: np.ndarray
    d2tau_dqdv: np.ndarray
    d2tau_dadq: np.ndarray


def _fields() -> dict[str, FieldInfo]:
    fields = {}
    for id in range(lib.dyn_nfields()):
        info = abi.FieldInfo()
        check(lib.dyn_field_info(id, byref(info)))
        words = [(s or b"").decode() for s in (info.name, info.shape, info.unit, info.frame, info.producer, info.sentence)]
        fields[words[0]] = FieldInfo(id, *words, Part(info.part))
    return fields


FIELDS: dict[str, FieldInfo] = _fields()
"""Every field of the loaded library, by name."""

_SHAPES: dict[int, list[str]] = {}
for _f in FIELDS.values():
    _dims = _f.shape.replace("scalar", "1").split(" x ")
    _SHAPES[_f.id] = [] if set(_dims) == {"1"} else _dims[:1] if _dims[1:] in ([], ["1"]) else _dims

_REFERENCES: dict[Any, int] = {key: int(r) for r in Reference for key in (r, r.name, r.name.lower())}

_ID = {name: info.id for name, info in FIELDS.items()}
_STATE = {"q": "q", "v": "v", "a": "a", "tau_applied": "tau"}  # field: argument

# Bound once: an attribute of the CDLL costs a look-up in every call.
_aba = lib.dyn_aba
_aba_derivatives = lib.dyn_aba_derivatives
_centroidal_derivatives = lib.dyn_centroidal_derivatives
_centroidal_map = lib.dyn_centroidal_map
_centroidal_map_time_variation = lib.dyn_centroidal_map_time_variation
_centroidal_momentum = lib.dyn_centroidal_momentum
_centroidal_momentum_rate = lib.dyn_centroidal_momentum_rate
_center_of_mass = lib.dyn_center_of_mass
_center_of_mass_jacobian = lib.dyn_center_of_mass_jacobian
_coriolis_matrix = lib.dyn_coriolis_matrix
_crba = lib.dyn_crba
_data_array = lib.dyn_data_array
_forward_kinematics = lib.dyn_forward_kinematics
_frame_acceleration = lib.dyn_frame_acceleration
_frame_classical_acceleration = lib.dyn_frame_classical_acceleration
_frame_jacobian = lib.dyn_frame_jacobian
_frame_jacobian_time_variation = lib.dyn_frame_jacobian_time_variation
_frame_placement = lib.dyn_frame_placement
_frame_velocity = lib.dyn_frame_velocity
_gravity = lib.dyn_gravity
_ik = lib.dyn_ik
_joint_torque_regressor = lib.dyn_joint_torque_regressor
_kinetic_energy_regressor = lib.dyn_kinetic_energy_regressor
_potential_energy_regressor = lib.dyn_potential_energy_regressor
_static_regressor = lib.dyn_static_regressor
_joint_jacobians = lib.dyn_joint_jacobians
_joint_jacobians_time_variation = lib.dyn_joint_jacobians_time_variation
_minverse = lib.dyn_minverse
_nonlinear_effects = lib.dyn_nonlinear_effects
_rnea = lib.dyn_rnea
_rnea_derivatives = lib.dyn_rnea_derivatives
_set_state = lib.dyn_data_set_state
_static_torque = lib.dyn_static_torque


class EffectPlan(NamedTuple):
    """One effect of a data's steps."""

    present: int
    """How many joints, pairs, constraints, actuators, links may have it."""
    acting: int
    """Not 0: it acts; of contact and constraints how many pairs are tested, slots enabled."""
    bytes: int
    """Of the data's memory, for it alone."""


class Data(CollisionQueries, ContactQueries, ConstraintCalls, Driving, Stepping):
    """What the robot is doing: every buffer, for one thread at a time. From Model.data().

    A call with q, v, a or tau sets the state that data holds; None uses what is held. Methods return new arrays.
    Fields (d.q, d.M, d.com, ...: dir(d), help(dyn.Data.M)) are read-only views of the library's memory that follow the
    data and keep it alive; one that was not computed for the current state raises dyn.StaleError naming the call to make.
    """

    if TYPE_CHECKING:

        def __getattr__(self, field: str) -> np.ndarray: ...

    def __init__(self, model: Model, parts: Any = Part.ALL, memory: Any = None):
        self.model = model
        """The robot."""
        self._m = model._m
        out = c_void_p()
        bits = mask(Part, parts, "parts")
        if memory is None:
            check(lib.dyn_data_new(self._m, bits, byref(out)))
        else:
            try:
                memory = np.frombuffer(memory, np.uint8)
            except (TypeError, ValueError) as error:
                raise ArgumentError(f"memory is not a contiguous buffer: {error}.") from None
            if not memory.flags.writeable:
                raise ArgumentError("memory is read-only, but data is placed in it.")
            check(lib.dyn_data_init(self._m, bits, address(memory), memory.size, byref(out)))
        self._d = out.value
        self._owner = Owner(self._d, lib.dyn_data_free, (model._owner, memory))
        self.parts = Part(bits or Part.ALL)
        """The groups of buffers that this data has."""
        self._views: dict[int, np.ndarray | None] = {}
        self._array = abi.Array()
        self._array_ref = byref(self._array)

        nv, ref = model.nv, weakref.ref(model)
        self._q = slot((model.nq,), "q", ref)
        self._v = slot((nv,), "v", ref)
        self._a = slot((nv,), "a", ref)
        self._tau = slot((nv,), "tau", ref)
        self._fext_in: Callable | None = None
        self._three, self._six, self._twelve = result((3,)), result((6,)), result((12,))
        self._three_nv, self._six_nv = result((3, nv)), result((6, nv))

    def __repr__(self) -> str:
        names = [name.lower() for name, p in Part.__members__.items() if p in self.parts and p != Part.ALL]
        parts = "all parts" if self.parts == Part.ALL else "parts " + ", ".join(names)
        return f"<dyn.Data of {self.model.name!r}: nq {self.model.nq}, nv {self.model.nv}, {parts}>"

    def _fext(self, fext: Any) -> int | None:
        if fext is None:
            return None
        if self._fext_in is None:
            self._fext_in = slot((6, self.model.njoints), "fext", weakref.ref(self.model))
        return self._fext_in(fext)

    def _result(self, status: int, field: int) -> np.ndarray:
        """A copy of what a call has left in data."""
        if status:
            fail(status)
        found = self._views.get(field)
        if found is None:
            found = self.field(field)
        return found.copy("F")

    # ------------------------------------------------------------------------------------------- state and fields

    def set_state(self, q: Any = None, v: Any = None, a: Any = None, tau: Any = None) -> None:
        """Sets what is given of the state: q (nq,), v, a, tau (nv,). set_state(**json.load(file)) reads a state file."""
        status = _set_state(self._m, self._d, self._q(q), self._v(v), self._a(a), self._tau(tau))
        if status:
            fail(status)

    @property
    def state(self) -> dict[str, np.ndarray]:
        """Copies of the state: {"q", "v", "a", "tau"}, as set_state takes it."""
        return {name: self.field(field).copy() for field, name in _STATE.items()}

    def plan(self) -> dict[str, EffectPlan]:
        """What a step of this data takes into account, by name."""
        out, info = {}, abi.EffectInfo()
        for k in range(lib.dyn_neffects()):
            check(lib.dyn_effect_info(self._m, self._d, k, byref(info)))
            out[info.name.decode()] = EffectPlan(info.present, info.acting, info.bytes)
        return out

    def set_effects(self, effects: Any, joint: str | int = 0) -> None:
        """Switches the effects of a joint, or of all, to those given: dyn.Effect members or names, as "damping", ("armature",
        "springs"), "all" or (). New data: armature alone."""
        check(lib.dyn_data_set_effects(self._m, self._d, self.model._joint(joint), mask(Effect, effects, "effects")))

    def warmup(self) -> None:
        """Touches what later calls would be the first to touch: no call waits for a page of memory. Once in each thread with a deadline."""
        check(lib.dyn_warmup(self._m, self._d))

    def effects(self, joint: str | int = 0) -> Effect:
        """Those that are on at a joint; without one, those that act at some joint."""
        out = c_uint32()
        check(lib.dyn_data_effects(self._m, self._d, self.model._joint(joint), byref(out)))
        return Effect(out.value)

    def field(self, field: str | int) -> Any:
        """A field by name or id: a read-only view of the library's memory (a number for a scalar)."""
        if not isinstance(field, int):
            id = lib.dyn_field_id(text(field, "field"))
            if id < 0:
                raise UnknownNameError(last_error())
            field = id
        status = _data_array(self._m, self._d, field, self._array_ref)
        if status:
            fail(status)
        found = self._views.get(field)
        if found is None:
            a = self._array
            dims = _SHAPES[field]  # "nv", "nv x 1": a vector, "6 x nv": a matrix, "1 x 1": a number
            found = view(a.data, a.rows, a.cols if len(dims) == 2 else None, tuple(a.stride), self._owner)
            self._views[field] = found = found if dims else found.reshape(())
        return found if found.ndim else float(found)

    # ------------------------------------------------------------------------------------------- kinematics

    def forward_kinematics(self, q: Any = None, v: Any = None, a: Any = None) -> None:
        """Placements of all joints; with v their velocities, with a, too, their accelerations."""
        status = _forward_kinematics(self._m, self._d, self._q(q), self._v(v), self._a(a))
        if status:
            fail(status)

    def frame_placement(self, frame: int | str) -> Placement:
        """Pose X_WF of a frame: (rotation (3, 3), translation (3,), m). Needs forward_kinematics."""
        out, start = self._twelve
        status = _frame_placement(self._m, self._d, self.model._frame(frame), start)
        if status:
            fail(status)
        return to_placement(out.copy())

    def frame_placements(self) -> Placement:
        """Poses of all frames: (rotation (nframes, 3, 3), translation (nframes, 3)). Needs forward_kinematics."""
        out = np.empty((self.model.nframes, 12))
        check(lib.dyn_frame_placements(self._m, self._d, address(out)))
        return Placement(out[:, :9].reshape(-1, 3, 3).transpose(0, 2, 1), out[:, 9:])

    def _reference(self, reference: Any) -> int:
        found = _REFERENCES.get(reference)
        return member(Reference, reference, "reference") if found is None else found

    def _of_frame(self, call, frame: Any, reference: Any, result: Any) -> np.ndarray:
        out, start = result
        status = call(self._m, self._d, self.model._frame(frame), self._reference(reference), start)
        if status:
            fail(status)
        return out.copy("F")

    def frame_velocity(self, frame: int | str, reference: str | Reference = Reference.LOCAL) -> np.ndarray:
        """Spatial velocity [linear; angular] of a frame, (6,), m/s and rad/s."""
        return self._of_frame(_frame_velocity, frame, reference, self._six)

    def frame_acceleration(self, frame: int | str, reference: str | Reference = Reference.LOCAL) -> np.ndarray:
        """Spatial acceleration of a frame, (6,), m/s^2 and rad/s^2, without gravity."""
        return self._of_frame(_frame_acceleration, frame, reference, self._six)

    def frame_classical_acceleration(self, frame: int | str, reference: str | Reference = Reference.LOCAL) -> np.ndarray:
        """Second derivative of the frame origin's position, and the angular acceleration, (6,)."""
        return self._of_frame(_frame_classical_acceleration, frame, reference, self._six)

    def joint_jacobians(self, q: Any = None) -> np.ndarray:
        """J, (6, nv), in the world's reference: the column of each degree of freedom, as if it moved all."""
        return self._result(_joint_jacobians(self._m, self._d, self._q(q), None), _ID["J"])

    def joint_jacobians_time_variation(self, q: Any = None, v: Any = None) -> np.ndarray:
        """dJ/dt, (6, nv), in the world's reference; includes J."""
        return self._result(_joint_jacobians_time_variation(self._m, self._d, self._q(q), self._v(v), None), _ID["dJ"])

    def frame_jacobian(self, frame: int | str, reference: str | Reference = Reference.LOCAL) -> np.ndarray:
        """Jacobian of a frame, (6, nv): J v = frame_velocity. Needs forward_kinematics of q."""
        return self._of_frame(_frame_jacobian, frame, reference, self._six_nv)

    def frame_jacobian_time_variation(self, frame: int | str, reference: str | Reference = Reference.LOCAL) -> np.ndarray:
        """d/dt of frame_jacobian, (6, nv). Needs forward_kinematics of q and v."""
        return self._of_frame(_frame_jacobian_time_variation, frame, reference, self._six_nv)

    def _derivatives_of_frame(self, call, kind, frame: Any, reference: Any):
        out = kind(*(np.empty((6, self.model.nv), order="F") for _ in kind._fields))
        check(call(self._m, self._d, self.model._frame(frame), self._reference(reference), *map(address, out)))
        return out

    def frame_velocity_derivatives(
        self, frame: int | str, reference: str | Reference = Reference.LOCAL
    ) -> FrameVelocityDerivatives:
        """Derivatives (dv_dq, dv_dv) of frame_velocity. Needs forward_kinematics of q and v."""
        return self._derivatives_of_frame(lib.dyn_frame_velocity_derivatives, FrameVelocityDerivatives, frame, reference)

    def frame_acceleration_derivatives(
        self, frame: int | str, reference: str | Reference = Reference.LOCAL
    ) -> FrameAccelerationDerivatives:
        """Derivatives (da_dq, da_dv, da_da) of frame_acceleration. Needs forward_kinematics of q, v, a."""
        return self._derivatives_of_frame(lib.dyn_frame_acceleration_derivatives, FrameAccelerationDerivatives, frame, reference)

    def frame_classical_acceleration_derivatives(
        self, frame: int | str, reference: str | Reference = Reference.LOCAL
    ) -> FrameAccelerationDerivatives:
        """The same of frame_classical_acceleration."""
        call = lib.dyn_frame_classical_acceleration_derivatives
        return self._derivatives_of_frame(call, FrameAccelerationDerivatives, frame, reference)

    def frame_kinematic_hessian(self, frame: int | str, reference: str | Reference = Reference.LOCAL) -> np.ndarray:
        """H, (6, nv, nv): H[:, :, k] is the derivative of frame_jacobian by q_k. Needs forward_kinematics of q."""
        H = np.empty((6, self.model.nv, self.model.nv), order="F")
        check(lib.dyn_frame_kinematic_hessian(self._m, self._d, self.model._frame(frame), self._reference(reference), address(H)))
        return H

    # ------------------------------------------------------------------------------------------- centre of mass

    def center_of_mass(self, q: Any = None, v: Any = None, a: Any = None) -> np.ndarray:
        """com, (3,), m, world axes; with v and a also the fields vcom and acom."""
        status = _center_of_mass(self._m, self._d, self._q(q), self._v(v), self._a(a), None, None, None)
        return self._result(status, _ID["com"])

    def center_of_mass_jacobian(self, q: Any = None) -> np.ndarray:
        """Jcom, (3, nv): Jcom v = vcom."""
        return self._result(_center_of_mass_jacobian(self._m, self._d, self._q(q), None), _ID["Jcom"])

    def center_of_mass_velocity_derivatives(self, q: Any = None, v: Any = None) -> CenterOfMassVelocityDerivatives:
        """Derivatives (dvcom_dq, dvcom_dv) of vcom; the second is Jcom."""
        check(lib.dyn_center_of_mass_velocity_derivatives(self._m, self._d, self._q(q), self._v(v), None, None))
        return CenterOfMassVelocityDerivatives(self.dvcom_dq.copy("F"), self.Jcom.copy("F"))

    def subtree_center_of_mass(self, joint: int | str) -> tuple[np.ndarray, float]:
        """(com (3,), mass) of what a joint carries. Needs center_of_mass."""
        (com, start), mass = self._three, c_double()
        check(lib.dyn_subtree_center_of_mass(self._m, self._d, self.model._joint(joint), start, byref(mass)))
        return com.copy(), mass.value

    def subtree_center_of_mass_jacobian(self, joint: int | str) -> np.ndarray:
        """Jacobian of that point, (3, nv). Needs center_of_mass."""
        out, start = self._three_nv
        check(lib.dyn_subtree_center_of_mass_jacobian(self._m, self._d, self.model._joint(joint), start))
        return out.copy("F")

    # ------------------------------------------------------------------------------------------- dynamics
    # fext: external forces [force; moment] on each joint's body, in the joint's frame, (6, njoints); column 0 is ignored.

    def rnea(self, q: Any = None, v: Any = None, a: Any = None, fext: ArrayLike | None = None) -> np.ndarray:
        """Inverse dynamics tau = M a + nle - J^T fext, (nv,), N m or N."""
        return self._result(_rnea(self._m, self._d, self._q(q), self._v(v), self._a(a), self._fext(fext), None), _ID["tau"])

    def nonlinear_effects(self, q: Any = None, v: Any = None) -> np.ndarray:
        """nle = tau at a = 0: Coriolis, centrifugal, gravity, (nv,)."""
        return self._result(_nonlinear_effects(self._m, self._d, self._q(q), self._v(v), None), _ID["nle"])

    def gravity(self, q: Any = None) -> np.ndarray:
        """g = tau at v = a = 0, (nv,)."""
        return self._result(_gravity(self._m, self._d, self._q(q), None), _ID["g"])

    def static_torque(self, q: Any = None, fext: ArrayLike | None = None) -> np.ndarray:
        """tau that holds q at rest: g - J^T fext, (nv,)."""
        return self._result(_static_torque(self._m, self._d, self._q(q), self._fext(fext), None), _ID["static_torque"])

    def coriolis_matrix(self, q: Any = None, v: Any = None) -> np.ndarray:
        """C, (nv, nv): C v + g = nle, and dM/dt - 2 C is skew-symmetric."""
        return self._result(_coriolis_matrix(self._m, self._d, self._q(q), self._v(v), None), _ID["coriolis"])

    def aba(self, q: Any = None, v: Any = None, tau: Any = None, fext: ArrayLike | None = None) -> np.ndarray:
        """Forward dynamics ddq = M^-1 (tau - nle + J^T fext), (nv,)."""
        return self._result(_aba(self._m, self._d, self._q(q), self._v(v), self._tau(tau), self._fext(fext), None), _ID["ddq"])

    def crba(self, q: Any = None) -> np.ndarray:
        """M, (nv, nv), full and symmetric."""
        return self._result(_crba(self._m, self._d, self._q(q), None), _ID["M"])

    def factorize(self) -> None:
        """Sparse factor of the current M: what solve needs."""
        check(lib.dyn_factorize(self._m, self._d))

    def solve(self, b: ArrayLike) -> np.ndarray:
        """x = M^-1 b for b (nv,) or (nv, n). Needs factorize."""
        b = numbers(b, "b")
        many = b.shape if b.ndim == 2 else (self.model.nv,)
        b = checked(b, (self.model.nv, *many[1:]), "b")
        x = np.empty(b.shape, order="F")
        check(lib.dyn_solve(self._m, self._d, address(b), b.shape[1] if b.ndim == 2 else 1, address(x)))
        return x

    def minverse(self, q: Any = None) -> np.ndarray:
        """M^-1, (nv, nv), full and symmetric."""
        return self._result(_minverse(self._m, self._d, self._q(q), None), _ID["Minv"])

    def rnea_derivatives(self, q: Any = None, v: Any = None, a: Any = None, fext: ArrayLike | None = None) -> InverseDerivatives:
        """Derivatives (dtau_dq, dtau_dv, dtau_da) of inverse dynamics; also the fields tau and M. fext is constant in the joints' frames."""
        check(_rnea_derivatives(self._m, self._d, self._q(q), self._v(v), self._a(a), self._fext(fext), None, None))
        return InverseDerivatives(*(x.copy("F") for x in (self.dtau_dq, self.dtau_dv, self.M)))

    def aba_derivatives(self, q: Any = None, v: Any = None, tau: Any = None, fext: ArrayLike | None = None) -> ForwardDerivatives:
        """Derivatives (ddq_dq, ddq_dv, ddq_dtau) of forward dynamics; also the fields ddq and Minv."""
        check(_aba_derivatives(self._m, self._d, self._q(q), self._v(v), self._tau(tau), self._fext(fext), None, None, None))
        return ForwardDerivatives(*(x.copy("F") for x in (self.ddq_dq, self.ddq_dv, self.Minv)))

    def gravity_derivatives(self, q: Any = None) -> np.ndarray:
        """dg/dq, (nv, nv), on the tangent space."""
        return self._result(lib.dyn_gravity_derivatives(self._m, self._d, self._q(q), None), _ID["dg_dq"])

    def static_torque_derivatives(self, q: Any = None, fext: ArrayLike | None = None) -> np.ndarray:
        """Derivative of static_torque by q, (nv, nv), on the tangent space; fext is constant in the joints' frames."""
        status = lib.dyn_static_torque_derivatives(self._m, self._d, self._q(q), self._fext(fext), None)
        return self._result(status, _ID["dstatic_torque_dq"])

    def rnea_second_order_product(
        self, lam: ArrayLike, q: Any = None, v: Any = None, a: Any = None, fext: ArrayLike | None = None
    ) -> SecondOrderProduct:
        """Second derivatives of lam . rnea, lam (nv,), in about the time of two rnea_derivatives."""
        lam = checked(lam, (self.model.nv,), "lam")
        none = [None] * 4
        call = lib.dyn_rnea_second_order_product
        check(call(self._m, self._d, self._q(q), self._v(v), self._a(a), self._fext(fext), address(lam), *none))
        return SecondOrderProduct(*(self.field(f"lambda_d2tau_{x}").copy("F") for x in SecondOrderProduct._fields))

    def rnea_second_order_derivatives(
        self, q: Any = None, v: Any = None, a: Any = None, fext: ArrayLike | None = None
    ) -> SecondOrderDerivatives:
        """Second derivatives of rnea, (nv, nv, nv) each. Where two rotations of one spherical or free-flyer joint do not commute,
        d2tau_dqdq[i, j, k] differs from d2tau_dqdq[i, k, j]."""
        out = [np.empty((self.model.nv,) * 3) for _ in SecondOrderDerivatives._fields]
        call = lib.dyn_rnea_second_order_derivatives
        check(call(self._m, self._d, self._q(q), self._v(v), self._a(a), self._fext(fext), *map(address, out)))
        return SecondOrderDerivatives(*(x.transpose(0, 2, 1) for x in out))

    def energy(self, q: Any = None, v: Any = None) -> Energy:
        """Kinetic and potential energy, J."""
        kinetic, potential = c_double(), c_double()
        check(lib.dyn_energy(self._m, self._d, self._q(q), self._v(v), byref(kinetic), byref(potential)))
        return Energy(kinetic.value, potential.value)

    def kinetic_energy(self, q: Any = None, v: Any = None) -> float:
        """v' M v / 2, armature included, J."""
        out = c_double()
        check(lib.dyn_kinetic_energy(self._m, self._d, self._q(q), self._v(v), byref(out)))
        return out.value

    def potential_energy(self, q: Any = None) -> float:
        """Zero at the world's origin, J."""
        out = c_double()
        check(lib.dyn_potential_energy(self._m, self._d, self._q(q), byref(out)))
        return out.value

    def all_terms(self, terms: Any = Term.ALL, q: Any = None, v: Any = None) -> Term:
        """Everything in a mask of dyn.Term, passes shared; answers what is now in data."""
        filled = c_uint32()
        check(lib.dyn_all_terms(self._m, self._d, mask(Term, terms, "terms"), self._q(q), self._v(v), byref(filled)))
        return Term(filled.value)

    # ------------------------------------------------------------------------------------------- centroidal

    def centroidal_map(self, q: Any = None, v: Any = None) -> np.ndarray:
        """Ag, (6, nv): hg = Ag v, the momentum about the centre of mass, axes of the world; also the fields Ig and hg."""
        return self._result(_centroidal_map(self._m, self._d, self._q(q), self._v(v), None, None, None), _ID["Ag"])

    def centroidal_map_time_variation(self, q: Any = None, v: Any = None) -> np.ndarray:
        """dAg, (6, nv): dhg = Ag a + dAg v; also the fields Ag, Ig and hg."""
        return self._result(_centroidal_map_time_variation(self._m, self._d, self._q(q), self._v(v), None), _ID["dAg"])

    def centroidal_momentum(self, q: Any = None, v: Any = None) -> np.ndarray:
        """hg, (6,), without Ag."""
        return self._result(_centroidal_momentum(self._m, self._d, self._q(q), self._v(v), None), _ID["hg"])

    def centroidal_momentum_rate(self, q: Any = None, v: Any = None, a: Any = None) -> np.ndarray:
        """dhg, (6,), the time derivative of hg for the acceleration a; also the field hg."""
        status = _centroidal_momentum_rate(self._m, self._d, self._q(q), self._v(v), self._a(a), None)
        return self._result(status, _ID["dhg"])

    def centroidal(self, q: Any = None, v: Any = None, a: Any = None) -> Centroidal:
        """(Ag, dAg, hg, dhg, Ig)."""
        dAg = self.centroidal_map_time_variation(q, v)
        dhg = self.centroidal_momentum_rate(a=a)
        return Centroidal(self.Ag.copy("F"), dAg, self.hg.copy(), dhg, self.Ig.copy("F"))

    def centroidal_derivatives(self, q: Any = None, v: Any = None, a: Any = None) -> CentroidalDerivatives:
        """Derivatives (dh_dq, dhdot_dq, dhdot_dv, dhdot_da) of hg and dhg; also the fields Ag, Ig, hg and dhg."""
        check(_centroidal_derivatives(self._m, self._d, self._q(q), self._v(v), self._a(a), None, None, None, None))
        return CentroidalDerivatives(*(x.copy("F") for x in (self.dh_dq, self.dhdot_dq, self.dhdot_dv, self.Ag)))

    # ------------------------------------------------------------------------------------------- identification
    # pi: the inertial parameters of all joints' bodies, Model.inertial_parameters(), (10 (njoints - 1),).

    def joint_torque_regressor(self, q: Any = None, v: Any = None, a: Any = None) -> np.ndarray:
        """Y, (nv, 10 (njoints - 1)): rnea = Y pi + armature * a."""
        status = _joint_torque_regressor(self._m, self._d, self._q(q), self._v(v), self._a(a), None)
        return self._result(status, _ID["regressor"])

    def static_regressor(self, q: Any = None) -> np.ndarray:
        """Y, (3, 10 (njoints - 1)): com = Y pi."""
        return self._result(_static_regressor(self._m, self._d, self._q(q), None), _ID["static_regressor"])

    def kinetic_energy_regressor(self, q: Any = None, v: Any = None) -> np.ndarray:
        """y, (10 (njoints - 1),): the kinetic energy without that of the armature is y @ pi."""
        status = _kinetic_energy_regressor(self._m, self._d, self._q(q), self._v(v), None)
        return self._result(status, _ID["kinetic_energy_regressor"])

    def potential_energy_regressor(self, q: Any = None) -> np.ndarray:
        """y, (10 (njoints - 1),): the potential energy is y @ pi."""
        status = _potential_energy_regressor(self._m, self._d, self._q(q), None)
        return self._result(status, _ID["potential_energy_regressor"])

    def joint_body_regressor(self, joint: int | str) -> np.ndarray:
        """Y, (6, 10): Y pi is the force that moves a joint's body, in the joint's frame. Needs forward_kinematics of q, v, a."""
        Y = np.empty((6, 10), order="F")
        check(lib.dyn_joint_body_regressor(self._m, self._d, self.model._joint(joint), address(Y)))
        return Y

    def frame_body_regressor(self, frame: int | str) -> np.ndarray:
        """The same of a body that moves with a frame, its pi and the force in that frame: a link's own, merged or not."""
        Y = np.empty((6, 10), order="F")
        check(lib.dyn_frame_body_regressor(self._m, self._d, self.model._frame(frame), address(Y)))
        return Y

    # ------------------------------------------------------------------------------------------- inverse kinematics

    def ik(
        self,
        tasks: Any,
        q: Any = None,
        *,
        max_iterations: int | None = None,
        restarts: int | None = None,
        seed: int | None = None,
        tolerance_linear: float | None = None,
        tolerance_angular: float | None = None,
        limits: bool | None = None,
        lower: Any = None,
        upper: Any = None,
    ) -> inverse_kinematics.Result:
        """q that does the tasks (of dyn.ik) within the joint limits, starting at q (None: the held one); data is there
        afterwards. Not to converge is no error: see the result's reason. restarts = 0 to follow a moving target.
        Defaults: 500 iterations a start, 20 restarts, seed 0, 1e-6 m and rad, the model's limits."""
        m = self.model
        given, keep = inverse_kinematics.structures(m, tasks)
        options = abi.IkOptions()
        lib.dyn_ik_options_init(byref(options))
        for name, x in (
            ("max_iterations", max_iterations), ("restarts", restarts), ("seed", seed), ("tolerance_linear", tolerance_linear),
            ("tolerance_angular", tolerance_angular), ("limits", limits),
        ):  # fmt: skip
            if x is not None:
                try:
                    setattr(options, name, x)
                except TypeError:
                    raise ArgumentError(f"{name} is {x!r}, but must be a number.") from None
        for name, x in (("lower", lower), ("upper", upper)):
            if x is not None:
                keep.append(checked(x, (m.nq,), name))
                setattr(options, name, address(keep[-1]))
        solution, residuals, r = np.empty(m.nq), np.empty((len(given), 2)), abi.IkResult()
        status = _ik(self._m, self._d, self._q(q), given, len(given), byref(options), address(solution), address(residuals), byref(r))
        if status:
            fail(status)
        joint = m.joint_name(r.joint) if r.joint >= 0 else None
        return inverse_kinematics.Result(solution, IkReason(r.reason), residuals, r.iterations, r.restarts, joint, r.cost, r.optimality)


def _property(info: FieldInfo) -> property:
    def get(self):
        return self.field(id)

    def put(self, value):
        self.set_state(**{_STATE[name]: value})

    id, name = info.id, info.name
    origin = f" Computed by {info.producer}." if info.producer else ""
    doc = f"{info.sentence} ({info.shape}; {info.unit or 'no unit'}; frame: {info.frame or 'none'}.){origin}"
    return property(get, put if name in _STATE else None, doc=doc)


for _info in FIELDS.values():
    if not hasattr(Data, _info.name):  # a method of the same name stays; Data.field(name) reaches the field
        setattr(Data, _info.name, _property(_info))
