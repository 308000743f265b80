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
    raise ImportError("libdyn needs numpy: pip install numpy") from None
del _numpy

from . import accuracy, batch, constraint, enums, ik, spatial
from .actuator import Actuator, DcMotor, ForceLimit, Muscle
from .batch import Batch, Rollout
from .builder import Builder, Parameter
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
    contact_problem_qp,
    contact_solve,
)
from .convert import State, StateLayout
from .data import Data
from .describe import DisabledPair, FrameInfo, JointInfo, Pair, ReportEntry, ShapeInfo
from .descriptions import load_description
from .enums import *
from .enums import Reference
from .errors import (
    ArgumentError,
    BaseChoiceError,
    BusyError,
    CancelledError,
    ContactWarning,
    Error,
    FileError,
    HandleError,
    InternalError,
    InvalidRobotError,
    LibraryError,
    LimitError,
    LoadError,
    LoadWarning,
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
from .evaluation import Centroidal
from .files import models
from .gradient import RolloutGradient, rollout_vjp
from .inertia import (
    body_regressor,
    is_physically_consistent,
    log_cholesky_from_parameters,
    log_cholesky_jacobian,
    parameters_from_log_cholesky,
    parameters_from_pseudo_inertia,
    pseudo_inertia_from_parameters,
)
from .library import build_info, last_error
from .library import path as library_path
from .library import version as __version__
from .live import Viewer
from .loading import load, load_string
from .material import Material
from .mesh import Mesh, MeshInfo, load_mesh
from .model import Model
from .picture import Camera, Renderer, write_png
from .placement import Placement
from .planner import Plan, PlanCost, Planner, PlanPoint
from .recording import Recording
from .simulate import Simulation, Trajectory
from .sensor import Sensor
from .simulation import ContactForce, ErrorBar, ErrorLedger, StepReport
from .tables import ALGORITHMS, FIELDS, AlgorithmInfo, FieldInfo
from .tendon import Tendon, TendonElement, TendonPath
from .variation import vary, with_inertial_parameters
from .viewing import view

LOCAL, WORLD, LOCAL_WORLD_ALIGNED = Reference

__all__ = [
    "ALGORITHMS", "Actuator", "AlgorithmInfo", "ArgumentError", "BaseChoiceError", "Batch", "BroadPhase", "Builder", "BusyError",
    "Camera", "CancelledError", "Centroidal", "ClosestPoint", "ConeQp", "Contact", "ContactForce", "ContactReport", "ContactSolution",
    "ContactSolver", "ContactWarning",
    "Data", "DcMotor", "DisabledPair", "Distance", "Error", "ErrorBar", "ErrorLedger", "FIELDS", "FieldInfo", "FileError", "ForceLimit", "FrameInfo",
    "HandleError", "Impact", "InternalError", "InvalidRobotError", "JointInfo", "LOCAL", "LOCAL_WORLD_ALIGNED", "LibraryError",
    "LimitError", "LoadError", "LoadWarning", "Material", "Mesh", "MeshInfo", "Model", "ModelError", "Muscle",
    "NonFiniteError", "NumericError", "OutOfMemoryError", "Pair", "Parameter", "ParseError", "PartError", "Placement",
    "Plan", "PlanCost", "PlanPoint", "Planner", "QuaternionError",
    "RayHit", "Rays", "Recording", "Renderer", "ReportEntry", "Rollout", "RolloutGradient", "Sensor", "ShapeInfo", "Simulation", "SizeError", "SmoothDistances", "StaleError", "State",
    "StateLayout", "StepReport", "StrictError", "Tendon", "TendonElement", "TendonPath", "Trajectory", "UnknownNameError",
    "UnsupportedError", "Viewer", "WORLD", "accuracy", "batch",
    "body_regressor", "build_info", "constraint", "contact_compliance", "contact_compliance_hertz", "contact_problem_qp",
    "contact_solve", "geometry_closest_point", "geometry_contacts", "geometry_distance", "geometry_ray", "geometry_sweep", "ik",
    "is_physically_consistent", "last_error", "library_path", "load", "load_description", "load_mesh", "load_string", "log_cholesky_from_parameters",
    "log_cholesky_jacobian", "models", "parameters_from_log_cholesky", "parameters_from_pseudo_inertia",
    "pseudo_inertia_from_parameters", "rollout_vjp", "spatial", "vary", "view", "with_inertial_parameters", "write_png",
]  # fmt: skip
__all__ += enums.__all__
