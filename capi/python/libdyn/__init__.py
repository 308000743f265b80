"""Rigid-body dynamics.

    import libdyn as dyn
    m = dyn.load("go2.urdf", base="floating")
    d = m.data()
    tau = d.rnea(q, v, a)
    d.M, d.step(1e-3), d.q

SI units, radians, right-handed frames. 6D vectors are [linear; angular], quaternions (x, y, z, w). A floating base has
q = [position; quaternion] and v = [linear; angular] in the body's frame. A Model is what a robot is and may be shared by
threads; a Data is what it is doing, one for each thread. Every call releases the GIL. Errors are dyn.Error.
"""

try:
    import numpy as _numpy
except ModuleNotFoundError:
    raise ImportError("dyn needs numpy: pip install numpy") from None
del _numpy

from . import accuracy, batch, constraint, ik
from .actuator import Actuator
from .arrays import Placement
from .batch import ALGORITHMS, Algorithm, Batch, Rollout
from .builder import Builder
from .centroidal import Centroidal, CentroidalDerivatives
from .collision import Distance, geometry_distance
from .contact import (
    BroadPhase,
    ClosestPoint,
    Contact,
    Impact,
    RayHit,
    Rays,
    SmoothDistances,
    geometry_closest_point,
    geometry_contacts,
    geometry_ray,
    geometry_sweep,
)
from .contact_solver import (
    ConeQp,
    ContactReport,
    ContactSolution,
    ContactSolver,
    contact_compliance,
    contact_compliance_hertz,
    contact_solve,
    contact_problem_qp,
)
from .convert import State, StateLayout
from .data import Data
from .derivatives import ForwardDerivatives, InverseDerivatives, SecondOrderDerivatives, SecondOrderProduct
from .describe import DisabledPair, FrameInfo, JointInfo, Pair, ReportEntry, ShapeInfo
from .dynamics import Energy
from .enums import (
    ActuatorType,
    Angle,
    Base,
    ConstraintReason,
    ConstraintType,
    ContactSolverType,
    ContactStatus,
    Convention,
    Direction,
    DistanceMethod,
    DistanceStatus,
    Effect,
    Format,
    FrameType,
    IkReason,
    IkTaskType,
    Integrator,
    JointType,
    MeshUse,
    ModelArray,
    PairReason,
    Part,
    Reference,
    ReportLevel,
    RowVerdict,
    SensorType,
    ShapeRole,
    ShapeType,
    Status,
    SweepStatus,
    Term,
)
from .errors import (
    ArgumentError,
    BaseChoiceError,
    BusyError,
    CancelledError,
    Error,
    FileError,
    HandleError,
    InternalError,
    InvalidRobotError,
    LibraryError,
    LimitError,
    LoadError,
    ModelError,
    NonFiniteError,
    NumericError,
    OutOfMemoryError,
    ParseError,
    PartError,
    QuaternionError,
    SizeError,
    StaleError,
    StrictError,
    UnknownNameError,
    UnsupportedError,
)
from .fields import FIELDS, FieldInfo
from .inertia import (
    body_regressor,
    is_physically_consistent,
    log_cholesky_from_parameters,
    log_cholesky_jacobian,
    parameters_from_log_cholesky,
    parameters_from_pseudo_inertia,
    pseudo_inertia_from_parameters,
)
from .kinematics import CenterOfMassVelocityDerivatives, FrameAccelerationDerivatives, FrameVelocityDerivatives
from .library import build_info, last_error
from .library import path as library_path
from .library import version as __version__
from .loading import from_buffer, load, load_string
from .material import Material
from .mesh import Mesh, MeshInfo, load_mesh
from .model import Model
from .simulate import Simulation, Trajectory
from .simulation import ContactForce, ErrorLedger, StepReport

LOCAL, WORLD, LOCAL_WORLD_ALIGNED = Reference

__all__ = [
    "Actuator",
    "ActuatorType",
    "ALGORITHMS",
    "FIELDS",
    "LOCAL",
    "LOCAL_WORLD_ALIGNED",
    "WORLD",
    "Algorithm",
    "Angle",
    "ArgumentError",
    "Base",
    "BaseChoiceError",
    "Batch",
    "BroadPhase",
    "Builder",
    "BusyError",
    "CancelledError",
    "CenterOfMassVelocityDerivatives",
    "Centroidal",
    "CentroidalDerivatives",
    "ClosestPoint",
    "ConeQp",
    "ConstraintReason",
    "ConstraintType",
    "Contact",
    "ContactReport",
    "ContactSolution",
    "ContactSolver",
    "ContactSolverType",
    "ContactStatus",
    "Convention",
    "Data",
    "Direction",
    "DisabledPair",
    "Distance",
    "DistanceMethod",
    "DistanceStatus",
    "Effect",
    "Energy",
    "Error",
    "FieldInfo",
    "FileError",
    "ForwardDerivatives",
    "FrameAccelerationDerivatives",
    "FrameInfo",
    "Format",
    "FrameType",
    "FrameVelocityDerivatives",
    "HandleError",
    "IkReason",
    "IkTaskType",
    "Impact",
    "Integrator",
    "InternalError",
    "InvalidRobotError",
    "InverseDerivatives",
    "JointInfo",
    "JointType",
    "LibraryError",
    "LimitError",
    "LoadError",
    "Material",
    "Mesh",
    "MeshInfo",
    "MeshUse",
    "Model",
    "ModelArray",
    "ModelError",
    "NonFiniteError",
    "NumericError",
    "OutOfMemoryError",
    "Pair",
    "PairReason",
    "ParseError",
    "Part",
    "PartError",
    "Placement",
    "QuaternionError",
    "RayHit",
    "Rays",
    "Reference",
    "ReportEntry",
    "ReportLevel",
    "Rollout",
    "RowVerdict",
    "SecondOrderDerivatives",
    "SecondOrderProduct",
    "SensorType",
    "ShapeInfo",
    "ShapeRole",
    "ShapeType",
    "Simulation",
    "SizeError",
    "SmoothDistances",
    "StaleError",
    "State",
    "StateLayout",
    "ErrorLedger",
    "StepReport",
    "Status",
    "StrictError",
    "SweepStatus",
    "Term",
    "Trajectory",
    "UnknownNameError",
    "UnsupportedError",
    "accuracy",
    "batch",
    "body_regressor",
    "build_info",
    "constraint",
    "contact_compliance",
    "contact_compliance_hertz",
    "contact_solve",
    "contact_problem_qp",
    "from_buffer",
    "ik",
    "is_physically_consistent",
    "last_error",
    "library_path",
    "load",
    "load_mesh",
    "load_string",
    "log_cholesky_from_parameters",
    "log_cholesky_jacobian",
    "parameters_from_log_cholesky",
    "parameters_from_pseudo_inertia",
    "pseudo_inertia_from_parameters",
    "geometry_closest_point",
    "geometry_contacts",
    "geometry_ray",
    "geometry_sweep",
]  # fmt: skip
