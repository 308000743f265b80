"""dyn.h in ctypes: the structures and the signature of every function, by group. Pointers to numbers are plain addresses."""

from __future__ import annotations

from . import batch, builder, collision, constraint, contact_solver, data, ik, mesh, model, simulation
from .batch import PROGRESS, BatchArrays, AlgorithmInfo, Rollout
from .builder import JointSpec, ShapeSpec
from .collision import ClosestPoint, Contact, Distance, DistanceOptions, Geometry, Impact, RayHit
from .common import MAJOR, Array, Grown, Material
from .constraint import Constraint, ConstraintDerivatives, ConstraintOptions, ConstraintReport, ConstraintResult, ProjectOptions, RowReport
from .contact_solver import ContactOptions, ContactProblem, ContactReport, Qp
from .data import EffectInfo, FieldInfo
from .ik import IkOptions, IkResult, IkTask
from .mesh import MeshArrays, MeshInfo, MeshOptions
from .model import SAVE_REPORT, FrameInfo, JointInfo, LoadOptions, ReportEntry, ShapeInfo, StateLayout
from .simulation import Actuator, ContactForce, ErrorLedger, StepOptions, StepReport

# name: (result, arguments)
SIGNATURES: dict[str, tuple] = {}
for _group in (model, builder, mesh, data, constraint, ik, collision, contact_solver, simulation, batch):
    SIGNATURES.update(_group.SIGNATURES)
