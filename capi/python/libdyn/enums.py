"""The enumerations of dyn.h. Wherever one is expected, a member, its name in either case, or its number is accepted."""

from __future__ import annotations

import enum


class Status(enum.IntEnum):
    """What a call answered."""

    OK = 0
    ERROR_ARGUMENT = 1
    ERROR_HANDLE = 2
    ERROR_MODEL = 3
    ERROR_SIZE = 4
    ERROR_NONFINITE = 5
    ERROR_QUATERNION = 6
    ERROR_STALE = 7
    ERROR_PART = 8
    ERROR_NAME = 9
    ERROR_FILE = 10
    ERROR_PARSE = 11
    ERROR_INVALID = 12
    ERROR_BASE = 13
    ERROR_STRICT = 14
    ERROR_NUMERIC = 15
    ERROR_BUSY = 16
    ERROR_MEMORY = 17
    ERROR_LIMIT = 18
    ERROR_UNSUPPORTED = 19
    ERROR_INTERNAL = 20
    ERROR_CANCELLED = 21


class Reference(enum.IntEnum):
    """Axes and point of a frame's velocity, acceleration or Jacobian."""

    LOCAL = 0
    """Axes and origin of the frame."""
    WORLD = 1
    """Axes of the world; the point that coincides with the world's origin."""
    LOCAL_WORLD_ALIGNED = 2
    """The frame's origin, axes of the world."""


class JointType(enum.IntEnum):
    FIXED = 0
    REVOLUTE = 1
    CONTINUOUS = 2
    PRISMATIC = 3
    HELICAL = 4
    CYLINDRICAL = 5
    UNIVERSAL = 6
    SPHERICAL = 7
    SPHERICAL_ZYX = 8
    PLANAR = 9
    TRANSLATION = 10
    FREE_FLYER = 11
    COMPOSITE = 12
    REVOLUTE_UNBOUNDED = 13


class FrameType(enum.IntFlag):
    OP_FRAME = 1
    JOINT = 2
    FIXED_JOINT = 4
    BODY = 8
    SENSOR = 16


class Format(enum.IntEnum):
    """What models are saved as."""

    URDF = 1
    MJCF = 2
    DYNB = 3


class ReportLevel(enum.IntEnum):
    INFO = 0
    WARNING = 1


class Base(enum.IntEnum):
    """What holds the root link of a URDF."""

    UNSPECIFIED = 0
    FIXED = 1
    FLOATING = 2


class ShapeType(enum.IntEnum):
    BOX = 1
    SPHERE = 2
    CYLINDER = 3
    MESH = 4
    CAPSULE = 5
    CONE = 6
    ELLIPSOID = 7
    HALF_SPACE = 8
    CONVEX = 9
    TRIANGLES = 10
    HEIGHT_FIELD = 11


class MeshUse(enum.IntEnum):
    """What stands for the collision meshes of a robot file."""

    NONE = 0
    HULL = 1
    TRIANGLES = 2


class ConstraintType(enum.IntEnum):
    """What a constraint ties together; NONE: an empty slot."""

    NONE = 0
    POINT = 1
    FRAME = 2
    CONNECT = 3
    WELD = 4
    DISTANCE = 5
    LOOP = 6
    COUPLING = 7
    LIMIT = 8
    FRICTION = 9


class ConstraintReason(enum.IntEnum):
    """How a problem with constraints ended."""

    CONVERGED = 0
    CONTRADICTORY = 1
    MAX_ITERATIONS = 2


class RowVerdict(enum.IntEnum):
    """What the doctor says of a row."""

    INDEPENDENT = 0
    REDUNDANT = 1
    CONTRADICTORY = 2
    IMMOBILE = 3


class DistanceStatus(enum.IntEnum):
    """What stands between two shapes."""

    SEPARATED = 0
    TOUCHING = 1
    PENETRATING = 2
    FAILED = 3


class DistanceMethod(enum.IntEnum):
    """What finds it."""

    GJK = 0
    CCD = 1


class PairReason(enum.IntEnum):
    """Whether a pair of collision shapes is tested."""

    TESTED = 0
    OVERLAPS = 1
    MESH = 2
    OFF = 3
    DISABLED = 4
    MASK = 5


class SweepStatus(enum.IntEnum):
    """What a swept test found."""

    NONE = 0
    HIT = 1
    UNDECIDED = 2


class ShapeRole(enum.IntEnum):
    COLLISION = 1
    VISUAL = 2


class Convention(enum.IntEnum):
    """Whose state: see dyn.StateLayout."""

    DYN = 0
    PINOCCHIO = 1
    MUJOCO = 2
    DRAKE = 3
    ROS = 4


class Angle(enum.IntEnum):
    """How a peer stores continuous joints."""

    BY_CONVENTION = 0
    PLAIN = 1
    COS_SIN = 2


class Direction(enum.IntEnum):
    TO_PEER = 0
    FROM_PEER = 1


class ModelArray(enum.IntEnum):
    LOWER_LIMIT = 0
    UPPER_LIMIT = 1
    VELOCITY_LIMIT = 2
    EFFORT_LIMIT = 3
    ARMATURE = 4
    DAMPING = 5
    FRICTION = 6
    GRAVITY = 7
    STIFFNESS = 8
    SPRING_REFERENCE = 9


class Effect(enum.IntFlag):
    """What joints do beside moving bodies: see Data.set_effects."""

    ARMATURE = 1
    DAMPING = 2
    SPRINGS = 4
    FRICTION = 8
    LIMITS = 16
    ACTUATORS = 32
    FLUID = 64
    GRAVITY_COMPENSATION = 128
    SLEEPING = 256
    DEFAULT = 0xF1
    ALL = 0x1FF


class ActuatorType(enum.IntEnum):
    """What an actuator's controls are: see dyn.Actuator."""

    MOTOR = 0
    POSITION = 1
    VELOCITY = 2
    PD = 3
    AFFINE = 4


class Part(enum.IntFlag):
    """Groups of buffers of a data."""

    KINEMATICS = 1 << 0
    JACOBIANS = 1 << 1
    COM = 1 << 2
    INVERSE = 1 << 3
    FORWARD = 1 << 4
    MASS = 1 << 5
    CHOLESKY = 1 << 6
    MINV = 1 << 7
    CORIOLIS = 1 << 8
    ENERGY = 1 << 9
    FRAMES = 1 << 10
    CENTROIDAL = 1 << 11
    INVERSE_DERIVATIVES = 1 << 12
    FORWARD_DERIVATIVES = 1 << 13
    REGRESSOR = 1 << 14
    IK = 1 << 15
    SECOND_ORDER = 1 << 16
    COLLISION = 1 << 17
    CONSTRAINTS = 1 << 18
    CONSTRAINT_DERIVATIVES = 1 << 19
    SIMULATION = 1 << 20
    ALL = 0x1FFFFF


class Term(enum.IntFlag):
    """What all_terms computes."""

    KINEMATICS = 1 << 0
    FRAMES = 1 << 1
    JACOBIANS = 1 << 2
    JACOBIANS_TIME_VARIATION = 1 << 3
    COM = 1 << 4
    JCOM = 1 << 5
    NLE = 1 << 6
    GRAVITY_TORQUE = 1 << 7
    MASS = 1 << 8
    CHOLESKY = 1 << 9
    MINV = 1 << 10
    CORIOLIS = 1 << 11
    ENERGY = 1 << 12
    ALL = 0x1FFF


class Integrator(enum.IntEnum):
    SEMI_IMPLICIT_EULER = 0
    RK4 = 1
    IMPLICIT_FAST = 2
    IMPLICIT_MIDPOINT = 3
    RK45 = 4
    REFERENCE = 5


class IkTaskType(enum.IntEnum):
    """What a task of inverse kinematics is about."""

    POSE = 1
    POSITION = 2
    ORIENTATION = 3
    COM = 4
    POSTURE = 5


class IkReason(enum.IntEnum):
    """Why inverse kinematics ended."""

    CONVERGED = 0
    LIMITS = 1
    SINGULAR = 2
    LOCAL_MINIMUM = 3
    MAX_ITERATIONS = 4


class ContactSolverType(enum.IntEnum):
    PGS = 0
    ADMM = 1
    NEWTON = 2


class ContactStatus(enum.IntEnum):
    """Why a contact solver ended."""

    CONVERGED = 0
    MAX_ITERATIONS = 1
    TIME_BUDGET = 2
    STALLED = 3


class SensorType(enum.IntEnum):
    """What a rollout records beside states."""

    PLACEMENT = 0
    """Of a frame: position in the world, m, and quaternion (x, y, z, w): 7."""
    VELOCITY = 1
    """Of a frame: [linear; angular], m/s and rad/s, its axes: 6."""
    IMU = 2
    """In a frame's axes: acceleration of its origin, mean over the last step, less gravity, m/s^2; angular velocity, rad/s: 6."""
    FORCE = 3
    """On a link: [force; moment] of all contacts, mean over the last step, N and N m, axes of the world, about its origin: 6."""
    COM = 4
    """Centre of mass and its velocity, m and m/s, world: 6."""
    ENERGY = 5
    """Kinetic and potential, J: 2."""
