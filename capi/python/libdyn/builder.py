"""dyn.Builder: makes a model from joints, bodies and frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from ctypes import byref, c_char_p, c_double, c_void_p
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import abi
from .actuator import Actuator
from .arrays import Owner, address, checked, numbers
from .arrays import placement as twelve
from .choices import member, string, text, whole
from .constraint import structure
from .enums import FrameType, ParameterGroup, ShapeRole, ShapeType
from .errors import ArgumentError
from .joint_spec import VALUES, joint_spec
from .library import check, lib
from .material import Material
from .mesh import Mesh
from .model import Model
from .sensor import Sensor
from .tendon import Tendon, TendonElement

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

    from .abi import JointValues
    from .arrays import Numbers
    from .enums import FrameTypeLike, JointTypeLike, ShapeRoleLike, ShapeTypeLike


class Parameter(NamedTuple):
    """A quantity of one object in a builder."""

    index: int
    """In the builder's list."""
    group: ParameterGroup
    object: str
    """"joint", "link", "shape", "actuator" ..; "model": of the whole."""
    name: str
    """Of the object; of a shape without a name "LINK, shape K"."""
    quantity: str
    """"damping"; a "placement" is x, y, z and a rotation vector, in the carrying joint."""
    values: Numbers


class Builder:
    """Makes models. Every method returns the builder, so calls chain; finish() gives the Model.

    A placement is a translation (3,), (R, p), a 4 x 4 matrix, a dyn.Placement, or the 12 numbers of dyn.h.
    A parent is the name of a joint, link or frame; None is the world.

        b = dyn.Builder("pendulum")
        b.add_joint("hinge", "revolute", axis=(0, 1, 0)).add_body("bob", "hinge", mass=1.0, com=(0, 0, -1))
        m = b.finish()
    """

    def __init__(self, name: str = "robot"):
        out = c_void_p()
        check(lib.dyn_builder_new(text(name, "name"), byref(out)))
        self._hold(out, name)

    def _hold(self, out: c_void_p, name: str) -> None:
        self._b = out.value
        self._owner = Owner(self._b, lib.dyn_builder_free)
        self.name = name

    @classmethod
    def from_model(cls, model: Model) -> Builder:
        """A builder with all that the model was made from: finished at once, it makes the same model."""
        out, self = c_void_p(), cls.__new__(cls)
        check(lib.dyn_builder_from_model(model._m, byref(out)))
        self._hold(out, model.name)
        return self

    def __repr__(self) -> str:
        return f"<dyn.Builder {self.name!r}>"

    def set_gravity(self, gravity: ArrayLike) -> Builder:
        """World axes, (3,), m/s^2; default (0, 0, -9.81)."""
        g = checked(gravity, (3,), "gravity")
        check(lib.dyn_builder_set_gravity(self._b, address(g)))
        return self

    def add_joint(
        self,
        name: str,
        type: JointTypeLike,
        parent: str | None = None,
        placement: Any = None,
        *,
        axis: ArrayLike | None = None,
        axis2: ArrayLike | None = None,
        pitch: float | None = None,
        mimic: str | None = None,
        parts: Sequence[Mapping[str, Any]] = (),
        **values: Unpack[JointValues],
    ) -> Builder:
        """Adds a joint.

        placement         joint frame in the parent's frame; default identity
        axis, axis2       any length but zero; default z, and x (only types that turn about two axes)
        pitch             helical: metres per radian
        mimic             leader's name: q = mimic_ratio * q_leader + mimic_offset
        parts             composite: its joints in order, dicts with type, placement, axis, axis2, pitch
        """
        spec, _keep = joint_spec(name, type, parent, placement, axis, axis2, pitch, mimic, parts, **values)
        check(lib.dyn_builder_add_joint(self._b, byref(spec)))
        return self

    def add_body(
        self,
        name: str,
        parent: str | None,
        mass: float,
        com: ArrayLike = (0.0, 0.0, 0.0),
        inertia: ArrayLike | None = None,
        placement: Any = None,
    ) -> Builder:
        """Adds a link: mass (kg), centre of mass (3,) (m) and inertia about it (3, 3) (kg m^2; default zero: a point),
        both in the link's frame, which lies at placement in its parent's."""
        c = checked(com, (3,), "com")
        i = checked(np.zeros((3, 3)) if inertia is None else inertia, (3, 3), "inertia")
        x = None if placement is None else twelve(placement)
        above = None if parent is None else text(parent, "parent")
        check(lib.dyn_builder_add_body(self._b, text(name, "name"), above, address(x), mass, address(c), address(i)))
        return self

    def add_frame(self, name: str, parent: str | None, placement: Any = None,
                  type: FrameTypeLike = FrameType.OP_FRAME) -> Builder:
        """Adds a frame."""
        x = None if placement is None else twelve(placement)
        above = None if parent is None else text(parent, "parent")
        check(lib.dyn_builder_add_frame(self._b, text(name, "name"), above, address(x), member(FrameType, type, "type")))
        return self

    def add_shape(
        self,
        body: str,
        type: ShapeTypeLike,
        size: ArrayLike = (),
        placement: Any = None,
        *,
        role: ShapeRoleLike = ShapeRole.COLLISION,
        name: str = "",
        mesh: str = "",
        radius: float = 0.0,
        contype: int = 1,
        conaffinity: int = 1,
        surface: Mesh | None = None,
        material: Material | None = None,
        rgba: ArrayLike | None = None,
        fluid: bool | ArrayLike = False,
        semiaxes: ArrayLike | None = None,
    ) -> Builder:
        """Adds a shape to a link, at placement in its frame; size as in dyn.ShapeInfo. radius: of rounding (m); contype,
        conaffinity:
        groups it is in, groups it collides with, a bit each; surface: of "convex" a hull, of "triangles" a mesh, of
        "height_field" one of Mesh.height_field; material: what happens where it touches; rgba: how it looks, red, green, blue,
        opacity, 0 to 1; fluid: the medium acts on it as on an ellipsoid (set_medium), with MuJoCo's coefficients (True) or with
        these: blunt, slender and angular drag, Kutta lift, Magnus force; semiaxes (m): of that ellipsoid, at placement, of
        shapes whose size gives none."""
        coefficients = None if fluid is True or fluid is False else checked(fluid, (5,), "fluid")
        axes = None if semiaxes is None else checked(semiaxes, (3,), "semiaxes")
        colour = None if rgba is None else checked(rgba, (4,), "rgba")
        if colour is not None and not ((colour >= 0) & (colour <= 1)).all():
            raise ArgumentError(f"rgba is {rgba}: give four numbers from 0 to 1.")
        spec = abi.initialized(abi.ShapeSpec)
        spec.body, spec.name, spec.mesh = text(body, "body"), text(name, "name"), text(mesh, "mesh")
        spec.type, spec.role = member(ShapeType, type, "type"), member(ShapeRole, role, "role")
        spec.radius, spec.contype, spec.conaffinity = radius, contype, conaffinity
        if surface is not None:
            spec.surface = surface._owner.address
        if material is not None:
            spec.material = material.structure()
        sizes = np.atleast_1d(numbers(size, "size")).tolist()
        spec.size[: len(sizes)] = checked(sizes, (min(len(sizes), 3),), "size").tolist()
        if placement is not None:
            spec.placement[:] = twelve(placement).tolist()
        check(lib.dyn_builder_add_shape(self._b, byref(spec)))
        if colour is not None:
            check(lib.dyn_builder_set_shape_rgba(self._b, address(colour)))
        if fluid is not False:
            check(lib.dyn_builder_set_shape_fluid(self._b, address(coefficients), address(axes), None))
        return self

    def add_configuration(self, name: str, q: ArrayLike) -> Builder:
        """Names a configuration: q, (nq,), in the finished model's order."""
        a = np.ascontiguousarray(numbers(q, "q").reshape(-1))
        check(lib.dyn_builder_add_configuration(self._b, text(name, "name"), address(a), a.size))
        return self

    def add_constraint(self, name: str, constraint: Any) -> Builder:
        """Adds a constraint of dyn.constraint: its first and second are names of frames or joints."""
        names = [None if x is None else text(x, "name") for x in (constraint.first, constraint.second)]
        check(lib.dyn_builder_add_constraint(self._b, text(name, "name"), byref(structure(constraint)), *names))
        return self

    def set_constraint_slots(self, slots: int) -> Builder:
        """Spare slots that a data of the model has."""
        check(lib.dyn_builder_set_constraint_slots(self._b, whole(slots, "slots")))
        return self

    def set_contact_capacity(self, contacts: int) -> Builder:
        """For how many contact points a step has room, the deepest; 0: for what the shapes need."""
        check(lib.dyn_builder_set_contact_capacity(self._b, whole(contacts, "contacts")))
        return self

    def add_actuator(self, name: str, target: str, actuator: Actuator | None = None, *, reference: str | None = None,
                     **values: Any) -> Builder:
        """Adds an actuator to a joint, a tendon or a frame: a dyn.Actuator, or its values, as in add_actuator("hip", "hip_joint",
        type="position", kp=40, kv=1). reference: with transmission="site", the frame that takes the opposite wrench; with
        "slider_crank" that of the slider."""
        spec = (Actuator(**values) if actuator is None else actuator._replace(**values)).structure()
        names = text(name, "name"), byref(spec), text(target, "target")
        if reference is None:
            check(lib.dyn_builder_add_actuator(self._b, *names))
        else:
            check(lib.dyn_builder_add_actuator_between(self._b, *names, text(reference, "reference")))
        return self

    def limit_actuators(self, joint: str, lower: float, upper: float, *, with_weight: bool = False) -> Builder:
        """Limits the sum of the actuators on a joint of one coordinate. with_weight: and of what gravity compensation gives it."""
        check(lib.dyn_builder_limit_actuators(self._b, text(joint, "joint"), lower, upper, with_weight))
        return self

    def limit_tendon_actuators(self, tendon: str, lower: float, upper: float) -> Builder:
        """Limits the sum of the actuators on a tendon: they are scaled alike."""
        check(lib.dyn_builder_limit_tendon_actuators(self._b, text(tendon, "tendon"), lower, upper))
        return self

    def add_tendon(self, name: str, elements: Sequence[TendonElement | tuple[Any, ...]], tendon: Tendon | None = None,
                   **values: Any) -> Builder:
        """Adds a tendon of these elements, dyn.TendonElement or tuples: a dyn.Tendon, or its values, as in
        add_tendon("cord", [("site", "a"), ("cylinder", "c", 0.03), ("site", "b")], type="spatial", stiffness=100)."""
        spec = (Tendon(**values) if tendon is None else tendon._replace(**values)).structure()
        parts = [TendonElement(*e).structure(f"tendon {name!r}: element {k}") for k, e in enumerate(elements)]
        array = (abi.TendonElement * len(parts))(*parts)
        check(lib.dyn_builder_add_tendon(self._b, text(name, "name"), byref(spec), array, len(parts)))
        return self

    def add_sensor(self, name: str, object: str | None = None, sensor: Sensor | None = None, *, reference: str | None = None,
                   **values: Any) -> Builder:
        """Adds a sensor on a joint, tendon, actuator or frame: a dyn.Sensor, or its values, as in
        add_sensor("imu", "torso", quantity="accelerometer"). reference: the frame that it is relative to."""
        spec = (Sensor(**values) if sensor is None else sensor._replace(**values)).structure()
        names = [None if x is None else text(x, what) for x, what in ((object, "object"), (reference, "reference"))]
        check(lib.dyn_builder_add_sensor(self._b, text(name, "name"), byref(spec), *names))
        return self

    def couple_tendons(self, name: str, tendon1: str, tendon2: str | None = None,
                       coefficients: ArrayLike = (0.0, 1.0, 0.0, 0.0, 0.0)) -> Builder:
        """Couples the lengths of two tendons in steps: L1 - L1_0 = p(L2 - L2_0), p a polynomial with five coefficients, the
        constant first; _0: in the initial configuration. tendon2 None: L1 - L1_0 is the constant."""
        c = checked(coefficients, (5,), "coefficients")
        second = None if tendon2 is None else text(tendon2, "tendon2")
        check(lib.dyn_builder_couple_tendons(self._b, text(name, "name"), text(tendon1, "tendon1"), second, address(c)))
        return self

    def set_gravity_compensation(self, body: str, share: float = 1.0) -> Builder:
        """Holds a share of a link's weight from outside, in steps."""
        check(lib.dyn_builder_set_gravity_compensation(self._b, text(body, "body"), share))
        return self

    def set_mocap(self, body: str) -> Builder:
        """Makes a link that is fixed to the world a mocap body, whose placement data sets (Data.set_mocap)."""
        check(lib.dyn_builder_set_mocap(self._b, text(body, "body")))
        return self

    def set_medium(self, density: float = 0.0, viscosity: float = 0.0, wind: ArrayLike = (0.0, 0.0, 0.0)) -> Builder:
        """Sets the medium: density (kg/m^3), viscosity (Pa s), wind (3,) (m/s). Steps apply its drag to all links."""
        check(lib.dyn_builder_set_medium(self._b, density, viscosity, address(checked(wind, (3,), "wind"))))
        return self

    def add_pair(self, shape1: str, shape2: str, material: Material | None = None) -> Builder:
        """Two collision shapes, by name, that are tested whatever the filter says; material: of their contacts, None: from the
        shapes'."""
        own = None if material is None else byref(material.structure())
        check(lib.dyn_builder_add_pair(self._b, text(shape1, "shape1"), text(shape2, "shape2"), own))
        return self

    def lock(self, joints: str | Sequence[str], q: ArrayLike) -> Builder:
        """Locks joints, and whoever follows them, at q, (nq,), of the model that finish would make now. Their links become part
        of what carries them, and they stay as frames."""
        names = [text(n, "joint") for n in ([joints] if isinstance(joints, str) else joints)]
        a = np.ascontiguousarray(numbers(q, "q").reshape(-1))
        check(lib.dyn_builder_lock(self._b, (c_char_p * len(names))(*names), len(names), address(a), a.size))
        return self

    def attach(self, model: Model, prefix: str = "", joint: str | None = None, type: JointTypeLike = "fixed",
               **spec: Any) -> Builder:
        """Adds a model, its names behind the prefix, its world carried by a joint of that name and type; spec: parent, placement,
        axis and all that add_joint() takes. joint None: its world is the builder's."""
        if joint is None:
            if spec:
                raise ArgumentError(f"attach: {', '.join(spec)} given without the name of a joint: give joint, too.")
            check(lib.dyn_builder_attach(self._b, model._m, text(prefix, "prefix"), None))
        else:
            built, _keep = joint_spec(joint, type, **spec)
            check(lib.dyn_builder_attach(self._b, model._m, text(prefix, "prefix"), byref(built)))
        return self

    def keep_subtree(self, joint: str) -> Builder:
        """Keeps a joint and what it carries; the frame of its parent becomes the world."""
        check(lib.dyn_builder_keep_subtree(self._b, text(joint, "joint")))
        return self

    def remove_subtree(self, joint: str) -> Builder:
        """Takes away a joint and what it carries."""
        check(lib.dyn_builder_remove_subtree(self._b, text(joint, "joint")))
        return self

    def parameters(self) -> list[Parameter]:
        """The numbers of joints, links, frames, collision shapes, actuators, tendons and constraints, one quantity of an object
        each."""
        out, x = [], abi.Parameter()
        for k in range(lib.dyn_builder_parameter_count(self._b)):
            check(lib.dyn_builder_parameter(self._b, k, byref(x)))
            values = np.ctypeslib.as_array((c_double * x.count).from_address(x.values)).copy()
            names = [string(t) for t in (x.object, x.name, x.quantity)]
            out.append(Parameter(k, ParameterGroup(x.group), names[0], names[1], names[2], values))
        return out

    def set_parameter(self, parameter: Parameter | int, values: ArrayLike) -> Builder:
        """Replaces the numbers of a quantity: one of parameters(), or its index there."""
        a = np.atleast_1d(numbers(values, "values")).reshape(-1)
        index = parameter.index if isinstance(parameter, Parameter) else whole(parameter, "parameter")
        check(lib.dyn_builder_set_parameter(self._b, index, address(a), a.size))
        return self

    def finish(self) -> Model:
        """Compiles. The builder may be extended and finished again."""
        out = c_void_p()
        check(lib.dyn_builder_finish(self._b, byref(out)))
        return Model(out.value)


Builder.add_joint.__doc__ = f"{Builder.add_joint.__doc__}" + "".join(f"{name:<16}  {sentence}\n        "
                                                                     for name, sentence in VALUES.items())
