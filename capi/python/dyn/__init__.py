"""Rigid-body dynamics.

    import dyn
    m = dyn.load("go2.urdf", base="floating")
    d = m.data()
    tau = d.rnea(q, v, a)
    d.M, d.step(1e-3), d.q

SI units, radians, right-handed frames. 6D vectors are [linear; angular], quaternions (x, y, z, w). A floating base has
q = [position; quaternion] and v = [linear; angular] in the body's frame. A Model is what a robot is and may be shared by
threads; a Data is what it is doing, one for each thread. Every call releases the GIL. Errors are dyn.Error.
"""

from . import ik
from .arrays import Placement
from .batch import ALGORITHMS, Algorithm, Batch
from .builder import Builder
from .convert import State, StateLayout
from .data import (
    FIELDS,
    CenterOfMassVelocityDerivatives,
    Centroidal,
    CentroidalDerivatives,
    Data,
    Energy,
    FieldInfo,
    ForwardDerivatives,
    FrameAccelerationDerivatives,
    FrameVelocityDerivatives,
    InverseDerivatives,
    SecondOrderDerivatives,
    SecondOrderProduct,
)
from .enums import (
    Angle,
    Base,
    Convention,
    Direction,
    Effect,
    FrameType,
    IkReason,
    IkTaskType,
    Integrator,
    JointType,
    ModelArray,
    Part,
    Reference,
    ReportLevel,
    ShapeRole,
    ShapeType,
    Status,
    Term,
)
from .errors import (
    ArgumentError,
    BaseChoiceError,
    BusyError,
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
from .mesh import Mesh, MeshInfo, load_mesh
from .model import DisabledPair, FrameInfo, JointInfo, Model, ReportEntry, ShapeInfo, load, load_string

LOCAL, WORLD, LOCAL_WORLD_ALIGNED = Reference

__all__ = [
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
    "Builder",
    "BusyError",
    "CenterOfMassVelocityDerivatives",
    "Centroidal",
    "CentroidalDerivatives",
    "Convention",
    "Data",
    "Direction",
    "DisabledPair",
    "Effect",
    "Energy",
    "Error",
    "FieldInfo",
    "FileError",
    "ForwardDerivatives",
    "FrameAccelerationDerivatives",
    "FrameInfo",
    "FrameType",
    "FrameVelocityDerivatives",
    "HandleError",
    "IkReason",
    "IkTaskType",
    "Integrator",
    "InternalError",
    "InvalidRobotError",
    "InverseDerivatives",
    "JointInfo",
    "JointType",
    "LibraryError",
    "LimitError",
    "LoadError",
    "Mesh",
    "MeshInfo",
    "Model",
    "ModelArray",
    "ModelError",
    "NonFiniteError",
    "NumericError",
    "OutOfMemoryError",
    "ParseError",
    "Part",
    "PartError",
    "Placement",
    "QuaternionError",
    "Reference",
    "ReportEntry",
    "ReportLevel",
    "SecondOrderDerivatives",
    "SecondOrderProduct",
    "ShapeInfo",
    "ShapeRole",
    "ShapeType",
    "SizeError",
    "StaleError",
    "State",
    "StateLayout",
    "Status",
    "StrictError",
    "Term",
    "UnknownNameError",
    "UnsupportedError",
    "body_regressor",
    "build_info",
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
]  # fmt: skip
