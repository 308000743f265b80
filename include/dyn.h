/* libdyn: rigid-body dynamics. The whole public interface, C99.
 *
 * Conventions, said once for every function below
 *   Units       SI: metres, kilograms, seconds, newtons, radians. Frames are right-handed.
 *   6D vectors  [linear; angular].
 *   Quaternions (x, y, z, w). The norm is divided out: every finite quaternion but zero is an exact rotation.
 *   Matrices    Column-major and dense. "6 x nv" puts element (r, c) at r + 6 c. Symmetric matrices are full.
 *   Placements  12 doubles: rotation (3 x 3, column-major), then translation (3). X_WF maps F to the world.
 *   q, v        q has nq numbers; v, a and tau have nv. nq and nv differ on manifolds. Use dyn_integrate and
 *               dyn_difference there. A free flyer has q = [position; quaternion] and v = [linear; angular],
 *               v in the axes of its body.
 *   References  DYN_REFERENCE_LOCAL: axes and origin of the frame.
 *               DYN_REFERENCE_WORLD: axes of the world, about the world's origin.
 *               DYN_REFERENCE_LOCAL_WORLD_ALIGNED: axes of the world, about the frame's origin.
 *   Inputs      const double*. NULL means the value held in the data. A non-NULL argument replaces it there.
 *               An array without numbers may be NULL (a robot that cannot move).
 *   Outputs     Any output pointer may be NULL: the result is in the data as well.
 *               An output is written whole, or not at all. A function of many outputs takes their pointers
 *               in a structure, `out`. `out` may be NULL, like its pointers, unless it is called required.
 *   Errors      Every function that can fail returns a dynStatus. dyn_last_error() tells what is wrong,
 *               where, and what to do. A failed call leaves its data unchanged. DYN_ERROR_NUMERIC comes
 *               after some work: the state (q, v, a, tau, time) is unchanged, but results may be lost.
 *               Reading a lost result returns DYN_ERROR_STALE, never another number.
 *   Structures  Those that begin with struct_size may grow at their end in later versions. dyn_..._init(&x)
 *               sets struct_size and the defaults. A structure without an init is a result: set its
 *               struct_size to sizeof x before the call.
 *               A shorter structure comes from an older dyn.h: its missing fields have their defaults.
 *               A longer one comes from a newer dyn.h: bytes that the library does not know must be zero, or
 *               the call is refused (DYN_ERROR_ARGUMENT). Results are written within struct_size. Bytes of
 *               them that the library does not know become zero.
 *               dyn_..._init is a macro. It passes sizeof x as second argument to the function of the same
 *               name. Foreign-function interfaces (ctypes, LuaJIT, Rust) call that function themselves, with
 *               the size of their own declaration.
 *   Threads     A model is immutable and may be shared. A data belongs to one thread at a time.
 *   Memory      After dyn_data_new or dyn_data_init nothing allocates, locks, or makes a system call.
 *   Arithmetic  Calls round to nearest, keep subnormal numbers, and do not trap, whatever the caller has
 *               set. On x86-64 and aarch64 the caller's settings are as before afterwards.
 *
 * Names
 *   dyn_<object>_<property or verb>   Functions of an object: dyn_model_nq, dyn_data_set_state. A noun reads.
 *                                     set_, add_ and other verbs write. _info fills a description.
 *   dyn_<algorithm>                   Algorithms, named as in Pinocchio: dyn_rnea, dyn_aba, dyn_nle, dyn_com.
 *   DYN_<TYPE>_<MEMBER>               Values, with their type's whole name: DYN_JOINT_TYPE_FREE_FLYER.
 *   dyn<Type>                         Types: dynModel, dynJointInfo.
 *   Quantities have Pinocchio's names: q v a tau fext M Minv nle g com Jcom J dJ Ag hg Ig ddq_dq.
 */
#ifndef DYN_H
#define DYN_H

#include <stddef.h>
#include <stdint.h>

#if defined(DYN_STATIC)
#define DYN_API
#elif defined(_WIN32)
#define DYN_API __declspec(dllimport)
#else
#define DYN_API __attribute__((visibility("default")))
#endif

/* A program for a board without an operating system defines DYN_BARE. Functions that need a heap, files or
   threads are then not declared, and the library for boards does not have them. */

#define DYN_VERSION_MAJOR 1
#define DYN_VERSION_MINOR 0
#define DYN_VERSION_PATCH 0

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------- status and version */

/* Values are never renumbered. New values are appended. */
typedef enum dynStatus {
  DYN_OK = 0,                 /* The call succeeded. */
  DYN_ERROR_ARGUMENT = 1,     /* A required value is NULL, or an index or option is out of range. */
  DYN_ERROR_HANDLE = 2,       /* The handle is NULL, freed or foreign. */
  DYN_ERROR_MODEL = 3,        /* The data belongs to another model. */
  DYN_ERROR_SIZE = 4,         /* An array or memory block has the wrong size. */
  DYN_ERROR_NONFINITE = 5, /* An input holds NaN or infinity: the message names the argument and the index. */
  DYN_ERROR_QUATERNION = 6,   /* A quaternion or (cos, sin) pair is zero. */
  DYN_ERROR_STALE = 7, /* The result is not of the current state: the message names the call to make. */
  DYN_ERROR_PART = 8,         /* The data was created without the part that the message names. */
  DYN_ERROR_NAME = 9,         /* The name is unknown or a duplicate. */
  DYN_ERROR_FILE = 10,        /* The file is missing, or cannot be read or written. */
  DYN_ERROR_PARSE = 11,       /* The XML is malformed, or a number cannot be read. */
  /* The robot cannot exist: negative mass, impossible inertia, cycle, two roots, zero axis. */
  DYN_ERROR_INVALID = 12,
  DYN_ERROR_BASE = 13,        /* The root link has mass, and neither fixed nor floating was chosen. */
  DYN_ERROR_STRICT = 14,      /* The file has physics that libdyn would drop, and strict was asked for. */
  DYN_ERROR_NUMERIC = 15,     /* A matrix is singular or a result overflows: the message names the joint. */
  DYN_ERROR_BUSY = 16,        /* Two threads use one data at once (found by checked builds). */
  DYN_ERROR_MEMORY = 17,      /* Memory ran out. */
  DYN_ERROR_LIMIT = 18, /* The problem is larger than this library allows: the message gives the limit. */
  DYN_ERROR_UNSUPPORTED = 19, /* This build or machine cannot do the task: a module may be missing. */
  DYN_ERROR_INTERNAL = 20,    /* The library has a defect: please report it. */
  DYN_ERROR_CANCELLED = 21    /* The caller's progress function cancelled the call. */
} dynStatus;

/* Returns "DYN_OK", "DYN_ERROR_STALE", ...; never NULL. */
DYN_API const char* dyn_status_name(dynStatus status);
/* Returns the calling thread's last error, one sentence: what is wrong, where, and what to do. Returns ""
   before the first error, never NULL. The text is valid until the thread's next failing call. */
DYN_API const char* dyn_last_error(void);
/* Returns "1.0.0". */
DYN_API const char* dyn_version(void);
/* Returns one line: instruction set, compiler, and whether this is a checked build. On x86-64 the library may
   carry several levels of instructions. It uses the best one that the processor runs, or the one that the
   environment variable DYN_LEVEL names: plain, x86-64-v3 or x86-64-v4. */
DYN_API const char* dyn_build_info(void);

/* -------------------------------------------------------------------------------------------- basic types */

typedef struct dynModel dynModel;     /* the robot and scene: immutable, shared by threads */
typedef struct dynData dynData;       /* the state and every buffer: one per thread */
typedef struct dynBuilder dynBuilder; /* makes a model */
typedef struct dynMesh dynMesh;       /* triangles: see meshes below */

/* Axes and point that a velocity, an acceleration, a Jacobian or a wrench refers to. */
typedef enum dynReference {
  DYN_REFERENCE_LOCAL = 0,              /* Axes and origin of the frame. */
  DYN_REFERENCE_WORLD = 1,              /* Axes of the world, about the world's origin. */
  DYN_REFERENCE_LOCAL_WORLD_ALIGNED = 2 /* Axes of the world, about the frame's origin. */
} dynReference;

/* Axes and sizes belong to each type. q = 0 (for quaternions the identity) is the placement given at the
   joint. */
typedef enum dynJointType {
  /* nq 0, nv 0: no joint of the model but a frame of type DYN_FRAME_TYPE_FIXED_JOINT. */
  DYN_JOINT_TYPE_FIXED = 0,
  DYN_JOINT_TYPE_REVOLUTE = 1,           /* nq 1, nv 1: angle about axis. */
  DYN_JOINT_TYPE_CONTINUOUS = 2, /* nq 1, nv 1: any angle about axis; differences are wrapped to (-pi, pi]. */
  DYN_JOINT_TYPE_PRISMATIC = 3,          /* nq 1, nv 1: displacement along axis. */
  DYN_JOINT_TYPE_HELICAL = 4, /* nq 1, nv 1: angle about axis; pitch (m/rad) moves the body along it. */
  DYN_JOINT_TYPE_CYLINDRICAL = 5,        /* nq 2, nv 2: (angle about axis, displacement along it). */
  DYN_JOINT_TYPE_UNIVERSAL = 6,          /* nq 2, nv 2: angle about axis, then about axis2. */
  DYN_JOINT_TYPE_SPHERICAL = 7, /* nq 4, nv 3: quaternion; v is the angular velocity in the child's frame. */
  DYN_JOINT_TYPE_SPHERICAL_ZYX = 8,      /* nq 3, nv 3: angles about z, then y, then x; v are their rates. */
  /* nq 3, nv 3: (x, y, angle): translation normal to axis, then rotation about it. */
  DYN_JOINT_TYPE_PLANAR = 9,
  DYN_JOINT_TYPE_TRANSLATION = 10,       /* nq 3, nv 3: (x, y, z) in the parent's joint frame. */
  DYN_JOINT_TYPE_FREE_FLYER = 11,        /* nq 7, nv 6: [position; quaternion]; v in the child's frame. */
  DYN_JOINT_TYPE_COMPOSITE = 12,         /* A chain of joints in one: nq and nv are the sums. */
  DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED = 13 /* nq 2, nv 1: (cos, sin) of the angle about axis. */
} dynJointType;

/* Kind of a frame. */
typedef enum dynFrameType {
  DYN_FRAME_TYPE_OP_FRAME = 1,    /* A frame added by the user. */
  DYN_FRAME_TYPE_JOINT = 2,       /* A joint's own frame; it moves with the joint's child. */
  DYN_FRAME_TYPE_FIXED_JOINT = 4, /* A fixed joint that was merged. */
  DYN_FRAME_TYPE_BODY = 8,        /* A link. */
  DYN_FRAME_TYPE_SENSOR = 16      /* A sensor. */
} dynFrameType;

/* Severity of a report's line. */
typedef enum dynReportLevel {
  DYN_REPORT_LEVEL_INFO = 0,    /* Worth knowing: nothing is lost. */
  DYN_REPORT_LEVEL_WARNING = 1, /* Worth a look. The model is what the file states. */
  DYN_REPORT_LEVEL_DROPPED = 2 /* Lost: physics of the file, or what a written file lacks. Error if strict. */
} dynReportLevel;

/* A view of numbers. Element (i, j) is data[i * stride[0] + j * stride[1]]; strides count doubles. Vectors
   have cols = 1. */
typedef struct dynArray {
  uint32_t struct_size;
  int32_t rows, cols;
  ptrdiff_t stride[2];
  const double* data;
} dynArray;

/* ------------------------------------------------------------------------------------------------ loading */

#ifndef DYN_BARE
/* How the root link of a robot file is held. */
typedef enum dynBase {
  DYN_BASE_UNSPECIFIED = 0, /* Refused when the root link has mass and the file does not hold it. */
  DYN_BASE_FIXED = 1,       /* The root link is welded to the world. */
  DYN_BASE_FLOATING = 2     /* A free flyer named "root_joint" carries the root link. */
} dynBase;

/* Replacement of the collision meshes of a robot file. Equal meshes are kept once. Hulls and triangles have a
   line each in the load report. HULL and TRIANGLES refuse a mesh that cannot be read. */
typedef enum dynMeshUse {
  /* Names alone: no file is opened, and their pairs are not tested (DYN_PAIR_REASON_MESH). */
  DYN_MESH_USE_NONE = 0,
  /* Convex hulls, shapes of type CONVEX of at most 65,536 vertices; a mesh that is not convex is a warning
     with hull_volume_ratio and hull_depth of dynMeshInfo. */
  DYN_MESH_USE_HULL = 1,
  /* Triangles, shapes of type TRIANGLES; a mesh that encloses nothing is a warning. */
  DYN_MESH_USE_TRIANGLES = 2,
  /* Default: HULL for each mesh that can be read, NONE for each other one. The others are warnings of the
     load report, and an error when strict. */
  DYN_MESH_USE_AUTO = 3
} dynMeshUse;

typedef struct dynLoadOptions {
  uint32_t struct_size;            /* set by dyn_load_options_init */
  dynBase base;
  int32_t strict;                  /* non-zero: lines of level DROPPED are an error */
  int32_t cos_sin; /* non-zero: continuous joints store (cos, sin): DYN_JOINT_TYPE_REVOLUTE_UNBOUNDED */
  const char* const* package_dirs; /* package://NAME/... is DIR/NAME/... or DIR/...; may be NULL */
  size_t package_dirs_count;
  double gravity[3]; /* m/s^2, world axes; default (0, 0, -9.81). An MJCF file's own counts unless changed. */
  const char* srdf;                /* path of an SRDF for this robot; NULL: none */
  dynMeshUse meshes;               /* default AUTO; hulls need libdyn_mesh.so */
  int32_t constraint_slots;        /* spare slots for constraints, 0 to 1000; default 8 */
  /* contact points that a step can hold, 1 to 10^6; default 0: see dyn_builder_set_contact_capacity */
  int32_t contact_capacity;
  /* non-zero: for files that are not trusted. Included files and meshes must lie in the robot file's folder
     (for text in memory: the working directory) or in package_dirs, links followed. Others are
     DYN_ERROR_FILE. Files that are no regular files are refused, too. Default 0. */
  int32_t confined;
  /* Limits of a load, 0: the default. A file that asks for more is DYN_ERROR_LIMIT, before it is expanded. */
  int32_t max_bodies;          /* links, with their copies; joints likewise; default 200,000 */
  int32_t max_shapes;          /* default 200,000 */
  int32_t max_constraint_rows; /* of the file's constraints; default 6,000 */
  int32_t max_keys;            /* named configurations; default 10,000 */
  int64_t max_bytes; /* memory of a load, estimated from sizes of files and of their parts; default 2^30 */
  double max_seconds; /* processor time of a load, looked at between its parts; default: no limit */
} dynLoadOptions;

DYN_API void dyn_load_options_init(dynLoadOptions* options, uint32_t struct_size);
#define dyn_load_options_init(x) dyn_load_options_init(x, sizeof(dynLoadOptions))

/* Reads a robot from a URDF, MJCF or .dynb file: the content decides. Of the options a .dynb takes gravity,
   constraint_slots and contact_capacity alone. options may be NULL (defaults). *model is written only on
   success. Joints come depth first in the file's order. The load report lists everything that was not used.
   Lines about the SRDF begin with the SRDF's name. Unknown names in an SRDF are warnings there, and errors
   under strict.

   MJCF, what is read:
     - bodies, frames, replicas, attached models, included files, classes of defaults;
     - inertials, and masses of geoms by MuJoCo's rules; gravity, gravcomp, the medium, fluidshape, fluidcoef;
     - hinge, slide, ball and free joints, several on a body, with reference, limits, armature, damping, dry
       friction and springs;
     - geoms as shapes (visual when contype and conaffinity are 0), height fields, sites as frames;
     - meshes: STL, OBJ, MSH, vertices in the file;
     - excluded and wanted pairs, with MuJoCo's rule for the others;
     - keys with velocity, controls, activations and time; timestep, integrator, and flags of effects;
     - fixed and spatial tendons, with wrapped spheres and cylinders;
     - affine actuators and muscles of one degree of freedom, tendons and sites;
     - sensors of dynQuantity;
     - connect, weld, joint and tendon equalities (rigid).

   MJCF, how: q is MuJoCo's qpos with quaternions (x, y, z, w). A free joint's velocity is in the body's axes:
   see dynStateLayout. The configuration that the file draws is named "qpos0" unless it is the neutral one.
   New data begins there. Its steps have the file's timestep and the nearest integrator. Keys are named
   configurations: see dyn_data_reset. An actuator that is not supported keeps its place and its control, and
   exerts no force. A joint without a name has its body's name with _joint behind it. A body
   without a name is body_<number in the file>, a tendon tendon_<number>. A geom that a tendon wraps around
   becomes a frame with its name, with _wrap behind it where the name is taken. Other actuators and
   equalities, sensors, flexible bodies and plugins are in the load report, with their lines. base is ignored:
   the file has free joints. srdf is refused. */
DYN_API dynStatus dyn_model_load(const char* path, const dynLoadOptions* options, dynModel** model);
/* Reads the same from zero-terminated text. Relative paths in the text start at the working directory. */
DYN_API dynStatus dyn_model_load_string(const char* text, const dynLoadOptions* options, dynModel** model);
/* NULL is allowed. Later use of data made from the model returns DYN_ERROR_MODEL: no crash. */
DYN_API void dyn_model_free(dynModel* model);

/* The load report: everything in the file that was ignored, replaced, or is worth knowing, in the file's
   order. */
typedef struct dynReportEntry {
  uint32_t struct_size;
  dynReportLevel level;
  int32_t line;        /* 1-based; 0 when no line applies */
  const char* message; /* lives as long as the model */
} dynReportEntry;
/* Returns the number of entries of the load report. */
DYN_API int dyn_model_report_count(const dynModel* model);
/* Writes an entry of the load report. */
DYN_API dynStatus dyn_model_report_entry(const dynModel* model, int index, dynReportEntry* entry);

/* ------------------------------------------------------------------------------------------------- saving */

/* File formats of models. */
typedef enum dynFormat {
  DYN_FORMAT_URDF = 1, /* URDF, extension .urdf. */
  DYN_FORMAT_MJCF = 2, /* MJCF, extensions .xml and .mjcf. */
  /* The compiled model with a checksum, extension .dynb, for builds of the same memory layout. */
  DYN_FORMAT_DYNB = 3
} dynFormat;

/* Called once for each thing that the format cannot hold (DROPPED) or holds in another form (INFO). message
   is one line and valid during the call. */
typedef void (*dynSaveReport)(void* context, dynReportLevel level, const char* message);

typedef struct dynSaveOptions {
  uint32_t struct_size; /* set by dyn_save_options_init */
  int32_t strict;       /* 1: DROPPED is DYN_ERROR_STRICT, and nothing is written; default 0 */
  dynSaveReport report; /* default NULL: nothing is called */
  void* context;        /* passed to report */
} dynSaveOptions;
DYN_API void dyn_save_options_init(dynSaveOptions* options, uint32_t struct_size);
#define dyn_save_options_init(x) dyn_save_options_init(x, sizeof(dynSaveOptions))

/* Writes a model in the format of the path's extension. An existing file is replaced only when the new one is
   complete. options NULL: defaults. Numbers read back as the same doubles. A .dynb names its memory layout:
   x86-64 and 64-bit ARM share one.

   URDF: joints of other types become chains of URDF joints and massless links. Frames become links on fixed
   joints. Constraints go into a <libdyn> block. The base is again an option of loading.

   MJCF: it holds the joints of a body, frames as sites, actuators, constraints, pairs and keys. Mimic joints
   become equalities, which are no reduction: they are among the losses. The report lists all losses. */
DYN_API dynStatus dyn_model_save(const dynModel* model, const char* path, const dynSaveOptions* options);
/* Writes the same into `capacity` bytes of buffer (NULL with 0: none). *size is the size needed. Text does
   not end with a zero. Returns DYN_ERROR_SIZE when the buffer is too small. */
DYN_API dynStatus dyn_model_save_memory(const dynModel* model, dynFormat format,
                                        const dynSaveOptions* options, void* buffer, size_t capacity,
                                        size_t* size);

/* A model without files and heap. An image is the content of a .dynb. `dyn convert` writes it as a C array to
   link into a program. */
enum {
  /* For machines without SIMD, as a Cortex-M: 3-vectors take three numbers, not four. */
  DYN_IMAGE_NARROW = 1,
  /* No names and no load report: ids are as before, all names are ""; for use in place alone. */
  DYN_IMAGE_NAMELESS = 2
};
/* Writes the image into `capacity` bytes of buffer (NULL with 0: none). flags: bits of DYN_IMAGE_. *size is
   the size needed. Returns DYN_ERROR_SIZE when the buffer is too small. */
DYN_API dynStatus dyn_model_image(const dynModel* model, uint32_t flags, void* buffer, size_t capacity,
                                  size_t* size);
#endif
/* Opens the model in a buffer (flash, a mapped file, shared memory) in place: no copy, no allocation. The
   buffer is aligned to 64 bytes. It must not change or go away while the model is in use. dyn_model_free
   leaves it alone. Checksum, layout, and every size, offset, index, type and number are checked first.
   Buffers with equal content have the same model id, so their data are interchangeable. */
DYN_API dynStatus dyn_model_from_buffer(const void* buffer, size_t size, const dynModel** model);

/* ---------------------------------------------------------------------------------------------- the model */

/* Sizes; -1 for an invalid handle (see dyn_last_error). */
DYN_API int dyn_model_nq(const dynModel* model);
DYN_API int dyn_model_nv(const dynModel* model);
DYN_API int dyn_model_njoints(const dynModel* model); /* joints that move, plus the universe (joint 0) */
DYN_API int dyn_model_nframes(const dynModel* model); /* frame 0 is the universe */
DYN_API int dyn_model_nbodies(const dynModel* model); /* links, without the universe */
/* bytes of the compiled model; 0 for an invalid handle */
DYN_API size_t dyn_model_size(const dynModel* model);

/* Names and ids. An id is an index. An unknown name returns -1, and the error lists similar names. */
DYN_API const char* dyn_model_name(const dynModel* model); /* NULL for an invalid handle */
DYN_API const char* dyn_model_joint_name(const dynModel* model, int joint); /* NULL when out of range */
DYN_API const char* dyn_model_frame_name(const dynModel* model, int frame);
/* Returns the id of a joint by name, or -1. */
DYN_API int dyn_model_joint_id(const dynModel* model, const char* name);
/* Several frames may share a name (a link and a joint). Joints and user frames are found before links; use
   dyn_model_frame_id_of_type to choose. */
DYN_API int dyn_model_frame_id(const dynModel* model, const char* name);
/* Returns the id of a frame by name and type, or -1. */
DYN_API int dyn_model_frame_id_of_type(const dynModel* model, const char* name, dynFrameType type);

typedef struct dynJointInfo {
  uint32_t struct_size;
  const char* name;
  dynJointType type;
  int32_t parent;                   /* parent joint; 0 is the universe */
  int32_t idx_q, idx_v;             /* first index in q and v; a follower has its leader's */
  int32_t nq, nv;                   /* a follower has nq = nv = 0 */
  int32_t mimic_leader;             /* the joint that this one follows, or -1 */
  double mimic_ratio, mimic_offset; /* q_follower = ratio * q_leader + offset */
  double axis[3], axis2[3];         /* in the joint's frame */
  double pitch;                     /* helical: metres per radian */
  double placement[12]; /* joint frame in the parent joint's frame, at the neutral configuration */
} dynJointInfo;
/* Describes a joint. */
DYN_API dynStatus dyn_model_joint_info(const dynModel* model, int joint, dynJointInfo* info);

typedef struct dynFrameInfo {
  uint32_t struct_size;
  const char* name;
  dynFrameType type;
  int32_t joint;        /* joint that carries the frame */
  double placement[12]; /* in that joint's frame */
  double mass;          /* kg, of this link or frame alone: merged links keep their own */
  double com[3];        /* m, in the frame */
  double inertia[9];    /* kg m^2, about the centre of mass, frame axes */
} dynFrameInfo;
/* Describes a frame. */
DYN_API dynStatus dyn_model_frame_info(const dynModel* model, int frame, dynFrameInfo* info);

/* Kind of a shape. */
typedef enum dynShapeType {
  DYN_SHAPE_TYPE_BOX = 1,          /* A box; size: full lengths. */
  DYN_SHAPE_TYPE_SPHERE = 2,       /* A sphere; size: radius. */
  DYN_SHAPE_TYPE_CYLINDER = 3,     /* A cylinder along z; size: radius, length. */
  DYN_SHAPE_TYPE_MESH = 4,         /* A mesh of which only the file's name is known; size: scale. */
  DYN_SHAPE_TYPE_CAPSULE = 5, /* A capsule along z; size: radius, length between the centres of its caps. */
  DYN_SHAPE_TYPE_CONE = 6,         /* A cone along z with its apex up; size: radius, length. */
  DYN_SHAPE_TYPE_ELLIPSOID = 7,    /* An ellipsoid; size: semi-axes. */
  DYN_SHAPE_TYPE_HALF_SPACE = 8,   /* All points with z <= 0; size is not used. */
  DYN_SHAPE_TYPE_CONVEX = 9,       /* A convex hull; size: scale, applied already. */
  DYN_SHAPE_TYPE_TRIANGLES = 10,   /* A triangle mesh; size: scale, applied already. */
  DYN_SHAPE_TYPE_HEIGHT_FIELD = 11 /* A height field, solid down to its bottom. */
} dynShapeType;
/* Purpose of a shape. */
typedef enum dynShapeRole {
  DYN_SHAPE_ROLE_COLLISION = 1, /* The shape takes part in collision and contact. */
  DYN_SHAPE_ROLE_VISUAL = 2     /* The shape is drawn and has no effect. */
} dynShapeRole;
/* Contact properties of a shape. A contact takes the larger friction, torsion, rolling, restitution and
   damping of the two shapes. Their springs act in series. The slip velocity is the difference of their
   surface velocities. */
typedef struct dynMaterial {
  double friction;            /* Coulomb's coefficient; default 1 */
  double torsion, rolling; /* m: moment about the normal and across it, per normal force; default 0: none */
  /* 0 .. 1; default 0. It acts in impacts faster than both 0.05 m/s and twice the speed that the step's own
     acceleration makes. */
  double restitution;
  double stiffness;           /* N/m; default 0: rigid */
  double damping;             /* N s/m of a contact with stiffness */
  double surface_velocity[3]; /* m/s, in the shape's frame: a conveyor belt; default 0 */
} dynMaterial;

typedef struct dynShapeInfo {
  uint32_t struct_size;
  const char* name;              /* "" when the file gives none */
  dynShapeType type;
  dynShapeRole role;
  int32_t frame;                 /* BODY frame that carries the shape */
  double placement[12];          /* in that frame */
  double size[3];                /* m, as said at dynShapeType */
  const char* mesh; /* resolved path, also of a shape made from a mesh (dynMeshUse); "" for others */
  double radius;                 /* m, of rounding: points within this distance belong to the shape */
  uint32_t contype, conaffinity; /* bits: own groups, and groups to collide with; see DYN_PAIR_REASON_MASK */
  dynMaterial material;
} dynShapeInfo;
/* Returns the number of shapes, or -1 for an invalid handle. */
DYN_API int dyn_model_nshapes(const dynModel* model);
/* Describes a shape. */
DYN_API dynStatus dyn_model_shape_info(const dynModel* model, int shape, dynShapeInfo* info);
/* Colour for pictures: red, green, blue, opacity, 0 to 1, of 8 bits each. It comes from <material> of a URDF,
   or from rgba of an MJCF (or of its material). All are -1 when the file gives none. */
DYN_API dynStatus dyn_model_shape_rgba(const dynModel* model, int shape, double rgba[4]);
#ifndef DYN_BARE
/* Makes a mesh of a shape of type CONVEX, TRIANGLES or HEIGHT_FIELD, in the shape's frame. Triangles may come
   in another order than in the file. Free it with dyn_mesh_free. */
DYN_API dynStatus dyn_model_shape_mesh(const dynModel* model, int shape, dynMesh** mesh);
#endif

/* Pairs of links that an SRDF excludes from collision tests: <disable_collisions>, and
   <disable_default_collisions> as in MoveIt. frame1 and frame2 are BODY frames. reason is the file's, or "".
   Any output may be NULL. */
DYN_API int dyn_model_ndisabled_pairs(const dynModel* model);
/* Writes a disabled pair. */
DYN_API dynStatus dyn_model_disabled_pair(const dynModel* model, int pair, int* frame1, int* frame2,
                                          const char** reason);

/* Arrays of the model. They live as long as the model. Absent limits are infinite. */
typedef enum dynModelArray {
  DYN_MODEL_ARRAY_LOWER_LIMIT = 0,     /* nq: lower position limits (rad, m); -inf for quaternion parts. */
  DYN_MODEL_ARRAY_UPPER_LIMIT = 1,     /* nq: upper position limits (rad, m); inf for quaternion parts. */
  DYN_MODEL_ARRAY_VELOCITY_LIMIT = 2,  /* nv: velocity limits, rad/s or m/s. */
  DYN_MODEL_ARRAY_EFFORT_LIMIT = 3,    /* nv: effort limits, N m or N. */
  DYN_MODEL_ARRAY_ARMATURE = 4,        /* nv: armature, added to the diagonal of M, kg m^2 or kg. */
  DYN_MODEL_ARRAY_DAMPING = 5,         /* nv: damping, N m s/rad or N s/m; see dyn_data_set_effects. */
  DYN_MODEL_ARRAY_FRICTION = 6,        /* nv: dry friction, N m or N; see dyn_data_set_effects. */
  DYN_MODEL_ARRAY_GRAVITY = 7,         /* 3: gravity, m/s^2, world axes. */
  DYN_MODEL_ARRAY_STIFFNESS = 8,       /* nv: spring stiffness, N m/rad or N/m; see dyn_data_set_effects. */
  DYN_MODEL_ARRAY_SPRING_REFERENCE = 9 /* nq: configuration at which the springs are at rest. */
} dynModelArray;
/* Returns NULL for an invalid handle. */
DYN_API const double* dyn_model_array(const dynModel* model, dynModelArray which);
/* Returns the mass of everything that moves, kg. Links welded to the world do not count, as in com and the
   energies. Returns NaN for an invalid handle. */
DYN_API double dyn_model_total_mass(const dynModel* model);

/* Named configurations. Index 0 is always "neutral". Each <group_state> of an SRDF is one, named
   "group/state" when several groups have a state of that name. Joints that the state omits are neutral. */
DYN_API int dyn_model_nconfigurations(const dynModel* model);
/* Returns the name of a configuration, or NULL when out of range. */
DYN_API const char* dyn_model_configuration_name(const dynModel* model, int index);
/* Writes a configuration by name: q, nq. */
DYN_API dynStatus dyn_model_configuration(const dynModel* model, const char* name, double* q);
/* Returns the index of the configuration where new data begins: "qpos0" of an MJCF file, otherwise 0; -1 for
   an invalid handle. */
DYN_API int dyn_model_initial_configuration(const dynModel* model);

/* Writes the first index in q (and v) of each named joint, in the order of names. Fails on unknown or
   repeated names. */
DYN_API dynStatus dyn_model_q_permutation(const dynModel* model, const char* const* names, size_t count,
                                          int32_t* idx_q, int32_t* idx_v);

/* -------------------------------------------------------------------------------------------- the builder */

#ifndef DYN_BARE
typedef struct dynJointSpec {
  uint32_t struct_size;                        /* set by dyn_joint_spec_init */
  const char* name;
  dynJointType type;
  const char* parent; /* name of the joint or frame that carries it; NULL or "universe": the world */
  double placement[12];                        /* joint frame in the parent's frame; default identity */
  double axis[3];                              /* any length but zero; default z */
  double axis2[3];                             /* universal only; default x */
  double pitch;                                /* helical: metres per radian */
  /* nq numbers each, or NULL: no limits. -inf and inf are no limit. Of a quaternion only w has a limit: a
     lower bound cos(a/2) in [0, 1) of a spherical joint keeps the rotation angle below a. */
  const double *lower, *upper;
  const double *velocity, *effort;             /* nv numbers each, or NULL: infinite */
  const double *armature, *damping, *friction; /* nv numbers each, or NULL: zero */
  /* nv numbers, or NULL: no springs. The three of a quaternion must be equal, a free flyer's zero. */
  const double* stiffness;
  const double* spring_reference;              /* nq numbers: configuration at rest; NULL: the neutral one */
  /* joints of one degree of freedom: armature += rotor_inertia * gear_ratio^2 */
  double rotor_inertia, gear_ratio;
  /* leader's name, or NULL; for joints of one degree of freedom, in any order in the tree */
  const char* mimic;
  double mimic_ratio, mimic_offset;
  /* composite: its joints in order. Read are type, placement (after the previous part), axis, axis2 and
     pitch. */
  const struct dynJointSpec* parts;
  size_t parts_count;                          /* NULL and 0 for all other types */
} dynJointSpec;
DYN_API void dyn_joint_spec_init(dynJointSpec* spec, uint32_t struct_size);
#define dyn_joint_spec_init(x) dyn_joint_spec_init(x, sizeof(dynJointSpec))

/* Makes an empty builder. Its gravity is (0, 0, -9.81) m/s^2. */
DYN_API dynStatus dyn_builder_new(const char* model_name, dynBuilder** builder);
DYN_API void dyn_builder_free(dynBuilder* builder); /* NULL is allowed */
/* Sets gravity, m/s^2, world axes. */
DYN_API dynStatus dyn_builder_set_gravity(dynBuilder* builder, const double gravity[3]);
/* Adds a joint after its parent. A fixed joint becomes a frame. The finished model numbers joints depth
   first. */
DYN_API dynStatus dyn_builder_add_joint(dynBuilder* builder, const dynJointSpec* spec);
/* Adds a link: mass (kg), centre of mass (m) and inertia about it (3 x 3, kg m^2), in the link's frame.
   placement (12, NULL: identity) puts the link's frame in the frame or joint named parent. Returns
   DYN_ERROR_INVALID when one principal moment is larger than the sum of the others. */
DYN_API dynStatus dyn_builder_add_body(dynBuilder* builder, const char* name, const char* parent,
                                       const double* placement, double mass, const double com[3],
                                       const double inertia[9]);
/* Adds a frame of type OP_FRAME or SENSOR. placement (12, NULL: identity) is in the frame or joint named
   parent. */
DYN_API dynStatus dyn_builder_add_frame(dynBuilder* builder, const char* name, const char* parent,
                                        const double* placement, dynFrameType type);
/* Holds a share of a link's weight from outside, at its centre of mass. 1 makes the link weightless in steps.
   Any finite number is allowed. */
DYN_API dynStatus dyn_builder_set_gravity_compensation(dynBuilder* builder, const char* body, double share);
/* Makes a link that is fixed to the world a mocap body, whose placement data sets (dyn_data_set_mocap). What
   is fixed to the link goes along. No joint may move or hang on it. */
DYN_API dynStatus dyn_builder_set_mocap(dynBuilder* builder, const char* body);
/* The medium around the links: density (kg/m^3, >= 0), viscosity (Pa s, >= 0) and wind (m/s, world; NULL:
   none). Steps add drag to each link, as to the box of equal inertia with sides 2 r, relative to the medium,
   in principal axes. b_i = 4 r_j r_k is the face across axis i, d the mean of the sides:
     force_i  = - density / 2 b_i |v_i| v_i - 3 pi d viscosity v_i
     moment_i = - density / 2 r_i (r_j^4 + r_k^4) |w_i| w_i - pi d^3 viscosity w_i
   (MuJoCo's inertia-based fluid model; MuJoCo documentation, Computation: Passive forces.) Links that have a
   shape with dyn_builder_set_shape_fluid have the forces on its ellipsoid instead. */
DYN_API dynStatus dyn_builder_set_medium(dynBuilder* builder, double density, double viscosity,
                                         const double wind[3]);
/* A shape on a link. */
typedef struct dynShapeSpec {
  uint32_t struct_size;          /* set by dyn_shape_spec_init */
  const char* name;              /* NULL: none */
  dynShapeType type;
  dynShapeRole role;             /* default collision */
  const char* body;              /* the link that carries the shape; NULL or "universe": the world */
  double placement[12];          /* in the link's frame; default identity */
  double size[3];                /* m, > 0, as said at dynShapeType */
  const char* mesh;              /* the mesh file, kept as a name: of MESH, and of a shape made from a mesh */
  double radius;                 /* m, >= 0, of rounding; not of MESH */
  uint32_t contype, conaffinity; /* default 1, 1 */
  /* copied. CONVEX: a hull (dyn_mesh_hull); TRIANGLES: a mesh; HEIGHT_FIELD: see
     dyn_mesh_from_height_field */
  const dynMesh* surface;
  dynMaterial material;
} dynShapeSpec;
DYN_API void dyn_shape_spec_init(dynShapeSpec* spec, uint32_t struct_size);
#define dyn_shape_spec_init(x) dyn_shape_spec_init(x, sizeof(dynShapeSpec))
/* Adds a shape to a link. */
DYN_API dynStatus dyn_builder_add_shape(dynBuilder* builder, const dynShapeSpec* spec);
/* Sets the colour of the last added shape, 0 to 1 each, for pictures alone. Returns DYN_ERROR_INVALID when
   there is no shape. */
DYN_API dynStatus dyn_builder_set_shape_rgba(dynBuilder* builder, const double rgba[4]);
/* Makes the medium act on the last added shape as on an ellipsoid: blunt drag, slender drag, angular drag,
   Kutta lift and Magnus force with these coefficients (>= 0; NULL: MuJoCo's 0.5, 0.25, 1.5, 1, 1), viscous
   drag, and the velocity-dependent forces of added mass. semiaxes (m): NULL for those of a sphere, box,
   capsule, cylinder or ellipsoid. placement (12, NULL: the shape's) of the ellipsoid in the link's frame.
   Returns DYN_ERROR_INVALID when there is no shape. (MuJoCo's ellipsoid-based fluid model; MuJoCo
   documentation, Computation: Fluid forces. Links without mass have none.) */
DYN_API dynStatus dyn_builder_set_shape_fluid(dynBuilder* builder, const double coefficients[5],
                                              const double semiaxes[3], const double placement[12]);
/* Makes a pair of collision shapes of different bodies tested, whatever the filters say. Shapes are named.
   material is that of their contacts in steps; NULL: it follows from the two shapes. */
DYN_API dynStatus dyn_builder_add_pair(dynBuilder* builder, const char* shape1, const char* shape2,
                                       const dynMaterial* material);
/* Adds a named configuration: nq numbers in the finished model's order. Quaternions and (cos, sin) pairs are
   normalised. dyn_builder_finish refuses a zero one (DYN_ERROR_QUATERNION). */
DYN_API dynStatus dyn_builder_add_configuration(dynBuilder* builder, const char* name, const double* q,
                                                size_t nq);
/* Operations on the whole robot. A failed one leaves the builder unchanged. */

/* Makes a builder from a model. Finished at once, the builder makes the same model. Only the limits of
   followers are lost: a model has none. */
DYN_API dynStatus dyn_builder_from_model(const dynModel* model, dynBuilder** builder);
/* Locks joints at a configuration: q has nq numbers, in the order that finish would give now, and is
   normalised. The joints become frames of type DYN_FRAME_TYPE_FIXED_JOINT. Links, frames and shapes stay, as
   part of the carrying body. Named configurations lose the locked coordinates. A leader locks its followers
   too. Returns DYN_ERROR_INVALID for a follower alone, and for a coordinate outside of the joint's limits. */
DYN_API dynStatus dyn_builder_lock(dynBuilder* builder, const char* const* joints, size_t count,
                                   const double* q, size_t nq);
/* Adds a whole model. prefix goes before its names (NULL: none). joint, of any type, carries the model's
   world: DYN_JOINT_TYPE_FIXED welds. joint NULL: the two worlds are one. Shapes of its world go to a link of
   the joint's name. Configurations of the same name are joined; a part without that name is neutral. Gravity
   stays the builder's. Returns DYN_ERROR_NAME when both have a name. */
DYN_API dynStatus dyn_builder_attach(dynBuilder* builder, const dynModel* model, const char* prefix,
                                     const dynJointSpec* joint);
/* Keeps a joint and its subtree alone. The frame of the joint's parent becomes the world. Attached there
   again, the subtree is in its old place. Returns DYN_ERROR_INVALID when a joint inside follows one outside.
   */
DYN_API dynStatus dyn_builder_keep_subtree(dynBuilder* builder, const char* joint);
/* Removes a joint and its subtree. Returns DYN_ERROR_INVALID when a joint that stays follows a removed one.
   */
DYN_API dynStatus dyn_builder_remove_subtree(dynBuilder* builder, const char* joint);
/* Numbers of what a builder holds: to list them, to compare two models, and to change some. */

/* Groups of them. */
typedef enum dynParameterGroup {
  DYN_PARAMETER_GROUP_GRAVITY = 0,       /* Gravity. */
  DYN_PARAMETER_GROUP_MASS = 1,          /* Masses of links. */
  DYN_PARAMETER_GROUP_INERTIA = 2,       /* Centres of mass and inertias of links. */
  DYN_PARAMETER_GROUP_ARMATURE = 3,      /* Armature of joints. */
  DYN_PARAMETER_GROUP_DAMPING = 4,       /* Damping of joints. */
  DYN_PARAMETER_GROUP_FRICTION = 5,      /* Dry friction of joints. */
  DYN_PARAMETER_GROUP_SPRINGS = 6,       /* Stiffness of joints, and where their springs rest. */
  DYN_PARAMETER_GROUP_LIMITS = 7,        /* Limits of joints. */
  DYN_PARAMETER_GROUP_FRAMES = 8,        /* Placements of joints, links and frames; axes of joints. */
  DYN_PARAMETER_GROUP_MIMIC = 9,         /* Ratios and offsets of followers. */
  DYN_PARAMETER_GROUP_SHAPES = 10,       /* Sizes, placements and masks of collision shapes. */
  DYN_PARAMETER_GROUP_CONTACT = 11,      /* Materials: what happens where shapes touch. */
  DYN_PARAMETER_GROUP_ACTUATORS = 12,    /* Gains, ranges and time constants of actuators. */
  DYN_PARAMETER_GROUP_TENDONS = 13,      /* Numbers of tendons and their couplings. */
  DYN_PARAMETER_GROUP_CONSTRAINTS = 14,  /* Numbers of constraints. */
  DYN_PARAMETER_GROUP_MEDIUM = 15,       /* Density, viscosity, wind. */
  DYN_PARAMETER_GROUP_COMPENSATION = 16  /* Shares of weights that are held. */
} dynParameterGroup;

/* A quantity of one object. Texts and numbers live until the builder changes or is freed. */
typedef struct dynParameter {
  uint32_t struct_size;
  dynParameterGroup group;
  const char* object;   /* "model", "joint", "link", "frame", "shape", "pair", "actuator", "tendon", .. */
  const char* name;     /* of the object; of a shape without a name "LINK, shape K"; "" of the model */
  const char* quantity; /* "damping"; a "placement" is x, y, z and a rotation vector, in the carrying joint */
  const double* values;
  size_t count;
} dynParameter;
/* Lists the quantities of joints, links, frames, collision shapes, actuators, tendons and constraints.
   Returns their number, or -1. */
DYN_API int dyn_builder_parameter_count(dynBuilder* builder);
/* Describes quantity index of the list. */
DYN_API dynStatus dyn_builder_parameter(dynBuilder* builder, int index, dynParameter* out);
/* Replaces the numbers of a quantity: as many as it has. The list stays as it is. Numbers that the functions
   above would refuse are refused, and change nothing. */
DYN_API dynStatus dyn_builder_set_parameter(dynBuilder* builder, int index, const double* values,
                                            size_t count);
/* Compiles the model. The builder stays valid: it may be extended and finished again. */
DYN_API dynStatus dyn_builder_finish(dynBuilder* builder, dynModel** model);
#endif

/* --------------------------------------------------------------------------------------------------- data */

/* Parts: groups of buffers. An absent part takes no memory. A call that needs an absent part returns
   DYN_ERROR_PART. */
typedef uint32_t dynParts;
enum {
  DYN_PART_KINEMATICS = 1u << 0,           /* Placements, velocities and accelerations of the joints. */
  DYN_PART_JACOBIANS = 1u << 1,            /* J and dJ, 6 x nv each. */
  DYN_PART_COM = 1u << 2, /* com, vcom, acom, Jcom, dvcom_dq, and centres of mass of subtrees. */
  DYN_PART_INVERSE = 1u << 3,              /* tau, nle and g by RNEA. */
  DYN_PART_FORWARD = 1u << 4,              /* ddq by ABA. */
  DYN_PART_MASS = 1u << 5,                 /* M, nv x nv, by CRBA. */
  DYN_PART_CHOLESKY = 1u << 6,             /* The sparse factor of M, and solves with it (includes MASS). */
  DYN_PART_MINV = 1u << 7,                 /* Minv, nv x nv (includes CHOLESKY and FORWARD). */
  DYN_PART_CORIOLIS = 1u << 8,             /* The Coriolis matrix, nv x nv. */
  DYN_PART_ENERGY = 1u << 9,               /* Kinetic, potential and mechanical energy. */
  DYN_PART_FRAMES = 1u << 10,              /* Placements of all frames. */
  DYN_PART_CENTROIDAL = 1u << 11, /* Ag, dAg, dh_dq, dhdot_dq and dhdot_dv, 6 x nv each; hg, dhg and Ig. */
  DYN_PART_INVERSE_DERIVATIVES = 1u << 12, /* dtau_dq, dtau_dv, dg_dq and dstatic_torque_dq, nv x nv each. */
  /* ddq_dq and ddq_dv, nv x nv each (includes MINV and INVERSE_DERIVATIVES). */
  DYN_PART_FORWARD_DERIVATIVES = 1u << 13,
  /* The regressor, nv x 10 (njoints - 1), and those of com and of the energies. */
  DYN_PART_REGRESSOR = 1u << 14,
  DYN_PART_IK = 1u << 15,                  /* Inverse kinematics: two matrices nv x nv (includes COM). */
  DYN_PART_SECOND_ORDER = 1u << 16, /* lambda_d2tau_..., nv x nv each (includes INVERSE_DERIVATIVES). */
  DYN_PART_COLLISION = 1u << 17,           /* Distances of all pairs. */
  /* Constraint slots and the Delassus matrix (includes FORWARD, and CHOLESKY with mimic joints). */
  DYN_PART_CONSTRAINTS = 1u << 18,
  /* nv x rows and rows x nv (includes CONSTRAINTS and FORWARD_DERIVATIVES). */
  DYN_PART_CONSTRAINT_DERIVATIVES = 1u << 19,
  /* Steps (includes FORWARD; CHOLESKY with mimic joints; COLLISION and CONSTRAINTS with pairs, limits or
     slots). */
  DYN_PART_SIMULATION = 1u << 20,
  /* Derivatives of steps (includes SIMULATION, MINV and INVERSE_DERIVATIVES). */
  DYN_PART_STEP_DERIVATIVES = 1u << 21,
  DYN_PART_ALL = 0x3fffff                  /* All parts. */
};

#ifndef DYN_BARE
/* Makes data for a model. parts = 0 means DYN_PART_ALL. On Linux, pages of it that no call touches take no
   memory: parts that are not used cost next to nothing. */
DYN_API dynStatus dyn_data_new(const dynModel* model, dynParts parts, dynData** data);
#endif
/* Returns the bytes that dyn_data_init needs, alignment slack included. Returns 0 for an invalid handle or
   unknown parts. */
DYN_API size_t dyn_data_size(const dynModel* model, dynParts parts);
/* Makes the data in the caller's memory (any alignment), without heap. *data points into the memory.
   dyn_data_free only marks such data as freed. */
DYN_API dynStatus dyn_data_init(const dynModel* model, dynParts parts, void* memory, size_t size,
                                dynData** data);
DYN_API void dyn_data_free(dynData* data); /* NULL is allowed */
#ifndef DYN_BARE
/* Touches memory that later calls would touch first, so that no later call waits for a page: the library, the
   model, the data, 128 KiB of the thread's stack, and the thread's error text. Call it once after creation in
   each thread that has a deadline. It changes no result. Besides creating and freeing, no other function may
   lock or allocate. */
DYN_API dynStatus dyn_data_warm_up(const dynModel* model, dynData* data);
#endif

/* Sets the state held in data. NULL leaves a value unchanged. A call with q, v, a or tau sets them too. New
   data is at the model's initial configuration (dyn_model_initial_configuration) and at rest. */
DYN_API dynStatus dyn_data_set_state(const dynModel* model, dynData* data, const double* q, const double* v,
                                     const double* a, const double* tau);
/* Sets q, v, a, tau, controls, activations and time to those of a named configuration; name NULL: to those of
   new data. A key of an MJCF file states velocity, controls, activations and time: zero where it does not. */
DYN_API dynStatus dyn_data_reset(const dynModel* model, dynData* data, const char* name);
/* Mocap bodies: links fixed to the world whose placement (12 numbers, world) the caller sets. Their shapes
   collide with all that moves. Constraints pull other bodies to them. They have no velocity: a constraint or
   a contact with one that moves is corrected by its error. dyn_data_reset sets them as in the configuration.
   Batches and rollouts take them as an input (mocap). Returns the number of mocap bodies. */
DYN_API int dyn_model_nmocaps(const dynModel* model);
/* Returns the id of a mocap body by the name of its link, or -1. */
DYN_API int dyn_model_mocap_id(const dynModel* model, const char* name);
/* Returns the BODY frame of a mocap body, or -1 when out of range. */
DYN_API int dyn_model_mocap_frame(const dynModel* model, int mocap);
/* Places a mocap body. Sleeping bodies wake. The first nine numbers must be a rotation to within 1e-6. */
DYN_API dynStatus dyn_data_set_mocap(const dynModel* model, dynData* data, int mocap,
                                     const double placement[12]);
/* Returns the placement of a mocap body. */
DYN_API dynStatus dyn_data_mocap(const dynModel* model, dynData* data, int mocap, double placement[12]);

#define DYN_FRICTION_VELOCITY 0.01 /* rad/s or m/s: viscous below, exact to 1e-3 beyond four times this */

/* Effects, a bit each. Data has them switched on or off joint by joint. New data has DYN_EFFECT_DEFAULT.
   LIMITS, ACTUATORS, FLUID, FLUID_ELLIPSOIDS, GRAVITY_COMPENSATION and SLEEPING act in steps alone.
     M = M of the rigid bodies + armature        M a + nle = tau + J' fext
     nle = Coriolis, centrifugal and gravity forces + damping v + friction tanh(v / DYN_FRICTION_VELOCITY)
           + stiffness (q (-) reference)
   Inverse and forward dynamics, steps, their derivatives, static torque and energies (of rotors and springs)
   apply the same effects. dyn_gravity_torque applies none. The springs of a continuous joint count its turns.
   An absent effect, or one that is off, costs nothing. */
enum {
  DYN_EFFECT_ARMATURE = 1u << 0,             /* Rotor inertia on the diagonal of M. */
  DYN_EFFECT_DAMPING = 1u << 1,              /* Viscous damping in the joints. */
  DYN_EFFECT_SPRINGS = 1u << 2,              /* Springs in the joints. */
  DYN_EFFECT_FRICTION = 1u << 3,             /* Dry friction in the joints. */
  DYN_EFFECT_LIMITS = 1u << 4,               /* Position limits of the joint. */
  DYN_EFFECT_ACTUATORS = 1u << 5,            /* Actuators of the joint. */
  /* Drag of the medium on the links that the joint carries, as on boxes of equal inertia. */
  DYN_EFFECT_FLUID = 1u << 6,
  DYN_EFFECT_GRAVITY_COMPENSATION = 1u << 7, /* Gravity compensation of the links that the joint carries. */
  DYN_EFFECT_SLEEPING = 1u << 8,             /* Bodies at rest may sleep: see dynStepOptions. */
  /* Steps apply all effects that the model states, less those that flags of its file switch off. SLEEPING is
     by its own bit. The other bits are then those of algorithms called alone. */
  DYN_EFFECT_AS_STATED = 1u << 9,
  /* The effects of new data: AS_STATED, and for algorithms called alone ARMATURE, LIMITS, ACTUATORS, FLUID,
     FLUID_ELLIPSOIDS, GRAVITY_COMPENSATION. */
  DYN_EFFECT_DEFAULT = 0xaf1,
  DYN_EFFECT_TENDONS = 1u << 10,             /* Springs, damping, friction, limits, couplings of tendons. */
  /* Forces of the medium on shapes with dyn_builder_set_shape_fluid of the links that the joint carries. */
  DYN_EFFECT_FLUID_ELLIPSOIDS = 1u << 11,
  DYN_EFFECT_ALL = 0xdff                     /* All effects, in steps and in algorithms. */
};
/* Sets the effects of a joint (joint 0: of all joints) to the mask. A follower's effects belong to its
   leader: set them there. All results are stale afterwards. */
DYN_API dynStatus dyn_data_set_effects(const dynModel* model, dynData* data, int joint, uint32_t effects);
/* Writes the mask that was set. With joint 0: the effects that act in steps, at some joint that has them. */
DYN_API dynStatus dyn_data_effects(const dynModel* model, dynData* data, int joint, uint32_t* effects);
/* One effect of a step of this data. An absent effect takes no instruction and no byte of a step. Only
   wrenches always have room, because they may come at any time. */
typedef struct dynEffectInfo {
  uint32_t struct_size;
  const char* name; /* as in dyn_effect_type_info; besides gravity, mimic, contact, constraints, wrenches */
  int32_t present; /* joints, pairs, constraints, actuators or links of the model that may have the effect */
  /* non-zero: the effect acts. Contact: pairs tested (shapes, where pairs are not listed); constraints:
     enabled slots; sleeping: trees of bodies that may sleep. */
  int32_t acting;
  uint64_t bytes;  /* memory in the data that only this effect needs */
} dynEffectInfo;
/* Returns the number of effects that dyn_data_effect_info describes. */
DYN_API int dyn_effect_count(void);
/* Describes an effect of steps of this data. */
DYN_API dynStatus dyn_data_effect_info(const dynModel* model, dynData* data, int effect, dynEffectInfo* info);
/* Sets gravity in this data (m/s^2, world axes). New data has the model's. All results are stale afterwards.
   The field "world_gravity" reads it. */
DYN_API dynStatus dyn_data_set_gravity(const dynModel* model, dynData* data, const double gravity[3]);

/* Fields: everything that data holds, by id. Ids are never renumbered. */
typedef int32_t dynField;
typedef struct dynFieldInfo {
  uint32_t struct_size;
  dynParts part;
  const char* name;     /* as in Python: "q", "M", "com", ... */
  const char* shape;    /* "nv x nv" */
  const char* unit;
  const char* frame;
  const char* producer; /* the call that computes it; "" for the state */
  const char* sentence; /* one sentence: what the field is */
} dynFieldInfo;
/* Returns the number of fields. */
DYN_API int dyn_field_count(void);
/* Describes a field. */
DYN_API dynStatus dyn_field_info(dynField field, dynFieldInfo* info);
DYN_API dynField dyn_field_id(const char* name); /* -1: unknown */
/* Returns a view of a field, without a copy. The view stays valid, and follows the data, until the data is
   freed. Returns DYN_ERROR_STALE when the field is not of the current q, v, a, tau. Returns DYN_ERROR_PART
   when the data has not its part. */
DYN_API dynStatus dyn_data_array(const dynModel* model, dynData* data, dynField field, dynArray* out);

/* --------------------------------------------------------------------------------------------- kinematics */

/* Placements, velocities and accelerations of all joints. v and a NULL: placements only. a NULL: no
   accelerations. (To use held values, pass the data's own arrays: dyn_data_array of the fields "v" and "a".)
   */
DYN_API dynStatus dyn_forward_kinematics(const dynModel* model, dynData* data, const double* q,
                                         const double* v, const double* a);

/* Frame queries need dyn_forward_kinematics of the current state, or an algorithm that includes it. frame is
   an id. placement: 12, X_WF. */
DYN_API dynStatus dyn_frame_placement(const dynModel* model, dynData* data, int frame, double placement[12]);
/* Placements of all frames, 12 x nframes, into the field "placements". Needs part FRAMES. */
DYN_API dynStatus dyn_frame_placements(const dynModel* model, dynData* data, double* placements);
/* Spatial velocity of the frame, 6. */
DYN_API dynStatus dyn_frame_velocity(const dynModel* model, dynData* data, int frame, dynReference reference,
                                     double velocity[6]);
/* Spatial acceleration of the frame, 6: the time derivative of the spatial velocity (Featherstone 2008,
   2.10), without gravity. */
DYN_API dynStatus dyn_frame_acceleration(const dynModel* model, dynData* data, int frame,
                                         dynReference reference, double acceleration[6]);
/* Classical acceleration, 6: the second derivative of the frame origin's position, and the angular
   acceleration. classical.linear = spatial.linear + omega x velocity. */
DYN_API dynStatus dyn_frame_classical_acceleration(const dynModel* model, dynData* data, int frame,
                                                   dynReference reference, double acceleration[6]);

/* Joint Jacobians of all joints in DYN_REFERENCE_WORLD: J, 6 x nv. Column k is the world's motion by degree
   of freedom k, as if it moved all bodies. Includes dyn_forward_kinematics of q. */
DYN_API dynStatus dyn_joint_jacobians(const dynModel* model, dynData* data, const double* q, double* J);
/* The time variation dJ, 6 x nv. Includes J and kinematics of q, v. */
DYN_API dynStatus dyn_joint_jacobians_time_variation(const dynModel* model, dynData* data, const double* q,
                                                     const double* v, double* dJ);
/* Jacobian of a frame, 6 x nv, zeros written: J v = dyn_frame_velocity. Needs kinematics of the current q. */
DYN_API dynStatus dyn_frame_jacobian(const dynModel* model, dynData* data, int frame, dynReference reference,
                                     double* J);
/* d/dt of dyn_frame_jacobian, 6 x nv, zeros written. Needs kinematics of the current q, v. */
DYN_API dynStatus dyn_frame_jacobian_time_variation(const dynModel* model, dynData* data, int frame,
                                                    dynReference reference, double* dJ);

/* Derivatives of dyn_frame_velocity, 6 x nv each, zeros written. Either may be NULL. Column k of dv_dq is the
   derivative along q (+) e_k t with v held. dv_dv is the Jacobian. Needs kinematics of the current q, v. */
DYN_API dynStatus dyn_frame_velocity_derivatives(const dynModel* model, dynData* data, int frame,
                                                 dynReference reference, double* dv_dq, double* dv_dv);
/* Derivatives of dyn_frame_acceleration and of dyn_frame_classical_acceleration, 6 x nv each. Any output may
   be NULL. Needs kinematics of the current q, v, a. (Carpentier and Mansard 2018) */
DYN_API dynStatus dyn_frame_acceleration_derivatives(const dynModel* model, dynData* data, int frame,
                                                     dynReference reference, double* da_dq, double* da_dv,
                                                     double* da_da);
DYN_API dynStatus dyn_frame_classical_acceleration_derivatives(const dynModel* model, dynData* data,
                                                               int frame, dynReference reference,
                                                               double* da_dq, double* da_dv, double* da_da);
/* H, 6 x nv x nv, zeros written: element (r, j, k) at r + 6 j + 6 nv k. Matrix k (6 x nv) is the derivative
   of dyn_frame_jacobian along q (+) e_k t. The sum of H_k v_k is the Jacobian's time variation. Needs
   placements of the current q and part JACOBIANS. */
DYN_API dynStatus dyn_frame_kinematic_hessian(const dynModel* model, dynData* data, int frame,
                                              dynReference reference, double* H);

/* ----------------------------------------------------------------------------------------- centre of mass */

/* com, vcom, acom: 3 each, world axes. v and a may be NULL as in dyn_forward_kinematics, which is included.
   */
DYN_API dynStatus dyn_com(const dynModel* model, dynData* data, const double* q, const double* v,
                          const double* a, double* com, double* vcom, double* acom);
/* Jcom, 3 x nv: Jcom v = vcom. Includes com and kinematics of q. */
DYN_API dynStatus dyn_jcom(const dynModel* model, dynData* data, const double* q, double* Jcom);
/* Derivatives of vcom on the tangent space, 3 x nv each: by q, and by v (which is Jcom). Includes com, vcom
   and kinematics of q, v. */
DYN_API dynStatus dyn_vcom_derivatives(const dynModel* model, dynData* data, const double* q, const double* v,
                                       double* dvcom_dq, double* dvcom_dv);
/* Centre of mass (3) and mass of the subtree of a joint, the joint included. Either may be NULL. Needs
   dyn_com. */
DYN_API dynStatus dyn_subtree_com(const dynModel* model, dynData* data, int joint, double com[3],
                                  double* mass);
/* Jacobian of a subtree's centre of mass, 3 x nv. Needs dyn_com. */
DYN_API dynStatus dyn_subtree_jcom(const dynModel* model, dynData* data, int joint, double* J);

/* --------------------------------------------------------------------------------------------- centroidal */

/* Momentum about the centre of mass, axes of the world, [linear; angular]: hg = Ag v (Orin, Goswami, Lee
   2013). Rotors (armature) and bodies welded to the world do not count. Needs part CENTROIDAL. */

/* Ag, 6 x nv; Ig, 6 x 6; hg = Ag v, 6. Ig = [m 1, 0; 0, I] is the robot's inertia about its centre of mass,
   so that Ig^-1 hg is the robot's average velocity. Includes placements. */
DYN_API dynStatus dyn_centroidal_map(const dynModel* model, dynData* data, const double* q, const double* v,
                                     double* Ag, double Ig[36], double hg[6]);
/* dAg, 6 x nv: dhg = Ag a + dAg v. Includes dyn_centroidal_map. */
DYN_API dynStatus dyn_centroidal_map_time_variation(const dynModel* model, dynData* data, const double* q,
                                                    const double* v, double* dAg);
/* hg alone, without Ag. Includes placements. */
DYN_API dynStatus dyn_centroidal_momentum(const dynModel* model, dynData* data, const double* q,
                                          const double* v, double hg[6]);
/* dhg, 6: the time derivative of hg at the acceleration a. dhg = [m acom; rate of the angular momentum], the
   resultant about the centre of mass of all forces on the robot, weight included. In free fall dhg is [m g;
   0]. Includes hg and placements. */
DYN_API dynStatus dyn_centroidal_momentum_time_variation(const dynModel* model, dynData* data,
                                                         const double* q, const double* v, const double* a,
                                                         double dhg[6]);

typedef struct dynCentroidalDerivatives {
  uint32_t struct_size; /* set by dyn_centroidal_derivatives_init */
  double *dh_dq, *dhdot_dq, *dhdot_dv, *dhdot_da;
} dynCentroidalDerivatives;
DYN_API void dyn_centroidal_derivatives_init(dynCentroidalDerivatives* out, uint32_t struct_size);
#define dyn_centroidal_derivatives_init(x) \
  dyn_centroidal_derivatives_init(x, sizeof(dynCentroidalDerivatives))
/* Derivatives of hg and dhg on the tangent space, 6 x nv each. dh_dq is that of hg by q. dhdot_dq, dhdot_dv
   and dhdot_da are those of dhg by q, v, a. dhdot_da = Ag is also the derivative of hg by v. Includes Ag, Ig,
   hg, dhg and placements. */
DYN_API dynStatus dyn_centroidal_derivatives(const dynModel* model, dynData* data, const double* q,
                                             const double* v, const double* a,
                                             const dynCentroidalDerivatives* out);

/* ----------------------------------------------------------------------------------------------- dynamics */

/* External forces fext: 6 x njoints, [force; moment] on each joint's body, at the joint frame's origin, in
   the joint's frame. Column 0 (the universe) is ignored. NULL: none. fext is no part of the state. It acts as
   tau - J^T fext. */

/* Inverse dynamics, tau = M a + nle - J^T fext, nv. RNEA (Featherstone 2008, Table 5.1). Includes placements.
   */
DYN_API dynStatus dyn_rnea(const dynModel* model, dynData* data, const double* q, const double* v,
                           const double* a, const double* fext, double* tau);
/* nle = tau at a = 0: Coriolis, centrifugal and gravity forces, nv. */
DYN_API dynStatus dyn_nle(const dynModel* model, dynData* data, const double* q, const double* v,
                          double* nle);
/* g = tau at v = a = 0, nv. It equals dyn_rnea(q, 0, 0) bit for bit. */
DYN_API dynStatus dyn_gravity_torque(const dynModel* model, dynData* data, const double* q, double* g);
/* The torque that holds q at rest: g - J^T fext, nv. */
DYN_API dynStatus dyn_static_torque(const dynModel* model, dynData* data, const double* q, const double* fext,
                                    double* tau);
/* Coriolis matrix C, nv x nv: C v + g = nle, and dM/dt - 2 C is skew-symmetric (Echeandia and Wensing 2021).
   */
DYN_API dynStatus dyn_coriolis_matrix(const dynModel* model, dynData* data, const double* q, const double* v,
                                      double* C);
/* Forward dynamics, ddq = M^-1 (tau - nle + J^T fext), nv. ABA (Featherstone 2008, Table 7.1). With mimic
   joints: by the factor of M (needs part CHOLESKY). DYN_ERROR_NUMERIC names the joint whose articulated
   inertia is not positive. */
DYN_API dynStatus dyn_aba(const dynModel* model, dynData* data, const double* q, const double* v,
                          const double* tau, const double* fext, double* ddq);
/* M, nv x nv, full and symmetric. CRBA (Featherstone 2008, Table 6.2). Includes placements. */
DYN_API dynStatus dyn_crba(const dynModel* model, dynData* data, const double* q, double* M);
/* Factors the current M = L^T D L, with the sparsity of the tree (Featherstone 2008, 6.5). Returns
   DYN_ERROR_STALE when M is not of the current q. */
DYN_API dynStatus dyn_cholesky(const dynModel* model, dynData* data);
/* x = M^-1 b for nrhs right-hand sides, nv x nrhs each; x may be b. The factor is that of the held q, made by
   dyn_cholesky, or by dyn_all_terms with CHOLESKY or MINV. Returns DYN_ERROR_STALE when q has no factor or
   has changed since; v, a and tau may change. Returns DYN_ERROR_NUMERIC when a solution overflows: earlier
   columns of x are written. */
DYN_API dynStatus dyn_cholesky_solve(const dynModel* model, dynData* data, const double* b, int nrhs,
                                     double* x);
/* Minv = M^-1, nv x nv, full and symmetric, by articulated inertias (Carpentier 2018). With mimic joints: by
   the factor of M. */
DYN_API dynStatus dyn_minv(const dynModel* model, dynData* data, const double* q, double* Minv);
/* Derivatives of inverse dynamics: dtau_dq and dtau_dv, nv x nv each. Either may be NULL. Analytic, O(n
   depth), on the tangent space: column k of dtau_dq is the derivative along q (+) e_k t. fext is constant in
   the joints' frames. Includes M (which is dtau/da), tau, and placements. (Singh, Russell, Wensing 2022) */
DYN_API dynStatus dyn_rnea_derivatives(const dynModel* model, dynData* data, const double* q, const double* v,
                                       const double* a, const double* fext, double* dtau_dq, double* dtau_dv);
typedef struct dynSecondOrderDerivatives {
  uint32_t struct_size; /* set by dyn_second_order_derivatives_init */
  double *dqdq, *dvdv, *dqdv, *dadq;
} dynSecondOrderDerivatives;
DYN_API void dyn_second_order_derivatives_init(dynSecondOrderDerivatives* out, uint32_t struct_size);
#define dyn_second_order_derivatives_init(x) \
  dyn_second_order_derivatives_init(x, sizeof(dynSecondOrderDerivatives))
/* Second derivatives of inverse dynamics on the tangent space, analytic (after Singh, Russell, Wensing 2023).
   d2tau_dqdv is the derivative of dtau_dq by v. d2tau_dadq is the derivative of M by q. d2tau_dqdq is the
   derivative along q (+) e_k t of column j of dtau_dq. Its order matters when e_j and e_k belong to one
   spherical or free-flyer joint, because rotations do not commute. The products with a vector lambda (nv) are
   the second derivatives of lambda . tau: the sum over i of lambda_i d2tau_i, nv x nv each. Any may be NULL.
   Rows j are the first variable of the name, columns k the second. O(n depth), about the time of two
   dyn_rnea_derivatives. Includes placements. Needs part SECOND_ORDER. */
DYN_API dynStatus dyn_rnea_second_order_product(const dynModel* model, dynData* data, const double* q,
                                                const double* v, const double* a, const double* fext,
                                                const double* lambda, const dynSecondOrderDerivatives* out);
/* The four tensors, nv x nv x nv each, zeros written. Any may be NULL. Element (i, j, k) is at j + nv k +
   nv^2 i: matrix i is the product with lambda = e_i. Includes placements. Needs part SECOND_ORDER. */
DYN_API dynStatus dyn_rnea_second_order_derivatives(const dynModel* model, dynData* data, const double* q,
                                                    const double* v, const double* a, const double* fext,
                                                    const dynSecondOrderDerivatives* out);
typedef struct dynAbaDerivatives {
  uint32_t struct_size; /* set by dyn_aba_derivatives_init */
  double *ddq_dq, *ddq_dv, *ddq_dtau;
} dynAbaDerivatives;
DYN_API void dyn_aba_derivatives_init(dynAbaDerivatives* out, uint32_t struct_size);
#define dyn_aba_derivatives_init(x) dyn_aba_derivatives_init(x, sizeof(dynAbaDerivatives))
/* Derivatives of forward dynamics, nv x nv each. Any may be NULL. ddq_dtau is Minv. Includes ddq. Afterwards
   dtau_dq, dtau_dv and tau in data are stale: they are not of the held a. (Carpentier and Mansard 2018) */
DYN_API dynStatus dyn_aba_derivatives(const dynModel* model, dynData* data, const double* q, const double* v,
                                      const double* tau, const double* fext, const dynAbaDerivatives* out);
/* Derivatives of g and of static_torque by q, nv x nv, on the tangent space. fext is constant in the joints'
   frames. Includes placements. */
DYN_API dynStatus dyn_gravity_torque_derivatives(const dynModel* model, dynData* data, const double* q,
                                                 double* dg_dq);
DYN_API dynStatus dyn_static_torque_derivatives(const dynModel* model, dynData* data, const double* q,
                                                const double* fext, double* dstatic_torque_dq);
/* Kinetic energy (v' M v / 2, armature included; with TENDONS also theirs) and potential energy (zero at the
   world's origin), J. Each may be NULL. */
DYN_API dynStatus dyn_energy(const dynModel* model, dynData* data, const double* q, const double* v,
                             double* kinetic, double* potential);

/* One of the two energies. */
DYN_API dynStatus dyn_kinetic_energy(const dynModel* model, dynData* data, const double* q, const double* v,
                                     double* kinetic);
DYN_API dynStatus dyn_potential_energy(const dynModel* model, dynData* data, const double* q,
                                       double* potential);

/* Computes everything in mask for one state, with shared passes. *filled (may be NULL) is the mask of what is
   now in data. */
enum {
  DYN_TERM_KINEMATICS = 1u << 0,               /* Placements and velocities of the joints. */
  DYN_TERM_FRAMES = 1u << 1,                   /* Placements of all frames. */
  DYN_TERM_JACOBIANS = 1u << 2,                /* Joint Jacobians J. */
  DYN_TERM_JACOBIANS_TIME_VARIATION = 1u << 3, /* Time variation dJ. */
  DYN_TERM_COM = 1u << 4,                      /* Centre of mass and its velocity. */
  DYN_TERM_JCOM = 1u << 5,                     /* Jacobian of the centre of mass. */
  DYN_TERM_NLE = 1u << 6,                      /* Coriolis, centrifugal and gravity forces. */
  DYN_TERM_GRAVITY_TORQUE = 1u << 7,           /* Gravity torque g. */
  DYN_TERM_MASS = 1u << 8,                     /* Mass matrix M. */
  DYN_TERM_CHOLESKY = 1u << 9,                 /* Sparse factor of M. */
  DYN_TERM_MINV = 1u << 10,                    /* Inverse of M. */
  DYN_TERM_CORIOLIS = 1u << 11,                /* Coriolis matrix. */
  DYN_TERM_ENERGY = 1u << 12,                  /* Kinetic and potential energy. */
  DYN_TERM_ALL = 0x1fff                        /* All terms. */
};
DYN_API dynStatus dyn_all_terms(const dynModel* model, dynData* data, uint32_t mask, const double* q,
                                const double* v, uint32_t* filled);

/* ----------------------------------------------------------------------------------------- identification */

/* Inertial parameters of a body: pi = [m, m c (3), Ixx, Ixy, Iyy, Ixz, Iyz, Izz]. c is the centre of mass. I
   is the inertia about the frame's origin (not about c), in the frame's axes. nparameters = 10 (njoints - 1):
   the ten of joint 1's body, then those of joint 2's, ... Each body is in its joint's frame, merged links
   included. A body welded to the world has none. */

/* pi of all joints' bodies, nparameters. */
DYN_API dynStatus dyn_model_inertial_parameters(const dynModel* model, double* pi);
/* Y, nv x nparameters: tau = Y pi + armature a (element by element), tau of dyn_rnea without fext. With v = a
   = 0: the regressor of g. A follower's row is part of its leader's. Includes dyn_forward_kinematics. Needs
   part REGRESSOR. */
DYN_API dynStatus dyn_joint_torque_regressor(const dynModel* model, dynData* data, const double* q,
                                             const double* v, const double* a, double* Y);
/* Y, 3 x nparameters: com = Y pi, for parameters whose masses add up to dyn_model_total_mass. Includes
   placements. */
DYN_API dynStatus dyn_static_regressor(const dynModel* model, dynData* data, const double* q, double* Y);
/* y, nparameters: y . pi is the kinetic energy, without that of the armature. Includes placements. */
DYN_API dynStatus dyn_kinetic_energy_regressor(const dynModel* model, dynData* data, const double* q,
                                               const double* v, double* y);
/* y, nparameters: y . pi is the potential energy. Includes placements. */
DYN_API dynStatus dyn_potential_energy_regressor(const dynModel* model, dynData* data, const double* q,
                                                 double* y);
/* Y, 6 x 10: Y pi is the force, gravity included, that moves the body of a joint, in the joint's frame. Needs
   dyn_forward_kinematics with q, v, a. */
DYN_API dynStatus dyn_joint_body_regressor(const dynModel* model, dynData* data, int joint, double Y[60]);
/* The same for a body that moves with a frame; pi and force are in that frame. A merged link counts by
   itself. */
DYN_API dynStatus dyn_frame_body_regressor(const dynModel* model, dynData* data, int frame, double Y[60]);
/* The same for any body, from its spatial velocity and its spatial acceleration minus gravity, 6 each, in its
   frame. */
DYN_API dynStatus dyn_body_regressor(const double velocity[6], const double acceleration[6], double Y[60]);

/* Pseudo-inertia J = [S h; h' m], 4 x 4, with h = m c and S = tr(I) / 2 1 - I. It is linear in pi (Wensing,
   Kim, Slotine 2018). J must be symmetric. */
DYN_API dynStatus dyn_pseudo_inertia_from_parameters(const double pi[10], double J[16]);
DYN_API dynStatus dyn_parameters_from_pseudo_inertia(const double J[16], double pi[10]);
/* Log-Cholesky parameters theta = [alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3] (Rucker, Wensing 2022):
     J = U U', U = e^alpha [e^d1 s12 s13 t1; 0 e^d2 s23 t2; 0 0 e^d3 t3; 0 0 0 1]
   Every theta is a body that can exist. Returns DYN_ERROR_INVALID for the pi of a body that cannot. */
DYN_API dynStatus dyn_log_cholesky_from_parameters(const double pi[10], double theta[10]);
DYN_API dynStatus dyn_parameters_from_log_cholesky(const double theta[10], double pi[10]);
/* d pi / d theta, 10 x 10. */
DYN_API dynStatus dyn_log_cholesky_jacobian(const double theta[10], double jacobian[100]);
/* *consistent = 1 when J is positive definite: some positive density has these parameters. A point or a rod
   has a singular J, a limit of such bodies, and gives 0. */
DYN_API dynStatus dyn_is_physically_consistent(const double pi[10], int* consistent);

/* ----------------------------------------------------------------------------------------- configurations */
/* Quaternions in q may have any norm on input, and have norm 1 on output. None of these functions touches
   data. */

/* out = q (+) v, nq: the configuration after one second at the constant velocity v. Pass v dt. out may be q.
   */
DYN_API dynStatus dyn_integrate(const dynModel* model, const double* q, const double* v, double* out);
/* v with q0 (+) v = q1, nv. Rotations are the shortest; continuous joints are wrapped to (-pi, pi]. */
DYN_API dynStatus dyn_difference(const dynModel* model, const double* q0, const double* q1, double* v);
/* q0 (+) u (q1 (-) q0). */
DYN_API dynStatus dyn_interpolate(const dynModel* model, const double* q0, const double* q1, double u,
                                  double* out);
/* Norm of dyn_difference. */
DYN_API dynStatus dyn_configuration_distance(const dynModel* model, const double* q0, const double* q1,
                                             double* distance);
/* The neutral configuration: zeros, and the identity for quaternions. */
DYN_API dynStatus dyn_configuration_neutral(const dynModel* model, double* q);
/* A random q, uniform between lower and upper (nq each; NULL: the limits of the model). An infinite range
   becomes [-1, 1], and [-pi, pi] for angles. Orientations are uniform on the sphere. The same seed gives the
   same q, always finite. */
DYN_API dynStatus dyn_configuration_random(const dynModel* model, uint64_t seed, const double* lower,
                                           const double* upper, double* q);
/* Normalises the quaternions and (cos, sin) pairs of q, in place. */
DYN_API dynStatus dyn_configuration_normalize(const dynModel* model, double* q);
/* *normalized = 1 when every quaternion and (cos, sin) has norm 1 within tolerance. */
DYN_API dynStatus dyn_configuration_is_normalized(const dynModel* model, const double* q, double tolerance,
                                                  int* normalized);
/* d(q (+) v)/dq and d(q (+) v)/dv on tangent spaces, nv x nv each. Either may be NULL. */
DYN_API dynStatus dyn_integrate_jacobians(const dynModel* model, const double* q, const double* v, double* dq,
                                          double* dv);
/* d(q1 (-) q0)/dq0 and d(q1 (-) q0)/dq1, nv x nv each. Either may be NULL. */
DYN_API dynStatus dyn_difference_jacobians(const dynModel* model, const double* q0, const double* q1,
                                           double* dq0, double* dq1);

/* ------------------------------------------------------------------------------- rotations and placements */
/* Groups without a model. R: rotations, 3 x 3. X: placements, 12 numbers each. w: rotation vectors, 3 each.
   twist: [linear; angular], 6 each, in the body's axes. Arrays hold `count` elements, one behind the other.
   An output may be an input whose elements have as many numbers.
   Numbers beyond 1e40 are DYN_ERROR_ARGUMENT. Columns that are not orthonormal to 1e-6, or that form a
   left-handed frame, are DYN_ERROR_INVALID.
   Sources: Murray, Li, Sastry 1994, 2.3; Barfoot 2017, 7.1. */

/* R_AC = R_AB R_BC. */
DYN_API dynStatus dyn_so3_compose(size_t count, const double* R_AB, const double* R_BC, double* R_AC);
/* R_BA of R_AB: the transpose. */
DYN_API dynStatus dyn_so3_inverse(size_t count, const double* R_AB, double* R_BA);
/* Vectors in A of `count` vectors in B, 3 each, by one rotation. */
DYN_API dynStatus dyn_so3_act(const double R_AB[9], size_t count, const double* x_B, double* x_A);
/* The rotation by |w| about w. */
DYN_API dynStatus dyn_so3_exp(size_t count, const double* w, double* R);
/* The rotation vector of R, |w| in [0, pi]. Near pi, w and -w are nearly one rotation. */
DYN_API dynStatus dyn_so3_log(size_t count, const double* R, double* w);
/* Jacobians of exp, 3 x 3 each. left 0: the right one, exp(w + dw) = exp(w) exp(J dw).
   left 1: the left one, exp(w + dw) = exp(J dw) exp(w). To first order in dw. */
DYN_API dynStatus dyn_so3_jexp(size_t count, const double* w, int left, double* J);
/* Jacobians of log at R: the inverse of dyn_so3_jexp at w = log R. */
DYN_API dynStatus dyn_so3_jlog(size_t count, const double* R, int left, double* J);
/* R0 exp(u log(R0^T R1)): the shorter way from R0 (u = 0) to R1 (u = 1), at constant speed. u: count. */
DYN_API dynStatus dyn_so3_interpolate(size_t count, const double* R0, const double* R1, const double* u,
                                      double* R);
/* Rotations of quaternions, 4 each, of any norm but zero (DYN_ERROR_QUATERNION). */
DYN_API dynStatus dyn_so3_from_quaternion(size_t count, const double* quaternion, double* R);
/* Unit quaternions with w >= 0. */
DYN_API dynStatus dyn_so3_to_quaternion(size_t count, const double* R, double* quaternion);
/* R = Rz(yaw) Ry(pitch) Rx(roll): fixed axes, as in URDF. rpy: roll, pitch, yaw, 3 each. */
DYN_API dynStatus dyn_so3_from_rpy(size_t count, const double* rpy, double* R);
/* Pitch in [-pi/2, pi/2]; at its ends roll is 0. */
DYN_API dynStatus dyn_so3_to_rpy(size_t count, const double* R, double* rpy);

/* X_AC = X_AB X_BC. */
DYN_API dynStatus dyn_se3_compose(size_t count, const double* X_AB, const double* X_BC, double* X_AC);
/* X_BA of X_AB. */
DYN_API dynStatus dyn_se3_inverse(size_t count, const double* X_AB, double* X_BA);
/* One placement acts on `count` elements given in B: the same in A. Points, 3 each. */
DYN_API dynStatus dyn_se3_act(const double X_AB[12], size_t count, const double* p_B, double* p_A);
/* Motions [linear; angular], 6 each. */
DYN_API dynStatus dyn_se3_act_motion(const double X_AB[12], size_t count, const double* m_B, double* m_A);
/* Forces [force; moment], 6 each. */
DYN_API dynStatus dyn_se3_act_force(const double X_AB[12], size_t count, const double* f_B, double* f_A);
/* Inertias, 6 x 6 each: momentum = I m. */
DYN_API dynStatus dyn_se3_act_inertia(const double X_AB[12], size_t count, const double* I_B, double* I_A);
/* Ad, 6 x 6 each: m_A = Ad m_B, and f_B = Ad^T f_A. */
DYN_API dynStatus dyn_se3_adjoint(size_t count, const double* X_AB, double* Ad);
/* The placement after one second of the constant velocity twist. */
DYN_API dynStatus dyn_se3_exp(size_t count, const double* twist, double* X);
/* The twist whose exp is X, its angle in [0, pi]. */
DYN_API dynStatus dyn_se3_log(size_t count, const double* X, double* twist);
/* Jacobians of exp, 6 x 6 each. left 0: the right one, exp(t + dt) = exp(t) exp(J dt).
   left 1: the left one, exp(t + dt) = exp(J dt) exp(t). To first order in dt. */
DYN_API dynStatus dyn_se3_jexp(size_t count, const double* twist, int left, double* J);
/* Jacobians of log at X: the inverse of dyn_se3_jexp at twist = log X. */
DYN_API dynStatus dyn_se3_jlog(size_t count, const double* X, int left, double* J);
/* X0 exp(u log(X0^-1 X1)): from X0 (u = 0) to X1 (u = 1) at a constant velocity in the body's axes. */
DYN_API dynStatus dyn_se3_interpolate(size_t count, const double* X0, const double* X1, const double* u,
                                      double* X);
/* Of homogeneous matrices, 4 x 4 each. The last row must be 0 0 0 1 (DYN_ERROR_INVALID). */
DYN_API dynStatus dyn_se3_from_matrix(size_t count, const double* matrix, double* X);
DYN_API dynStatus dyn_se3_to_matrix(size_t count, const double* X, double* matrix);
/* Of q = [position; quaternion], 7 each, as a free flyer has it. */
DYN_API dynStatus dyn_se3_from_quaternion(size_t count, const double* q, double* X);
/* The quaternion has norm 1 and w >= 0. */
DYN_API dynStatus dyn_se3_to_quaternion(size_t count, const double* X, double* q);
/* Of [translation; roll, pitch, yaw], 6 each, as an <origin> of URDF has it. */
DYN_API dynStatus dyn_se3_from_rpy(size_t count, const double* xyz_rpy, double* X);
DYN_API dynStatus dyn_se3_to_rpy(size_t count, const double* X, double* xyz_rpy);

/* -------------------------------------------------------------------------------- other libraries' states */

/* How a peer library stores the state of the same robot. Joint coordinates are libdyn's, with the exceptions
   below. In MUJOCO, DRAKE and ROS a free joint's pose is in the world, even if the joint was placed
   elsewhere. (Under another joint the pose is in that parent's frame.) A joint of several coordinates is
   several joints of the peer, in order. Accelerations are derivatives of the peer's v. Forces are dual: tau .
   v is the same power. */
typedef enum dynConvention {
  DYN_CONVENTION_DYN = 0, /* libdyn's own storage. */
  /* Continuous joints are (cos, sin); planar joints are (x, y, cos, sin) with the velocity in the body's
     axes. */
  DYN_CONVENTION_PINOCCHIO = 1,
  /* Quaternions are (w, x, y, z); a free joint has v = [linear in the world's axes; angular in the
     body's]. */
  DYN_CONVENTION_MUJOCO = 2,
  /* A free joint has q = [quaternion (w, x, y, z); position] and v = [angular; linear] in the world's axes;
     ball joints have (roll, pitch, yaw), R = Rz(yaw) Ry(pitch) Rx(roll), and an angular velocity in the axes
     of their parent. */
  DYN_CONVENTION_DRAKE = 3,
  /* A floating base is nav_msgs/Odometry, with pose [position; quaternion (x, y, z, w)] and twist [linear;
     angular] in the axes of child_frame; other joints are sensor_msgs/JointState with one coordinate each. */
  DYN_CONVENTION_ROS = 4
} dynConvention;
/* Storage of continuous joints. */
typedef enum dynAngle {
  DYN_ANGLE_BY_CONVENTION = 0, /* As the convention has it; for DYN as in the model. */
  DYN_ANGLE_PLAIN = 1,         /* An angle. */
  DYN_ANGLE_COS_SIN = 2        /* (cos, sin). */
} dynAngle;
/* Direction of a conversion. */
typedef enum dynDirection {
  DYN_DIRECTION_TO_PEER = 0,  /* From the model's storage to the peer's. */
  DYN_DIRECTION_FROM_PEER = 1 /* From the peer's storage to the model's. */
} dynDirection;

typedef struct dynStateLayout {
  uint32_t struct_size; /* set by dyn_state_layout_init */
  dynConvention convention;
  /* names of this model's joints in the peer's order. NULL: the model's order, with mimic followers for
     MUJOCO, DRAKE and ROS, without for others. */
  const char* const* joints;
  size_t joints_count;
  /* first index of each joint in the peer's q and v; NULL both: one after another */
  const int32_t *idx_q, *idx_v;
  int32_t nq, nv;       /* the peer's sizes; 0: up to the end of the last joint */
  dynAngle continuous;
  /* frame on the floating base's body that has the pose and velocity; NULL: the joint's own */
  const char* child_frame;
} dynStateLayout;
/* Sets convention DYN, with all joints in the model's order. */
DYN_API void dyn_state_layout_init(dynStateLayout* layout, uint32_t struct_size);
#define dyn_state_layout_init(x) dyn_state_layout_init(x, sizeof(dynStateLayout))
/* Sizes of the peer's q and v. */
DYN_API dynStatus dyn_state_layout_sizes(const dynModel* model, const dynStateLayout* layout, int* nq,
                                         int* nv);
typedef struct dynStateInput {
  uint32_t struct_size; /* set by dyn_state_input_init */
  const double *q, *v, *a, *tau;
} dynStateInput;
DYN_API void dyn_state_input_init(dynStateInput* in, uint32_t struct_size);
#define dyn_state_input_init(x) dyn_state_input_init(x, sizeof(dynStateInput))
typedef struct dynStateOutput {
  uint32_t struct_size; /* set by dyn_state_output_init */
  double *q, *v, *a, *tau;
} dynStateOutput;
DYN_API void dyn_state_output_init(dynStateOutput* out, uint32_t struct_size);
#define dyn_state_output_init(x) dyn_state_output_init(x, sizeof(dynStateOutput))
/* Converts one state between the model (q: nq; v, a, tau: nv) and the peer (sizes of the layout). q is
   required. v, a and tau may be NULL, but a needs v. Each output may be NULL, and needs its input. Every
   joint that moves by itself must be in the layout. To the peer, a follower gets its leader's coordinates and
   no force. From the peer, a follower's q, v, a are not read, and its force is added to its leader's. Other
   numbers of the peer are neither read nor written. Outputs must not overlap inputs. Angles from (cos, sin)
   are in (-pi, pi]. */
DYN_API dynStatus dyn_state_layout_convert(const dynModel* model, const dynStateLayout* layout,
                                           dynDirection direction, const dynStateInput* in,
                                           const dynStateOutput* out);

/* ------------------------------------------------------------------------------------- inverse kinematics */

/* Kind of an inverse kinematics task. */
typedef enum dynIkTaskType {
  DYN_IK_TASK_TYPE_POSE = 1, /* Frame at target: error log6(target^-1 X_WF), 6, in the frame's axes. */
  /* Origin of the frame at target's translation: error 3, axes of the world. */
  DYN_IK_TASK_TYPE_POSITION = 2,
  /* Axes of the frame along target's rotation: error log3, 3, in the frame's axes. */
  DYN_IK_TASK_TYPE_ORIENTATION = 3,
  /* Centre of mass at target's translation: error 3, axes of the world; frame is ignored. */
  DYN_IK_TASK_TYPE_COM = 4,
  /* q at posture: error dyn_difference(posture, q), nv; frame and target are ignored. */
  DYN_IK_TASK_TYPE_POSTURE = 5
} dynIkTaskType;

/* One task. The cost is the sum over tasks and components of (weight weights[k] error[k])^2 / 2. */
typedef struct dynIkTask {
  uint32_t struct_size;  /* set by dyn_ik_task_init */
  dynIkTaskType type;
  int32_t frame;
  int32_t priority;      /* 0: must be met; 1: met in the null space of priority 0 */
  double target[12]; /* placement in the world, default identity; the type ignores what it does not need */
  const double* posture; /* DYN_IK_TASK_TYPE_POSTURE: nq */
  double weight;         /* default 1 */
  const double* weights; /* one for each component of the error; NULL: ones. 0 leaves a component free. */
} dynIkTask;
DYN_API void dyn_ik_task_init(dynIkTask* task, uint32_t struct_size);
#define dyn_ik_task_init(x) dyn_ik_task_init(x, sizeof(dynIkTask))

typedef struct dynIkOptions {
  uint32_t struct_size;     /* set by dyn_ik_options_init */
  int32_t max_iterations;   /* of each start, and once more for the best failed start; default 500 */
  int32_t restarts; /* random starts after the first, until all tasks of priority 0 are met; default 20 */
  uint64_t seed;            /* of the random starts: the same seed gives the same result */
  double tolerance_linear;  /* m, default 1e-6: a task of priority 0 is met when its error is within both */
  double tolerance_angular; /* rad, default 1e-6 */
  int32_t limits;           /* 0: joint limits are ignored; default 1 */
  /* nq each; NULL: the model's. Equal ones lock a coordinate. Quaternions and (cos, sin) have none. */
  const double *lower, *upper;
} dynIkOptions;
DYN_API void dyn_ik_options_init(dynIkOptions* options, uint32_t struct_size);
#define dyn_ik_options_init(x) dyn_ik_options_init(x, sizeof(dynIkOptions))

/* Why inverse kinematics ended. Without convergence the result is the best q found: a local optimum of the
   cost, unless the iterations ran out. */
typedef enum dynIkReason {
  DYN_IK_REASON_CONVERGED = 0,     /* Every task of priority 0 is met. */
  DYN_IK_REASON_LIMITS = 1,        /* A limit of dynIkResult.joint holds the tasks back. */
  /* The tasks' Jacobian has lost rank: no joint moves along the error, as when out of reach. */
  DYN_IK_REASON_SINGULAR = 2,
  /* No motion lowers the cost: tasks contradict each other, or restarts are too few. */
  DYN_IK_REASON_LOCAL_MINIMUM = 3,
  DYN_IK_REASON_MAX_ITERATIONS = 4 /* max_iterations were not enough. */
} dynIkReason;

typedef struct dynIkResult {
  uint32_t struct_size;
  dynIkReason reason;
  int32_t iterations;      /* of all starts */
  int32_t restarts;        /* restarts made */
  int32_t joint;           /* DYN_IK_REASON_LIMITS: the joint whose limit presses most; otherwise -1 */
  double residual_linear;  /* m: largest of the tasks of priority 0 */
  double residual_angular; /* rad */
  double cost;             /* of the tasks of priority 0 */
  /* KKT residual of that cost: largest |gradient| over coordinates not pressed against a limit */
  double optimality;
} dynIkResult;

typedef struct dynIkOutput {
  uint32_t struct_size; /* set by dyn_ik_output_init */
  double* solution;     /* nq */
  double* residuals;    /* 2 x ntasks: the error of each task (m; rad), without components of weight 0 */
  dynIkResult* result;  /* required */
} dynIkOutput;
DYN_API void dyn_ik_output_init(dynIkOutput* out, uint32_t struct_size);
#define dyn_ik_output_init(x) dyn_ik_output_init(x, sizeof(dynIkOutput))

/* Inverse kinematics: the q that minimises the cost within the joint limits. Levenberg-Marquardt on the
   manifold, damping by Sugihara (2011). It starts at q, moved into the limits. tasks: an array of ntasks.
   options NULL: defaults. out is required. Afterwards data is at the solution, and frame queries
   may follow. Missing convergence is no error: see dynIkResult.reason. To follow a moving target pass
   restarts = 0. Needs part IK. */
DYN_API dynStatus dyn_ik(const dynModel* model, dynData* data, const double* q, const dynIkTask* tasks,
                         int ntasks, const dynIkOptions* options, const dynIkOutput* out);

/* -------------------------------------------------------------------------------------------- constraints */

/* Constraints between bodies or joints. A constraint lies in a slot of the data. The first
   dyn_model_nconstraints(model) slots hold the model's own. Spare slots follow
   (dynLoadOptions.constraint_slots, dyn_builder_set_constraint_slots): a program sets them as it goes, for
   feet that touch down or objects that are grasped. C(q) are the rows of the enabled constraints in the order
   of their slots, J their Jacobian, lambda the forces of the rows:
     M ddq + nle = tau + J' lambda        J ddq + drift = - stiffness C - damping J v
   Rows between two frames are the motion of first relative to second, in axes of second's placement (the
   world's axes, when second is the universe). lambda acts on first at its placement's origin. The opposite
   acts on second. */
typedef enum dynConstraintType {
  DYN_CONSTRAINT_TYPE_NONE = 0,     /* An empty slot. */
  DYN_CONSTRAINT_TYPE_POINT = 1,    /* 3 rows: contact of a point of first. */
  DYN_CONSTRAINT_TYPE_FRAME = 2,    /* 6 rows: contact of a face of first, [linear; angular]. */
  DYN_CONSTRAINT_TYPE_CONNECT = 3,  /* 3 rows: two points of two bodies coincide. */
  DYN_CONSTRAINT_TYPE_WELD = 4,     /* 6 rows: two frames coincide. */
  DYN_CONSTRAINT_TYPE_DISTANCE = 5, /* 1 row: two points are length apart, as by a rod. */
  /* 6 - nv rows, linear then angular: a joint of joint_type closes a loop, with first as the child of
     second. */
  DYN_CONSTRAINT_TYPE_LOOP = 6,
  /* 1 row: q_first = c0 + c1 q_second + c2 q_second^2 + ..., for joints of one coordinate. second may be 0
     (the builder: "universe"): then q_first = c0. */
  DYN_CONSTRAINT_TYPE_COUPLING = 7,
  /* 1 row: joint first stays within its limits; lambda >= 0 at the lower one, <= 0 at the upper one, else
     0. */
  DYN_CONSTRAINT_TYPE_LIMIT = 8,
  /* 1 row: dry friction in joint first, |lambda| <= force, up to what ddq = - damping v takes. */
  DYN_CONSTRAINT_TYPE_FRICTION = 9
} dynConstraintType;

typedef struct dynConstraint {
  uint32_t struct_size;                  /* set by dyn_constraint_init */
  dynConstraintType type;
  int32_t first, second;                 /* frames (0: the universe); COUPLING, LIMIT, FRICTION: joints */
  double placement1[12], placement2[12]; /* of the constraint in first and in second; default identity */
  dynJointType joint_type;               /* LOOP: any simple joint, except FIXED (use WELD) and FREE_FLYER */
  int32_t enabled;                       /* default 1 */
  double axis[3], axis2[3];              /* LOOP: of the joint, in its placements; default z, x */
  double pitch;                          /* LOOP, helical: m/rad */
  double length;                         /* DISTANCE: m, > 0 */
  double coefficients[5];                /* COUPLING: c0 .. c4; default q_first = q_second */
  double force;                          /* FRICTION: N m or N, >= 0 */
  /* Baumgarte gains, 1/s^2 and 1/s, >= 0. Default 0: dyn_project removes drift. FRICTION: damping 100. */
  double stiffness, damping;
  double restitution;                    /* of impulses, 0 .. 1; default 0 */
} dynConstraint;
DYN_API void dyn_constraint_init(dynConstraint* constraint, uint32_t struct_size, dynConstraintType type);
#define dyn_constraint_init(x, type) dyn_constraint_init(x, sizeof(dynConstraint), type)

#ifndef DYN_BARE
/* Adds a constraint to the builder. The names first and second, of frames or joints, replace the ids in
   constraint. second NULL: the universe. */
DYN_API dynStatus dyn_builder_add_constraint(dynBuilder* builder, const char* name,
                                             const dynConstraint* constraint, const char* first,
                                             const char* second);
/* Spare slots of the model, 0 to 1000; default 8. */
DYN_API dynStatus dyn_builder_set_constraint_slots(dynBuilder* builder, int slots);
/* Contact points that a step can hold, 1 to 10^6, at about 4 kB of data each; half as many with rolling. Of
   more points the deepest count; dynStepReport.dropped is the number left out. 0: 16, and for a shape that
   moves 1 (sphere, ellipsoid), 6 (each of the first 12 hulls and meshes) or 2; of a single body that flies 8,
   12 or 24; at most 50,000. */
DYN_API dynStatus dyn_builder_set_contact_capacity(dynBuilder* builder, int contacts);
#endif
/* Returns the contact points that a step of this model can hold. */
DYN_API int dyn_model_contact_capacity(const dynModel* model);
/* Returns the number of constraints of the model. */
DYN_API int dyn_model_nconstraints(const dynModel* model);
DYN_API int dyn_model_nconstraint_slots(const dynModel* model); /* nconstraints plus the spare slots */
/* Returns the name of a constraint, or NULL when out of range. */
DYN_API const char* dyn_model_constraint_name(const dynModel* model, int constraint);
/* Returns the id of a constraint by name, or -1. */
DYN_API int dyn_model_constraint_id(const dynModel* model, const char* name);
/* Describes a constraint of the model. */
DYN_API dynStatus dyn_model_constraint_info(const dynModel* model, int constraint, dynConstraint* out);

/* Slots of a data. They need part CONSTRAINTS. Every change makes results of constraints stale. All slots
   together have at most the rows of the model's constraints and six for each spare slot (DYN_ERROR_LIMIT).
   NULL empties a slot. */
DYN_API dynStatus dyn_data_set_constraint(const dynModel* model, dynData* data, int slot,
                                          const dynConstraint* constraint);
/* Writes the constraint of a slot. */
DYN_API dynStatus dyn_data_constraint(const dynModel* model, dynData* data, int slot,
                                      dynConstraint* constraint);
/* Switches the constraint of a slot on or off. */
DYN_API dynStatus dyn_data_set_constraint_enabled(const dynModel* model, dynData* data, int slot,
                                                  int enabled);
/* Moves placement2 so that the constraint of a slot holds at q: a foot stays in place. Includes placements.
   */
DYN_API dynStatus dyn_data_anchor_constraint(const dynModel* model, dynData* data, int slot, const double* q);
/* Number of enabled rows. With slot >= 0: the first row of that slot and its rows (0 when it is empty or
   off). */
DYN_API dynStatus dyn_data_constraint_rows(const dynModel* model, dynData* data, int slot, int* first,
                                           int* rows);

/* C, J v and drift (the rows' acceleration at ddq = 0), rows numbers each; J, rows x nv. Includes placements.
   */
DYN_API dynStatus dyn_constraint_terms(const dynModel* model, dynData* data, const double* q, const double* v,
                                       double* C, double* J, double* Jv, double* drift);

/* How a solution of constraints ended. */
typedef enum dynConstraintReason {
  DYN_CONSTRAINT_REASON_CONVERGED = 0, /* Solved to the tolerance, but for misaligned redundant rows. */
  /* No motion satisfies all rows: the result is least-squares, each row weighted by its inverse Delassus
     entry. */
  DYN_CONSTRAINT_REASON_CONTRADICTORY = 1,
  DYN_CONSTRAINT_REASON_MAX_ITERATIONS = 2 /* max_iterations were not enough. */
} dynConstraintReason;

typedef struct dynConstraintOptions {
  uint32_t struct_size;   /* set by dyn_constraint_options_init */
  int32_t max_iterations; /* proximal iterations; default 100 */
  /* relative to each row's Delassus entry; default 0: none for independent rows, else 1e-9 */
  double regularisation;
  double tolerance;       /* of the rows' residual, relative to their right-hand sides; default 1e-12 */
} dynConstraintOptions;
DYN_API void dyn_constraint_options_init(dynConstraintOptions* options, uint32_t struct_size);
#define dyn_constraint_options_init(x) dyn_constraint_options_init(x, sizeof(dynConstraintOptions))

typedef struct dynConstraintResult {
  uint32_t struct_size;
  dynConstraintReason reason;
  int32_t rows, rank;    /* rank of the active rows */
  int32_t iterations;
  /* largest |J ddq + drift + stiffness C + damping J v| of the active rows; for impulses of their
     velocities */
  double residual;
  double contradiction;  /* the part of the residual that no motion can remove */
  double condition; /* of the Delassus matrix with unit diagonal, independent rows: an estimate from pivots */
  double regularisation; /* the value used */
} dynConstraintResult;

typedef struct dynConstrainedOutput {
  uint32_t struct_size;        /* set by dyn_constrained_output_init */
  double *ddq, *tau;           /* nv each; a function writes the one that it computes */
  double* lambda;              /* rows */
  dynConstraintResult* result;
} dynConstrainedOutput;
DYN_API void dyn_constrained_output_init(dynConstrainedOutput* out, uint32_t struct_size);
#define dyn_constrained_output_init(x) dyn_constrained_output_init(x, sizeof(dynConstrainedOutput))

/* Constrained forward dynamics: ddq and lambda. options NULL: defaults. Redundant
   rows are allowed: ddq is unique, and lambda is the least one in the weighted norm. Proximal iteration on a
   Delassus matrix that is factored once (Carpentier, Budhiraja, Mansard 2021). The matrix comes from
   articulated inertias, in a time that grows with the depth of the constrained bodies (Sathya, Carpentier
   2024). Limits and friction are exact, by an active set. Missing convergence is no error: see
   dynConstraintResult.reason. Includes placements. */
DYN_API dynStatus dyn_constrained_dynamics(const dynModel* model, dynData* data, const double* q,
                                           const double* v, const double* tau, const double* fext,
                                           const dynConstraintOptions* options,
                                           const dynConstrainedOutput* out);
/* tau (nv) and lambda (rows) for a given acceleration. actuated has nv numbers, 0: not actuated. NULL: all
   but free flyers on the world are actuated. Where not actuated, tau is zero, and lambda is the least that
   holds these degrees of freedom (least-squares when none does). The others get tau = M a + nle - J' lambda -
   J' fext. result->residual is the largest |tau| missing where not actuated. */
DYN_API dynStatus dyn_constrained_inverse_dynamics(const dynModel* model, dynData* data, const double* q,
                                                   const double* v, const double* a, const double* fext,
                                                   const int32_t* actuated, const dynConstrainedOutput* out);
/* Impact: J v_plus = - restitution J v, M (v_plus - v) = J' lambda. v_plus: nv; lambda: impulses, rows. A
   limit takes part when it is reached and approached. */
DYN_API dynStatus dyn_constraint_impulse(const dynModel* model, dynData* data, const double* q,
                                         const double* v, const dynConstraintOptions* options, double* v_plus,
                                         double* lambda, dynConstraintResult* result);

typedef struct dynProjectOptions {
  uint32_t struct_size;   /* set by dyn_project_options_init */
  int32_t max_iterations; /* default 100 */
  int32_t weigh;          /* 1 (default): steps of least kinetic energy; 0: steps of least coordinate norm */
  double tolerance;       /* largest |C|; default 1e-12 */
} dynProjectOptions;
DYN_API void dyn_project_options_init(dynProjectOptions* options, uint32_t struct_size);
#define dyn_project_options_init(x) dyn_project_options_init(x, sizeof(dynProjectOptions))
/* Projects q, and v when v_out is not NULL, to the nearest values that satisfy the constraints: damped
   Gauss-Newton on the manifold. q_out: nq; v_out: nv. Contradictory constraints give the least-squares q, and
   result->reason says so. Rows that are redundant but for a misalignment (5e-4) are left out, as in steps: a
   rounded axis does not move q far. A result that converged so has the error left as its residual and
   contradiction. When no small step makes |C| less (a linkage stretched flat), it restarts from beside,
   twice, with max_iterations each. data is left at the solution. */
DYN_API dynStatus dyn_project(const dynModel* model, dynData* data, const double* q, const double* v,
                              const dynProjectOptions* options, double* q_out, double* v_out,
                              dynConstraintResult* result);

/* The Delassus matrix G = J M^-1 J', in four forms. Dense: rows x rows. Includes placements. */
DYN_API dynStatus dyn_delassus(const dynModel* model, dynData* data, const double* q, double* G);
/* Factored: G = Y' diag(D) Y. Y is nv x rows with the sparsity of the tree: row k of a constraint is zero
   unless degree of freedom k moves it. D is nv. */
DYN_API dynStatus dyn_delassus_factor(const dynModel* model, dynData* data, const double* q, double* Y,
                                      double* D);
/* out = G x by the factors, without forming G. */
DYN_API dynStatus dyn_delassus_times(const dynModel* model, dynData* data, const double* q, const double* x,
                                     double* out);
/* out = (G + mu 1)^-1 x, mu > 0. mu = 0 needs independent rows (DYN_ERROR_NUMERIC). */
DYN_API dynStatus dyn_delassus_solve(const dynModel* model, dynData* data, const double* q, double mu,
                                     const double* x, double* out);

/* Analytic derivatives of dyn_constrained_dynamics on the tangent space. ddq_...: nv x nv; lambda_...: rows x
   nv. Any output may be NULL. Of redundant rows lambda is the least-norm one. result as there. Needs part
   CONSTRAINT_DERIVATIVES. */
typedef struct dynConstraintDerivatives {
  uint32_t struct_size; /* set by dyn_constraint_derivatives_init */
  double *ddq_dq, *ddq_dv, *ddq_dtau;
  double *lambda_dq, *lambda_dv, *lambda_dtau;
  dynConstraintResult* result;
} dynConstraintDerivatives;
DYN_API void dyn_constraint_derivatives_init(dynConstraintDerivatives* out, uint32_t struct_size);
#define dyn_constraint_derivatives_init(x) \
  dyn_constraint_derivatives_init(x, sizeof(dynConstraintDerivatives))
DYN_API dynStatus dyn_constrained_dynamics_derivatives(const dynModel* model, dynData* data, const double* q,
                                                       const double* v, const double* tau, const double* fext,
                                                       const dynConstraintOptions* options,
                                                       const dynConstraintDerivatives* out);
/* The same for dyn_constraint_impulse: v_plus replaces ddq. Derivatives by tau are not written. */
DYN_API dynStatus dyn_constraint_impulse_derivatives(const dynModel* model, dynData* data, const double* q,
                                                     const double* v, const dynConstraintOptions* options,
                                                     const dynConstraintDerivatives* out);

/* Constraint diagnostics: finds redundant and contradictory rows of the enabled constraints at q. */
typedef enum dynRowVerdict {
  DYN_ROW_VERDICT_INDEPENDENT = 0,   /* No combination of other rows gives this row. */
  DYN_ROW_VERDICT_REDUNDANT = 1,     /* Other rows give this row and agree with it. */
  DYN_ROW_VERDICT_CONTRADICTORY = 2, /* Other rows give this row but disagree: no q nearby satisfies all. */
  DYN_ROW_VERDICT_IMMOBILE = 3       /* No moving body changes this row. */
} dynRowVerdict;
typedef struct dynRowReport {
  int32_t slot, row; /* row: within its constraint */
  dynRowVerdict verdict;
  double share; /* 0 .. 1: share of the row that others make up: its squared part in the null space of J' */
  double error;      /* C of the row */
} dynRowReport;
typedef struct dynConstraintReport {
  uint32_t struct_size;
  int32_t rows, rank, redundant, contradictory;
  double condition; /* of the Delassus matrix with unit diagonal, independent rows, from eigenvalues */
  double smallest, largest;    /* its non-zero eigenvalues */
  double error, contradiction; /* largest |C|, and the part of it that no small motion can remove */
} dynConstraintReport;
/* rows_out: room for `capacity` rows; NULL: none. Includes placements. */
DYN_API dynStatus dyn_constraint_report(const dynModel* model, dynData* data, const double* q,
                                        dynConstraintReport* report, dynRowReport* rows_out, int capacity);

/* ---------------------------------------------------------------------------------------------- collision */

/* Surfaces. The distance to TRIANGLES is the least signed distance of any triangle, each a flat shape of its
   own. A shape inside a closed mesh that touches no triangle penetrates it. A sphere is then as deep as its
   centre says, also where it touches. Any other shape is as deep as it lies below the plane of the nearest
   triangle. Then unique = 0, and residual is the difference between that depth and the depth of its middle.
   Where triangles are crossed, the depth is that of the deepest triangle, or pair of triangles: separating
   them may leave other overlaps. Two closed meshes that coincide touch. A HEIGHT_FIELD is solid from its
   surface to its bottom, one prism for each triangle. Overlaps are measured prism by prism, right while less
   deep than a cell is wide. */

/* Signed distance of two shapes. Below zero they overlap, and it is minus the depth: the length of the
   shortest separating translation. Two half-spaces: minus infinity unless they face each other. Closed forms
   where there are any, else GJK (Gilbert et al. 1988) and EPA (van den Bergen 2003), finished by Newton's
   method on the normal. Supporting planes check the result: residual bounds the error, and for a depth the
   error along this normal. */
typedef enum dynDistanceStatus {
  DYN_DISTANCE_STATUS_SEPARATED = 0,   /* The shapes are apart. */
  DYN_DISTANCE_STATUS_TOUCHING = 1,    /* |distance| is within 1e-9 of the size of the smaller shape. */
  DYN_DISTANCE_STATUS_PENETRATING = 2, /* The shapes overlap. */
  DYN_DISTANCE_STATUS_FAILED = 3       /* The residual is above 1e-6 of that size: the best result found. */
} dynDistanceStatus;

/* Algorithm of a distance. */
typedef enum dynDistanceMethod {
  DYN_DISTANCE_METHOD_GJK = 0, /* libdyn's own GJK and EPA, with closed forms. */
  /* libccd's GJK and EPA for overlapping shapes without a closed form, GJK for others; it allocates. */
  DYN_DISTANCE_METHOD_CCD = 1
} dynDistanceMethod;

typedef struct dynDistance {
  uint32_t struct_size;
  dynDistanceStatus status;
  int32_t unique;                /* 0: other points or normals are as good, so the distance has no gradient */
  int32_t iterations;
  dynDistanceMethod method;      /* the method that found this */
  double distance;               /* m */
  double residual;               /* m */
  double normal[3];              /* unit, from A to B, world */
  double point_a[3], point_b[3]; /* witness points, world: point_b - point_a = distance normal */
} dynDistance;

/* A shape by itself, at the origin of its frame. radius rounds it: points within that distance belong to it.
   */
typedef struct dynGeometry {
  uint32_t struct_size;   /* set by dyn_geometry_init */
  dynShapeType type;      /* any but MESH */
  double size[3];         /* as in dynShapeInfo */
  double radius;          /* m, >= 0; of rounding */
  const dynMesh* surface; /* as in dynShapeSpec */
} dynGeometry;
DYN_API void dyn_geometry_init(dynGeometry* geometry, uint32_t struct_size);
#define dyn_geometry_init(x) dyn_geometry_init(x, sizeof(dynGeometry))

/* Two shapes by themselves, and where they are. */
typedef struct dynGeometryPair {
  uint32_t struct_size;                    /* set by dyn_geometry_pair_init */
  const dynGeometry *a, *b;
  const double *placement_a, *placement_b; /* 12 each */
  /* 6 each, read by dyn_geometry_sweep: [velocity of the frame's origin; angular velocity], world axes, m/s
     and rad/s, constant; NULL: at rest */
  const double *motion_a, *motion_b;
} dynGeometryPair;
DYN_API void dyn_geometry_pair_init(dynGeometryPair* pair, uint32_t struct_size);
#define dyn_geometry_pair_init(x) dyn_geometry_pair_init(x, sizeof(dynGeometryPair))

typedef struct dynDistanceOptions {
  uint32_t struct_size; /* set by dyn_distance_options_init */
  /* tried first; default GJK. The other one is tried when the residual is above 1e-6 of the size and above
     the tolerance. */
  dynDistanceMethod method;
  double tolerance;     /* of the distance, relative to the size of the smaller shape; default 1e-10 */
} dynDistanceOptions;
DYN_API void dyn_distance_options_init(dynDistanceOptions* options, uint32_t struct_size);
#define dyn_distance_options_init(x) dyn_distance_options_init(x, sizeof(dynDistanceOptions))
/* options NULL: defaults. CCD needs the library libccd.so.2: otherwise DYN_ERROR_UNSUPPORTED. */
DYN_API dynStatus dyn_geometry_distance(const dynGeometry* a, const double placement_a[12],
                                        const dynGeometry* b, const double placement_b[12],
                                        const dynDistanceOptions* options, dynDistance* out);

/* Pairs of a robot's collision shapes. Never tested: pairs of one body, and of a body and its parent. The
   world is nobody's parent, but a link fixed to the world is the parent of a joint's link on it, except in an
   MJCF. Joints on one another without mass between them, as those of one body of an MJCF, count as one. The
   flag filterparent="disable" of an MJCF pairs parents, too. A model of more than 1,000 shapes lists only
   some pairs: wanted (dyn_builder_add_pair), disabled and overlapping ones. Its other pairs are tested, if
   their masks match, in steps and by dyn_contacts. Functions that number pairs (dyn_distances,
   dyn_smooth_distances, dyn_collisions) then return DYN_ERROR_LIMIT. */
typedef enum dynPairReason {
  DYN_PAIR_REASON_TESTED = 0,   /* The pair is tested. */
  /* The shapes overlap in the neutral configuration and in at least 31 of 32 random ones within the limits,
     and neither flies freely relative to the other. The load report names their links. Never given to shapes
     of an MJCF, nor to those of a URDF with an SRDF that disables pairs: these list the pairs themselves. */
  DYN_PAIR_REASON_OVERLAPS = 1,
  DYN_PAIR_REASON_MESH = 2, /* A shape is a mesh of which only the file's name is known: see dynMeshUse. */
  DYN_PAIR_REASON_OFF = 3,      /* The pair is switched off in the data. */
  DYN_PAIR_REASON_DISABLED = 4, /* The SRDF disables the pair: see dyn_model_disabled_pair. */
  /* Their groups do not collide: a pair is tested when contype of one & conaffinity of the other (MuJoCo's
     rule). */
  DYN_PAIR_REASON_MASK = 5
} dynPairReason;
DYN_API int dyn_model_npairs(const dynModel* model); /* -1 for an invalid handle */
/* The shapes of a pair, shape_a < shape_b, and whether new data tests it. Any output may be NULL. */
DYN_API dynStatus dyn_model_pair(const dynModel* model, int pair, int* shape_a, int* shape_b,
                                 dynPairReason* reason);
/* Switches a pair on or off; pair -1: all pairs without meshes (DYN_ERROR_LIMIT where not all are listed). */
DYN_API dynStatus dyn_data_set_pair(const dynModel* model, dynData* data, int pair, int tested);
/* Writes whether this data tests a pair, and why not. */
DYN_API dynStatus dyn_data_pair(const dynModel* model, dynData* data, int pair, dynPairReason* reason);

/* Groups of a collision shape in the data (shape -1: of all shapes): contype, its own groups, and
   conaffinity, the groups to collide with. New data has the model's. Pairs without a common group are not
   tested (DYN_PAIR_REASON_MASK). Pairs untested for that reason alone are tested again. A later
   dyn_data_set_pair overrides. */
DYN_API dynStatus dyn_data_set_shape_masks(const dynModel* model, dynData* data, int shape, uint32_t contype,
                                           uint32_t conaffinity);
/* Writes the groups of a collision shape in this data. */
DYN_API dynStatus dyn_data_shape_masks(const dynModel* model, dynData* data, int shape, uint32_t* contype,
                                       uint32_t* conaffinity);

/* Distances of all pairs (m), npairs; infinite for an untested pair. Includes placements. Needs part
   COLLISION. */
DYN_API dynStatus dyn_distances(const dynModel* model, dynData* data, const double* q, double* distances);
/* The result for a pair. Needs dyn_distances of the current q. */
DYN_API dynStatus dyn_pair_distance(const dynModel* model, dynData* data, int pair, dynDistance* out);
/* Derivatives of all distances by q on the tangent space, npairs x nv. Zero for an untested pair, and where
   witness points are not unique (dynDistance.unique). Needs dyn_distances of the current q. */
DYN_API dynStatus dyn_distance_gradients(const dynModel* model, dynData* data, double* gradients);
/* Pairs at a distance of at most margin (m, >= 0), ascending. At most capacity of them are written; *count is
   the total. Pairs whose bounding boxes are farther apart cost almost nothing. Includes placements. Needs
   part COLLISION. */
DYN_API dynStatus dyn_collisions(const dynModel* model, dynData* data, const double* q, double margin,
                                 int* pairs, int capacity, int* count);

/* ----------------------------------------------------------------------------------------------- contacts */

/* Contact points: where the facing faces, edges and caps of two shapes overlap, seen along their common
   normal (that of dyn_geometry_distance). A pair has up to eight points at a distance of at most margin (m,
   >= 0). Of more, the deepest stays, and those that span the largest area (Visvalingam and Whyatt 1993). A
   circular cap is the octagon of eight points that turn with it, plus the deepest point. Two half-spaces have
   no points. */
typedef struct dynContact {
  int32_t pair;             /* of the robot's; -1: shapes by themselves, or the pair is not listed */
  int32_t shape_a, shape_b; /* of the robot's; -1: shapes by themselves */
  int32_t reserved;         /* 0 */
  /* corner, edge or inside of A (high 32 bits) and of B: the same contact has the same feature in the next
     step */
  uint64_t feature;
  double distance;          /* m, along the normal; below zero: depth */
  /* world, half way between the shapes: position -/+ distance / 2 normal lie on A and B */
  double position[3];
  double normal[3];         /* unit, from A to B, world */
} dynContact;
enum {
  DYN_MAX_CONTACTS_PER_PAIR = 8 /* The most contact points of a pair. */
};
/* Contact points of two shapes. contacts: room for DYN_MAX_CONTACTS_PER_PAIR, ascending by feature.
   tolerance: as in dyn_geometry_distance. For surfaces (TRIANGLES, HEIGHT_FIELD): overlaps of all triangles
   that face the other shape, seen along the one normal of the nearest point. Triangles of one plane count
   together. The corners of the points' convex hull and the deepest point stay. Features are then numbers of
   the mesh's vertices, by 2^16. */
DYN_API dynStatus dyn_geometry_contacts(const dynGeometryPair* pair, double margin, double tolerance,
                                        dynContact* contacts, int* count);
/* Contact points of all tested pairs, ascending by shapes (which is by pair), then by feature. At most
   capacity of them are written; *count is the total. Includes placements. Needs part COLLISION. */
DYN_API dynStatus dyn_contacts(const dynModel* model, dynData* data, const double* q, double margin,
                               dynContact* contacts, int capacity, int* count);

/* Smooth distances of all pairs and their gradients by q, without kinks where faces or edges lie along each
   other. A distance is the soft minimum of the gaps g_i of the contact points (Boyd and Vandenberghe 2004,
   3.1.5):
     d = -s log sum exp(-g_i / s), s = smoothing (m, > 0)
   It lies at most s log 8 below the distance. The gradient, on the tangent space, is exact where the features
   are parallel or one point counts alone. In between its error is of the order of s over their size.
   distances: npairs, infinite for an untested pair. gradients: npairs x nv. points (npairs): how many points
   count (1: the plain distance, more: smoothed, 0: untested). Any output may be NULL. Includes placements.
   Needs part COLLISION. */
DYN_API dynStatus dyn_smooth_distances(const dynModel* model, dynData* data, const double* q,
                                       double smoothing, double* distances, double* gradients, int* points);

/* ----------------------------------------------------------------------------------- rays, points, sweeps */

/* The first point of a ray in a solid: origin + t direction, t >= 0 (0: the origin lies inside). */
typedef struct dynRayHit {
  uint32_t struct_size;
  int32_t shape;      /* of the robot's; -1: no hit; 0 for a shape by itself */
  double t;           /* in lengths of the direction; infinite: no hit */
  double position[3]; /* world */
  double normal[3];   /* outward unit normal, world */
} dynRayHit;
/* Casts a ray at a shape. direction has any length but zero. */
DYN_API dynStatus dyn_geometry_ray(const dynGeometry* shape, const double placement[12],
                                   const double origin[3], const double direction[3], dynRayHit* out);

typedef struct dynRays {
  uint32_t struct_size;     /* set by dyn_rays_init */
  int32_t count;
  uint32_t mask;            /* groups: shapes with contype & mask are hit; default 0xffffffff: any group */
  const double* origins;    /* 3 x count */
  const double* directions; /* 3 x count */
  double max_t;             /* in lengths of a direction, > 0; default infinite */
} dynRays;
DYN_API void dyn_rays_init(dynRays* rays, uint32_t struct_size);
#define dyn_rays_init(x) dyn_rays_init(x, sizeof(dynRays))

/* Rays against the robot's collision shapes, without meshes. t (count): as in dynRayHit, up to max_t.
   shapes: count. normals: 3 x count, zero without a hit. Any output may be NULL. Includes placements. Needs
   part COLLISION. */
DYN_API dynStatus dyn_rays(const dynModel* model, dynData* data, const double* q, const dynRays* rays,
                           double* t, int* shapes, double* normals);

/* The point of a shape's surface closest to a given point. Closed forms; for an ellipsoid Eberly 2013. */
typedef struct dynClosestPoint {
  uint32_t struct_size;
  int32_t unique;   /* 0: another point is as near */
  double distance;  /* m; below zero inside */
  double point[3];  /* on the surface, world */
  double normal[3]; /* outward unit normal there: the given point is point + distance normal */
} dynClosestPoint;
/* Finds the closest point of a shape's surface. */
DYN_API dynStatus dyn_geometry_closest_point(const dynGeometry* shape, const double placement[12],
                                             const double point[3], dynClosestPoint* out);

/* Time of impact of two moving shapes, by conservative advancement (Mirtich 1996): no wall is too thin.
   A half-space must not turn. duration: s. margin: m. */
typedef enum dynSweepStatus {
  DYN_SWEEP_STATUS_NONE = 0, /* The shapes stay farther apart than margin. */
  /* At that time they are margin apart, to 1e-7 of the smaller size (time 0: they began closer). */
  DYN_SWEEP_STATUS_HIT = 1,
  /* They do not meet before that time; the search ended after a thousand steps close together. */
  DYN_SWEEP_STATUS_UNDECIDED = 2
} dynSweepStatus;
typedef struct dynImpact {
  uint32_t struct_size;
  dynSweepStatus status;
  double time;                   /* s; NONE: the duration */
  double distance;               /* m, at that time */
  double normal[3];              /* unit, from A to B, world */
  double point_a[3], point_b[3]; /* witness points, world */
} dynImpact;
/* Finds the first time within duration at which two moving shapes are margin apart. */
DYN_API dynStatus dyn_geometry_sweep(const dynGeometryPair* pair, double duration, double margin,
                                     dynImpact* out);

/* -------------------------------------------------------------------------------------------- broad phase */

#ifndef DYN_BARE
/* Overlaps of many boxes: a packed bounding-volume tree with eight children a node (Kamel and Faloutsos
   1993). Boxes are stored larger by margin, so that a box that moves less costs one comparison. Overlaps are
   kept between queries, and only boxes that left their margin are searched again. No allocation after
   creation. One thread at a time. Boxes have lower <= upper, in the world, and may be infinite. */
typedef struct dynBroadPhase dynBroadPhase;
/* capacity: boxes, up to 2^24. pair_capacity: overlaps of the larger boxes, up to 2^30. margin: m, >= 0. */
DYN_API dynStatus dyn_broad_phase_new(int capacity, int64_t pair_capacity, double margin,
                                      dynBroadPhase** broad_phase);
DYN_API void dyn_broad_phase_free(dynBroadPhase* broad_phase); /* NULL is allowed */
/* *id is the smallest free number. Returns DYN_ERROR_LIMIT when full. */
DYN_API dynStatus dyn_broad_phase_insert(dynBroadPhase* broad_phase, const double lower[3],
                                         const double upper[3], int* id);
/* Moves a box. */
DYN_API dynStatus dyn_broad_phase_update(dynBroadPhase* broad_phase, int id, const double lower[3],
                                         const double upper[3]);
/* Removes a box. Its number is free again. */
DYN_API dynStatus dyn_broad_phase_remove(dynBroadPhase* broad_phase, int id);
/* All pairs of boxes that overlap or touch, smaller number first, ascending. At most capacity of them are
   written (2 numbers each); *count is the total. Returns DYN_ERROR_LIMIT for more overlaps than
   pair_capacity. */
DYN_API dynStatus dyn_broad_phase_pairs(dynBroadPhase* broad_phase, int* pairs, int64_t capacity,
                                        int64_t* count);
/* Boxes that overlap a box, or that the ray origin + t direction meets at 0 <= t <= max_t, ascending. At most
   capacity of them are written; *count is the total. Beyond capacity any of them may be the written ones. */
DYN_API dynStatus dyn_broad_phase_query(dynBroadPhase* broad_phase, const double lower[3],
                                        const double upper[3], int* ids, int capacity, int* count);
DYN_API dynStatus dyn_broad_phase_ray(dynBroadPhase* broad_phase, const double origin[3],
                                      const double direction[3], double max_t, int* ids, int capacity,
                                      int* count);
#endif

/* ------------------------------------------------------------------------------------ the contact problem */

/* Contact with friction on a given Delassus matrix, without a model. Finds impulses lambda and velocities c:
     c = (G + diag(compliance)) lambda + g + bias          rows: equalities, then boxes, then contacts
     equality   c = 0
     box        lower <= lambda <= upper;  c = 0 between them, c >= 0 at lower, c <= 0 at upper
                (limits: 0, infinity; dry friction: -f dt, f dt)
     contact    Signorini: 0 <= lambda_n _|_ c_n >= 0;  Coulomb: |lambda_t| <= mu lambda_n;
                maximum dissipation: a sliding contact has lambda_t = -mu lambda_n c_t / |c_t|
   The cone is exact (no pyramid). Sticking is exact (no creep): K lambda _|_ c + (mu |c_t|, 0) in K* (de
   Saxce and Feng 1998).

   A contact has rows in its own frame, with z the normal that pushes it apart:
     1 row: n, no friction        3 rows: (t1, t2, n)        4 rows: and torsion about n
     6 rows: and rolling, (t1, t2, n, r1, r2, torsion) = [linear; angular]
   With 4 and 6 rows the cone is an ellipsoid (torsion, rolling: m):
     |lambda_t|^2 / friction^2 + |lambda_r|^2 / rolling^2 + lambda_torsion^2 / torsion^2 <= lambda_n^2
   A coefficient of 0 holds its rows at zero. Any consistent unit is right: impulses and velocities, or forces
   and accelerations.

   Restitution e is Moreau's law: c_n + e min(0, v_minus_n) replaces c_n. All impacts happen at once (three
   equal balls, e = 1: -1/3, 2/3, 2/3). This law can gain energy, with friction or different coefficients
   (Kane and Levinson 1985). It can also ask for velocities that no impulses produce. When the impulses' work
   lambda'(g + G lambda / 2) would be positive, or nothing comes near a solution, all coefficients shrink by
   one factor. The report gives it. Finding it takes some eight solves, each with max_iterations. With factor
   0 impulses never do work. */
typedef enum dynContactSolverType {
  /* Projected Gauss-Seidel, each contact exact: cheap sweeps, many for large mass ratios or redundancy;
     fastest in steps at tolerances from 1e-3, which need no matrix. */
  DYN_CONTACT_SOLVER_TYPE_PGS = 0,
  /* Proximal ADMM (Carpentier, Le Lidec and Montaut 2024), finished by Newton's method: robust, the
     default. */
  DYN_CONTACT_SOLVER_TYPE_ADMM = 1,
  /* Interior points with the whole friction law in the equations (Acary et al. 2024), finished by Newton's
     method: for extreme masses. */
  DYN_CONTACT_SOLVER_TYPE_NEWTON = 2
} dynContactSolverType;

typedef struct dynContactProblem {
  uint32_t struct_size;                       /* set by dyn_contact_problem_init, which zeroes the rest */
  int32_t equalities, boxes, contacts;
  const int32_t* contact_rows;                /* contacts: 1, 3, 4 or 6 each; NULL: 3 */
  const double* G; /* rows x rows, symmetric to round-off, positive semi-definite */
  int32_t G_stride;                           /* from column to column; 0: rows */
  const double* g;                            /* rows: free velocity */
  const double *lower, *upper;                /* boxes: lower <= upper, may be infinite */
  const double *friction, *torsion, *rolling; /* contacts, >= 0: 1, m, m; NULL: 0 */
  const double* compliance;                   /* rows, >= 0; NULL: 0, rigid (dyn_contact_compliance) */
  const double* bias;                         /* rows: added to the requested velocity; NULL: 0 */
  const double* restitution;                  /* contacts, 0 to 1; NULL: 0 */
  const double* v_minus; /* rows: velocity before the impact, read in normal rows with restitution; NULL: g */
} dynContactProblem;
DYN_API void dyn_contact_problem_init(dynContactProblem* problem, uint32_t struct_size);
#define dyn_contact_problem_init(x) dyn_contact_problem_init(x, sizeof(dynContactProblem))

typedef struct dynContactOptions {
  uint32_t struct_size;        /* set by dyn_contact_options_init */
  dynContactSolverType solver; /* default ADMM */
  int32_t max_iterations;      /* default 1000 */
  int32_t warm_start;          /* 1: lambda is a first guess; default 0 */
  int32_t newton; /* default 1; 0: admm and newton end without Newton's method on the whole problem */
  double tolerance;            /* of the report's residual; default 1e-10 */
  double time_budget;          /* s; default 0: none, and no clock is read */
  double relaxation;           /* below 2; default 0: the solver's own (pgs 1.1, admm 1.6) */
} dynContactOptions;
DYN_API void dyn_contact_options_init(dynContactOptions* options, uint32_t struct_size);
#define dyn_contact_options_init(x) dyn_contact_options_init(x, sizeof(dynContactOptions))

/* All but CONVERGED return the best iterate, in its cones, with its residual. */
typedef enum dynContactStatus {
  DYN_CONTACT_STATUS_CONVERGED = 0,      /* The residual is at most the tolerance. */
  DYN_CONTACT_STATUS_MAX_ITERATIONS = 1, /* The iterations ran out. */
  DYN_CONTACT_STATUS_TIME_BUDGET = 2,    /* The time budget ran out. */
  /* No progress: a matrix of numbers of very different sizes could not be factored. */
  DYN_CONTACT_STATUS_STALLED = 3
} dynContactStatus;

/* Residuals of lambda: the largest over rows or contacts (Le Lidec et al. 2024, Tsounis et al. 2025). They
   have the caller's units. Torsion and rolling are divided by their lengths torsion / friction and rolling /
   friction. u = c + (mu |c_t|, 0). */
typedef struct dynContactReport {
  uint32_t struct_size;
  dynContactStatus status;
  int32_t iterations;       /* sweeps, alternating steps, joint steps */
  int32_t newton_steps;     /* on the whole problem; with iterations at most max_iterations */
  int32_t factorizations;   /* of matrices of the size of the problem, or of its active part */
  int32_t worst;            /* row of the largest residual; -1: no rows */
  /* largest |y - P_K(y - u)|, divided by the largest velocity without impulses: y is lambda scaled so that G
     has a unit diagonal, each row is a velocity. Independent of units. */
  double residual;
  double primal;            /* dist(lambda, K) */
  double dual;              /* dist(u, K*) */
  double complementarity;   /* |lambda . u| */
  double natural_map;       /* |lambda - P_K(lambda - u)| */
  double signorini;         /* |lambda_n c_n| */
  double dissipation;       /* |c_t| (mu lambda_n - |lambda_t|): the shortfall from maximum dissipation */
  double energy;            /* lambda'(g + G lambda / 2), work of the impulses */
  double restitution_scale; /* 1, or the factor that keeps energy from growing */
} dynContactReport;

typedef struct dynContactSolver dynContactSolver; /* a workspace for max_rows rows; one thread at a time */
#ifndef DYN_BARE
/* Makes the solver on the heap. */
DYN_API dynStatus dyn_contact_solver_new(int max_rows, dynContactSolver** solver);
#endif
/* bytes for dyn_contact_solver_init; 0: max_rows is out of range */
DYN_API size_t dyn_contact_solver_size(int max_rows);
/* Makes the solver in the caller's memory, aligned to 64, without heap. Freeing it leaves the memory. */
DYN_API dynStatus dyn_contact_solver_init(int max_rows, void* memory, size_t size, dynContactSolver** solver);
DYN_API void dyn_contact_solver_free(dynContactSolver* solver); /* NULL is allowed */

/* Solves. lambda (rows): input with warm_start, and output. velocity: c, rows, or NULL. options NULL:
   defaults. Missing convergence is no error: see status and residual. The result is the same bits every time,
   unless a time budget is set. Returns DYN_ERROR_LIMIT for more rows than the solver has room for. */
DYN_API dynStatus dyn_contact_solver_solve(dynContactSolver* solver, const dynContactProblem* problem,
                                           const dynContactOptions* options, double* lambda, double* velocity,
                                           dynContactReport* report);

/* Residuals and energy of a given lambda. status is CONVERGED, counts are 0, restitution is taken as given.
   */
DYN_API dynStatus dyn_contact_solver_residuals(dynContactSolver* solver, const dynContactProblem* problem,
                                               const double* lambda, dynContactReport* report);

/* A spring and damper at the end of the step, as a row: f = -k (gap + dt c) - d c >= 0, for impulses f dt.
   gap (m) below zero is depth.
     compliance = 1 / (dt (dt k + d))        bias = k gap / (dt k + d), and gap / dt before they touch */
DYN_API dynStatus dyn_contact_compliance(double stiffness, double damping, double dt, double gap,
                                         double* compliance, double* bias);
/* Stiffness k and damping d from a frequency f (Hz) and a damping ratio at an effective mass m (kg; 1 /
   G_nn): k = m (2 pi f)^2, d = 2 ratio m 2 pi f. */
DYN_API dynStatus dyn_contact_stiffness_hertz(double frequency, double damping_ratio, double mass,
                                              double* stiffness, double* damping);

/* The same problem for solvers of quadratic and conic programs: min 1/2 lambda'H lambda + g'lambda over lower
   <= A lambda <= upper. H = G + diag(compliance), both triangles. g includes bias and restitution. Matrices
   are CSC: column j has rows[columns[j] .. columns[j+1]-1], ascending. This is the convex relaxation
   (Anitescu 2006), the minimum over the cones. Sliding contacts drift apart there by mu |c_t| dt; with
   sticking contacts both problems are the same. Rows of A: equalities are free and have none, boxes have one
   each, then contact after contact:
     facets = 0   the cone itself: (friction lambda_n, lambda_t, lambda_r friction / rolling, lambda_torsion
                  friction / torsion) is in the second-order cone, first number >= length of the others
                  (bounds are infinite); rows without a coefficient, and contacts of 1 row, as below
     facets >= 3  lambda_n >= 0, pyramids of `facets` facets for lambda_t and for lambda_r, two for torsion.
                  inscribed: the pyramid is in the cone (with 4 and 6 rows coefficients are divided by the
                  root of how many of the three kinds there are); otherwise the cone is in the pyramid
   Rows without a coefficient: 0 <= lambda <= 0. */
typedef struct dynQp {
  uint32_t struct_size;                             /* set by dyn_qp_init */
  int32_t n, m, H_nonzeros, A_nonzeros;             /* variables, rows of A, sizes of H and A */
  int32_t *H_columns, *H_rows, *A_columns, *A_rows; /* n+1, H_nonzeros, n+1, A_nonzeros */
  double *H, *g, *A, *lower, *upper;                /* H_nonzeros, n, A_nonzeros, m, m */
} dynQp;
DYN_API void dyn_qp_init(dynQp* qp, uint32_t struct_size);
#define dyn_qp_init(x) dyn_qp_init(x, sizeof(dynQp))
/* Call first with all pointers NULL: the sizes are written. Then sizes must match, and non-NULL arrays are
   filled. G may be NULL: H has no entries, and only the linearisation is made. */
DYN_API dynStatus dyn_contact_problem_qp(const dynContactProblem* problem, int facets, int inscribed,
                                         dynQp* qp);

/* ------------------------------------------------------------------------------------------------ tendons */

/* Tendons: lengths L(q) that springs, dampers, friction, limits and actuators act on, in steps. (Inverse and
   forward dynamics by themselves leave them out.) With the moment arms J = dL/dq the velocity is L' = J v. A
   force f along the tendon, positive where it lengthens, gives the joints J' f.
     FIXED    L = sum of value x over its JOINT elements: x is the coordinate of the joint
     SPATIAL  L = sum over branches of (length of the path) / divisor. A branch is a row of SITE elements that
              the path passes in straight lines. One SPHERE or CYLINDER may stand between two sites: the path
              goes around it where it is in the way. PULLEY begins another branch.
   Source: MuJoCo documentation, "Tendons"; wrapping: Garner and Pandy 2000, "The obstacle-set method". */
typedef enum dynTendonType {
  DYN_TENDON_TYPE_FIXED = 0,  /* A weighted sum of joint coordinates. */
  DYN_TENDON_TYPE_SPATIAL = 1 /* The shortest path through sites and around spheres and cylinders. */
} dynTendonType;

/* What a tendon runs along. */
typedef enum dynTendonElementType {
  DYN_TENDON_ELEMENT_TYPE_JOINT = 0,    /* A joint of one degree of freedom; value: its coefficient. */
  DYN_TENDON_ELEMENT_TYPE_SITE = 1,     /* The origin of a frame. */
  DYN_TENDON_ELEMENT_TYPE_SPHERE = 2,   /* A sphere about the origin of a frame; value: its radius (m). */
  DYN_TENDON_ELEMENT_TYPE_CYLINDER = 3, /* An endless cylinder about z of a frame; value: its radius (m). */
  DYN_TENDON_ELEMENT_TYPE_PULLEY = 4    /* A new branch begins; value: its divisor. */
} dynTendonElementType;

typedef struct dynTendonElement {
  uint32_t struct_size; /* set by dyn_tendon_element_init */
  dynTendonElementType type;
  const char* name;     /* of the joint or frame; PULLEY: NULL */
  /* SPHERE, CYLINDER: a frame on the side that the path prefers, or NULL. Where that frame is inside the
     surface, the path passes through the inside instead: it touches it at one point. */
  const char* side;
  double value;         /* default 1 */
  int32_t id, side_id;  /* of a model: the joint or frame, and the side's frame; -1: none */
} dynTendonElement;
DYN_API void dyn_tendon_element_init(dynTendonElement* element, uint32_t struct_size,
                                     dynTendonElementType type);
#define dyn_tendon_element_init(x, type) dyn_tendon_element_init(x, sizeof(dynTendonElement), type)

/* Units are those of L: m, or rad where a FIXED tendon adds angles. */
typedef struct dynTendon {
  uint32_t struct_size; /* set by dyn_tendon_init */
  dynTendonType type;
  /* The spring's force is stiffness (rest[0] - L) below rest[0], stiffness (rest[1] - L) above rest[1], and
     zero between them. NAN, the default: L where joint springs rest, other joints in the initial
     configuration. */
  double stiffness, rest[2]; /* N/m; m */
  double damping;            /* N s/m: the force -damping L' */
  double friction;           /* N: dry friction, exact in steps */
  double armature;           /* kg: inertia along L: the energy armature L'^2 / 2 */
  double range[2];           /* L stays within it; default: infinite */
  int32_t elements, angular; /* of a model: how many there are; non-zero: L is an angle */
} dynTendon;
DYN_API void dyn_tendon_init(dynTendon* tendon, uint32_t struct_size, dynTendonType type);
#define dyn_tendon_init(x, type) dyn_tendon_init(x, sizeof(dynTendon), type)
#ifndef DYN_BARE
/* Adds a tendon of count elements. */
DYN_API dynStatus dyn_builder_add_tendon(dynBuilder* builder, const char* name, const dynTendon* tendon,
                                         const dynTendonElement* elements, int count);
/* Two tendons whose lengths obey L1 - L1_0 = p(L2 - L2_0), a polynomial with the coefficients c0 .. c4; L_0:
   the lengths in the initial configuration. tendon2 NULL: L1 - L1_0 = c0. A constraint of steps. */
DYN_API dynStatus dyn_builder_couple_tendons(dynBuilder* builder, const char* name, const char* tendon1,
                                             const char* tendon2, const double coefficients[5]);
#endif
/* Returns the number of tendons. */
DYN_API int dyn_model_ntendons(const dynModel* model);
/* Returns the name of a tendon, or NULL when out of range. */
DYN_API const char* dyn_model_tendon_name(const dynModel* model, int tendon);
/* Returns the id of a tendon by name, or -1. */
DYN_API int dyn_model_tendon_id(const dynModel* model, const char* name);
/* Describes a tendon of the model. */
DYN_API dynStatus dyn_model_tendon_info(const dynModel* model, int tendon, dynTendon* out);
/* Describes an element of a tendon. Its names live as long as the model. */
DYN_API dynStatus dyn_model_tendon_element(const dynModel* model, int tendon, int element,
                                           dynTendonElement* out);
/* Lengths L and velocities L' of all tendons at q and v, and their moment arms dL/dq on the tangent space,
   ntendons x nv. */
DYN_API dynStatus dyn_tendons(const dynModel* model, dynData* data, const double* q, const double* v,
                              double* length, double* velocity, double* J);
/* Points of the path of a SPATIAL tendon at the configuration of dyn_tendons, world axes: 3 numbers each. An
   arc is given by points on it. Returns how many there are, or -1; at most capacity are written. A point that
   begins a branch has a 1 in begins, the others 0; begins may be NULL. */
DYN_API int dyn_tendon_path(const dynModel* model, dynData* data, int tendon, int capacity, double* points,
                            int32_t* begins);

/* ---------------------------------------------------------------------------------------------- actuators */

/* Actuators: controls u drive the robot in steps. (Forward dynamics by itself takes tau alone.) An actuator
   acts on a length l(q) with moment arms J = dl/dq (dynTransmission):
     w' = (u - w) / time_constant, or w' = u, within act_range; or w = u
     f = gain w + bias[0] + bias[1] l + bias[2] l', within force_range        tau += J' f
   A servo (gain = -bias[1]) or PID of moments alone takes the target nearest to l among those a turn apart.
   Euler steps, and steps with contacts, take terms in l and l' at the end of the step: no gain is too large.
   */
typedef enum dynTransmission {
  DYN_TRANSMISSION_JOINT = 0,  /* l = gear x, x a coordinate of a joint whose neutral configuration is 0. */
  DYN_TRANSMISSION_TENDON = 1, /* l = gear L. */
  /* f times wrench, [force; moment] in the axes of a frame, acts at its origin. With a reference frame, in
     whose axes it is then, the opposite acts on that frame's body, and l = wrench . [position; rotation
     vector] of the frame in the reference; joints that carry both have no part in it. Without one l = 0. */
  DYN_TRANSMISSION_SITE = 2,
  /* f times wrench on a ball or free joint. Ball: wrench[0..2] is a moment, and l = wrench . rotation vector.
     Free: [force in the axes of the world; moment], and l = 0. Moments are in the axes of the child, or with
     in_parent in those of the parent. gear must be 1. */
  DYN_TRANSMISSION_AXES = 3,
  /* Slider and crank: a rod joins the origin of a frame, the pin, to a slider on the z axis of the reference
     frame. l = gear times the slider's place: with x the pin in the reference, x_z - sqrt(rod^2 - x_x^2 -
     x_y^2); x_z where the rod is too short. */
  DYN_TRANSMISSION_SLIDER_CRANK = 4,
  /* Adhesion: f pulls a link to what its own shapes touch, an equal share at each contact point along its
     normal. l = 0. */
  DYN_TRANSMISSION_BODY = 5
} dynTransmission;

/* How the force follows from controls, length and velocity. */
typedef enum dynActuatorType {
  DYN_ACTUATOR_TYPE_MOTOR = 0,    /* f = w. */
  DYN_ACTUATOR_TYPE_POSITION = 1, /* f = kp (w - l) - kv l'. */
  DYN_ACTUATOR_TYPE_VELOCITY = 2, /* f = kv (w - l'). */
  /* f = kp (w - l) + kv (u[1] - l') + u[2]: the controls are target, its rate, and feed-forward force. */
  DYN_ACTUATOR_TYPE_PD = 3,
  /* f = (gain + gain_slope[0] l + gain_slope[1] l') w + bias[0] + bias[1] l + bias[2] l'. */
  DYN_ACTUATOR_TYPE_AFFINE = 4,
  DYN_ACTUATOR_TYPE_MUSCLE = 5,   /* See dynMuscle; w is its activation. */
  /* f = kp (s - l) + kv (u_v - l') + u_f + ki z. s follows the position control at no more than slew, and
     z' = s - l until |z| reaches integral_limit. Controls that inputs leaves out are 0. */
  DYN_ACTUATOR_TYPE_PID = 6,
  DYN_ACTUATOR_TYPE_DC_MOTOR = 7  /* See dynDcMotor. */
} dynActuatorType;

/* Controls that an actuator of type PID or DC_MOTOR has, in this order. */
enum {
  DYN_INPUT_POSITION = 1u << 0, /* Position. */
  DYN_INPUT_VELOCITY = 1u << 1, /* Its rate. */
  DYN_INPUT_FORCE = 1u << 2,    /* Force, added to that of the controller. */
  DYN_INPUT_VOLTAGE = 1u << 3   /* Voltage at the terminals; DC_MOTOR. */
};

/* A muscle pulls with f = -force (w FL(x) FV(y) + FP(x)), on lengths normalised by the optimum length
   L0 = (length_range[1] - length_range[0]) / (range[1] - range[0]):
     x = range[0] + (l - length_range[0]) / L0        y = l' / (L0 vmax)
   FL: four half parabolas from 0 at lmin over 1 at x = 1 to 0 at lmax. FV: (1 + y)^2 for -1 <= y <= 0, from
   there a parabola to fvmax. FP: 0 to x = 1, half a parabola to fpmax / 2 at (1 + lmax) / 2, then straight.
   The activation follows the control, both within [0, 1]: w' = (u - w) / t, with t = t_act (0.5 + 1.5 w)
   where u > w, else t_deact / (0.5 + 1.5 w); a smoothing > 0 blends the two over that range of u - w.
   Source: Millard et al. 2013, "Flexing computational muscle"; the curves are those of MuJoCo's muscles. */
typedef struct dynMuscle {
  double force;                             /* N, at optimum length: > 0 */
  double range[2], length_range[2];         /* normalised; l (m) at both ends of it */
  double lmin, lmax, vmax, fpmax, fvmax;
  double t_act, t_deact, smoothing;         /* s, s, 1 */
} dynMuscle;

/* A DC motor with its driver. With the motor constant K, the voltage V, and the resistance
   R = resistance (1 + temperature_coefficient (T - reference)) at the temperature T, the current is
     i = (V - K l') / R, or with time_constant > 0: time_constant i' = (V - K l') / R - i, |i'| <= rate
   and f = K i within force_range, plus cogging[0] sin(cogging[1] l + cogging[2]) less the friction of LuGre:
     bristle_stiffness z + bristle_damping z', z' = l' - bristle_stiffness |l'| z / g
     g = coulomb + (breakaway - coulomb) exp(-(l' / stribeck)^2)
   Where inputs has POSITION, VELOCITY or FORCE, a controller makes, s and z as of a PID,
     V = resistance / K (kp (s - l) + kd (u_v - l') + ki z + u_f) + K l'   within +-voltage_limit (0: none)
   A voltage control is added. T is ambient, or where thermal_resistance > 0 ambient plus a state:
     heat_capacity T' = R i^2 - (T - ambient) / thermal_resistance
   States, as far as there are any, in this order: s, z of the controller, T - ambient, z of the friction, i.
   Source: MuJoCo documentation, XML reference, actuator/dcmotor. */
typedef struct dynDcMotor {
  double resistance, constant;                             /* Ohm, N m/A = V s/rad: > 0 */
  double temperature_coefficient, reference, ambient;      /* 1/K, deg C, deg C */
  double thermal_resistance, heat_capacity;                /* K/W, J/K */
  double time_constant, rate;                              /* s; A/s, 0: no bound */
  double kp, kd, voltage_limit;
  double bristle_stiffness, bristle_damping, coulomb, breakaway, stribeck;
  double cogging[3];
} dynDcMotor;

typedef struct dynActuator {
  uint32_t struct_size;    /* set by dyn_actuator_init */
  dynActuatorType type;
  /* JOINT: id of the joint (the builder takes its name), and which degree of freedom. Terms in l need a
     coordinate whose rate is the velocity: not those of quaternions, planar and Euler-angle joints. */
  int32_t joint, component;
  double gear;             /* default 1 */
  double kp, kv;           /* POSITION, VELOCITY, PD: >= 0 */
  double gain, bias[3];    /* AFFINE */
  double time_constant;    /* s, >= 0, of the filter of the first control; default 0: none */
  double control_range[2]; /* the first control is clamped to it; default: infinite */
  double force_range[2];   /* of f; default: infinite */
  int32_t idx_u, controls; /* of a model: its first control, and how many it has */
  double act_range[2];     /* of w where it is filtered or integrated; default: infinite */
  int32_t integrates;      /* non-zero: w' = u, and time_constant must be 0; default 0 */
  int32_t idx_act;         /* of a model: index of w in the field "act"; -1: w = u */
  dynTransmission transmission;
  int32_t tendon;          /* of a model, TENDON: its id; else -1 */
  int32_t frame, reference; /* of a model, SITE: ids of the frames; -1: none */
  double wrench[6];        /* SITE: N and N m for each N of f; gear must be 1 */
  dynMuscle muscle;        /* MUSCLE */
  double gain_slope[2];    /* AFFINE; default 0 */
  double rod;              /* SLIDER_CRANK: m, > 0 */
  /* PID, DC_MOTOR: >= 0, 0: there is none of it */
  double ki, integral_limit, slew;
  double velocity_range[2], feedforward_range[2]; /* PID, DC_MOTOR: of these controls; default: infinite */
  uint32_t inputs;         /* PID, DC_MOTOR: DYN_INPUT_...; default POSITION, of DC_MOTOR VOLTAGE */
  int32_t in_parent;       /* AXES: 1: moments are in the axes of the parent; default 0 */
  /* 1: Euler steps take w at their beginning, as MuJoCo does unless actearly is set; default 0: at their
     end */
  int32_t late;
  int32_t activations;     /* of a model: numbers of it in the field "act" */
  dynDcMotor motor;        /* DC_MOTOR */
} dynActuator;
DYN_API void dyn_actuator_init(dynActuator* actuator, uint32_t struct_size, dynActuatorType type);
#define dyn_actuator_init(x, type) dyn_actuator_init(x, sizeof(dynActuator), type)
#ifndef DYN_BARE
/* Adds an actuator to the joint, tendon or frame of that name. */
DYN_API dynStatus dyn_builder_add_actuator(dynBuilder* builder, const char* name, const dynActuator* actuator,
                                           const char* target);
/* Adds an actuator of transmission SITE or SLIDER_CRANK between a frame and a reference frame. */
DYN_API dynStatus dyn_builder_add_actuator_between(dynBuilder* builder, const char* name,
                                                   const dynActuator* actuator, const char* frame,
                                                   const char* reference);
/* Limits the sum of the actuators on a joint of one coordinate, or on a tendon, to [lower, upper]: those on
   it are scaled alike. with_weight non-zero: what gravity compensation gives the joint is part of the sum. */
DYN_API dynStatus dyn_builder_limit_actuators(dynBuilder* builder, const char* joint, double lower,
                                              double upper, int with_weight);
/* The same for a tendon. */
DYN_API dynStatus dyn_builder_limit_tendon_actuators(dynBuilder* builder, const char* tendon, double lower,
                                                     double upper);
#endif
/* Returns the number of such limits. */
DYN_API int dyn_model_nforce_limits(const dynModel* model);
/* A limit of the sum of the actuators on a joint or a tendon. */
typedef struct dynForceLimit {
  uint32_t struct_size;
  int32_t joint, tendon;  /* ids; the other one is -1 */
  int32_t with_weight;
  double range[2];        /* N m or N */
} dynForceLimit;
/* Describes a limit of the actuators on a joint or tendon. */
DYN_API dynStatus dyn_model_force_limit_info(const dynModel* model, int limit, dynForceLimit* out);
/* Returns the number of actuators. */
DYN_API int dyn_model_nactuators(const dynModel* model);
DYN_API int dyn_model_nu(const dynModel* model); /* controls of all actuators */
/* Returns the name of an actuator, or NULL when out of range. */
DYN_API const char* dyn_model_actuator_name(const dynModel* model, int actuator);
/* Returns the id of an actuator by name, or -1. */
DYN_API int dyn_model_actuator_id(const dynModel* model, const char* name);
/* Describes an actuator of the model. */
DYN_API dynStatus dyn_model_actuator_info(const dynModel* model, int actuator, dynActuator* out);
/* Sets the controls held in data, nu. New data has zeros. The field "ctrl" reads them. The field "act" has w
   of filtering and integrating actuators, in order; zeros in new data. The field "actuator_force" has f at
   the end of the last step, nactuators. Needs part SIMULATION. */
DYN_API dynStatus dyn_data_set_control(const dynModel* model, dynData* data, const double* u);

/* Adds a wrench [force; moment] (N; N m) that acts in steps until dyn_data_clear_wrenches. Any number may
   act. point: 3, in the frame's axes; NULL: the frame's origin. Needs part SIMULATION.
     LOCAL                the frame's axes, turning with it, at the point
     LOCAL_WORLD_ALIGNED  world axes, at the point
     WORLD                world axes, moment about the world's origin; point must be NULL */
DYN_API dynStatus dyn_data_apply_wrench(const dynModel* model, dynData* data, int frame, const double* point,
                                        const double wrench[6], dynReference reference);
/* Removes all wrenches. */
DYN_API dynStatus dyn_data_clear_wrenches(const dynModel* model, dynData* data);

/* ------------------------------------------------------------------------------------------------ sensors */

/* What a sensor of a model measures, by MJCF's names. A frame sensor has axes of the world, or of its
   reference frame, as seen from there. Quaternions are (x, y, z, w), of either sign. */
typedef enum dynQuantity {
  DYN_QUANTITY_JOINTPOS = 0,           /* Joint, 1: coordinate. */
  DYN_QUANTITY_JOINTVEL = 1,           /* Joint, 1: its rate. */
  DYN_QUANTITY_JOINTACTUATORFRC = 2,   /* Joint, 1: force of all actuators on it. */
  DYN_QUANTITY_JOINTLIMITPOS = 3,      /* Joint, 1: gap to a limit that is passed, below 0; else 0. */
  DYN_QUANTITY_JOINTLIMITVEL = 4,      /* Joint, 1: rate of that gap. */
  DYN_QUANTITY_BALLQUAT = 5,           /* Ball joint, 4: quaternion. */
  DYN_QUANTITY_BALLANGVEL = 6,         /* Ball joint, 3: angular velocity, axes of the child. */
  DYN_QUANTITY_TENDONPOS = 7,          /* Tendon, 1: length. */
  DYN_QUANTITY_TENDONVEL = 8,          /* Tendon, 1: its rate. */
  DYN_QUANTITY_TENDONACTUATORFRC = 9,  /* Tendon, 1: force of all actuators on it. */
  DYN_QUANTITY_TENDONLIMITPOS = 10,    /* Tendon, 1: gap to a limit that is passed, below 0; else 0. */
  DYN_QUANTITY_TENDONLIMITVEL = 11,    /* Tendon, 1: rate of that gap. */
  DYN_QUANTITY_ACTUATORPOS = 12,       /* Actuator, 1: length. */
  DYN_QUANTITY_ACTUATORVEL = 13,       /* Actuator, 1: its rate. */
  DYN_QUANTITY_ACTUATORFRC = 14,       /* Actuator, 1: force. */
  DYN_QUANTITY_FRAMEPOS = 15,          /* Frame, 3: position. */
  DYN_QUANTITY_FRAMEQUAT = 16,         /* Frame, 4: orientation. */
  DYN_QUANTITY_FRAMEXAXIS = 17,        /* Frame, 3: x axis. */
  DYN_QUANTITY_FRAMEYAXIS = 18,        /* Frame, 3: y axis. */
  DYN_QUANTITY_FRAMEZAXIS = 19,        /* Frame, 3: z axis. */
  DYN_QUANTITY_FRAMELINVEL = 20,       /* Frame, 3: velocity of its origin. */
  DYN_QUANTITY_FRAMEANGVEL = 21,       /* Frame, 3: angular velocity. */
  DYN_QUANTITY_FRAMELINACC = 22,       /* Frame, 3: acceleration of its origin minus gravity, world axes. */
  DYN_QUANTITY_FRAMEANGACC = 23,       /* Frame, 3: angular acceleration, world axes. */
  DYN_QUANTITY_ACCELEROMETER = 24,     /* Frame, 3: acceleration of its origin minus gravity, its axes. */
  DYN_QUANTITY_VELOCIMETER = 25,       /* Frame, 3: velocity of its origin, its axes. */
  DYN_QUANTITY_GYRO = 26,              /* Frame, 3: angular velocity, its axes. */
  DYN_QUANTITY_MAGNETOMETER = 27,      /* Frame, 3: dynSensor.field, its axes. */
  /* Frame, 3: force that the parent exerts on the link of the frame, its axes. It follows from the motion of
     all that the link carries, from the contacts, connects, welds and other constraints between frames of the
     last step, and from the wrenches of dyn_data_apply_wrench: one on a link that is fixed to another counts
     as on that one. */
  DYN_QUANTITY_FORCE = 28,
  DYN_QUANTITY_TORQUE = 29,            /* Frame, 3: moment of the same about the frame's origin. */
  /* Frame, 1: sum of the normal forces of contacts of its link whose line meets the zone, last step. */
  DYN_QUANTITY_TOUCH = 30,
  DYN_QUANTITY_SUBTREECOM = 31,        /* Link, 3: centre of mass of all that it carries. */
  DYN_QUANTITY_SUBTREELINVEL = 32,     /* Link, 3: its velocity. */
  DYN_QUANTITY_SUBTREEANGMOM = 33,     /* Link, 3: angular momentum about it. */
  DYN_QUANTITY_INSIDESITE = 34, /* Frame, 1: 1 where its origin is in the zone of the reference, else 0. */
  DYN_QUANTITY_CLOCK = 35,             /* 1: time. */
  DYN_QUANTITY_E_POTENTIAL = 36,       /* 1: potential energy. */
  DYN_QUANTITY_E_KINETIC = 37,         /* 1: kinetic energy. */
  DYN_QUANTITY_JOINTLIMITFRC = 38,     /* Joint, 1: force of its limit, >= 0, last step. */
  DYN_QUANTITY_TENDONLIMITFRC = 39,    /* Tendon, 1: force of its limit, >= 0, last step. */
  /* Frame: what a ray along its z axis hits among the collision shapes of other links, by default its
     distance, 0 inside a shape, -1 if nothing. DYN_VALUE_...: DISTANCE, DIRECTION, ORIGIN, POSITION, NORMAL,
     DEPTH, in this order; zeros where there is no hit. */
  DYN_QUANTITY_RANGEFINDER = 40,
  /* Two sides, each a collision shape or all of a link, 1: their signed distance, at most cutoff. Without a
     cutoff it is 0 where they are apart, as in MuJoCo. */
  DYN_QUANTITY_DISTANCE = 41,
  DYN_QUANTITY_NORMAL = 42,            /* Two sides, 3: unit vector from first to second; 0 beyond cutoff. */
  DYN_QUANTITY_FROMTO = 43,            /* Two sides, 6: nearest points of both; 0 beyond cutoff. */
  /* Up to two sides: `count` contacts of the last step between them, by default whether there are any
     (dynSensor.values, dynReduction). Rows of zeros fill up. The normal points from the first side to the
     second. Forces and moments are in the contact's axes, normal first. */
  DYN_QUANTITY_CONTACT = 44,
  DYN_QUANTITY_USER = 45               /* `count` values that the caller computes; 0 here. */
} dynQuantity;

/* Values of a contact or a ray that a sensor reads, in the order of these bits but for rays (RANGEFINDER). */
enum {
  DYN_VALUE_FOUND = 1u << 0,     /* Contact: 0, or how many there are. */
  DYN_VALUE_FORCE = 1u << 1,     /* Contact: 3. */
  DYN_VALUE_MOMENT = 1u << 2,    /* Contact: 3. */
  DYN_VALUE_DISTANCE = 1u << 3,  /* 1. */
  DYN_VALUE_POSITION = 1u << 4,  /* 3. */
  DYN_VALUE_NORMAL = 1u << 5,    /* 3. */
  DYN_VALUE_TANGENT = 1u << 6,   /* Contact: 3. */
  DYN_VALUE_DIRECTION = 1u << 7, /* Ray: 3. */
  DYN_VALUE_ORIGIN = 1u << 8,    /* Ray: 3. */
  DYN_VALUE_DEPTH = 1u << 9      /* Ray: 1, its distance. */
};

/* What a side of a sensor is. */
typedef enum dynSide {
  DYN_SIDE_ANY = 0,     /* Whatever is there. */
  DYN_SIDE_LINK = 1,    /* The shapes of a link. */
  DYN_SIDE_SHAPE = 2,   /* A collision shape. */
  DYN_SIDE_SUBTREE = 3, /* The shapes of a link and of all that it carries. */
  DYN_SIDE_ZONE = 4     /* Any, at points in the zone of a frame; the first side of CONTACT. */
} dynSide;

/* Which contacts a sensor reads when there are more than its count. */
typedef enum dynReduction {
  DYN_REDUCTION_NONE = 0,     /* The first. */
  DYN_REDUCTION_MINDIST = 1,  /* Those of smallest distance. */
  DYN_REDUCTION_MAXFORCE = 2, /* Those of largest force. */
  /* All as one: sums of forces and moments, world axes, about the centre of the points weighted by forces. */
  DYN_REDUCTION_NETFORCE = 3
} dynReduction;

typedef struct dynSensor {
  uint32_t struct_size;            /* set by dyn_sensor_init */
  dynQuantity quantity;
  /* of a model: ids of joint, tendon, actuator or frame; -1: none. For the builder: dynFrameType of a frame
     that shares its name with another; default -1: as by dyn_model_frame_id */
  int32_t object, reference;
  double cutoff;                   /* > 0: values are clamped to [-cutoff, cutoff]; default 0: not */
  double noise;                    /* standard deviation, for dyn_sensor_noise; default 0 */
  double placement[12];            /* of the sensor in the frame; default: identity */
  double reference_placement[12];  /* in the reference frame; default: identity */
  /* TOUCH, INSIDESITE: the zone about the sensor or the reference: BOX, SPHERE, CYLINDER, CAPSULE or
     ELLIPSOID with sizes as in dynShapeSpec; default a sphere of 5 mm */
  double extent[3];
  dynShapeType shape;
  int32_t idx, size;               /* of a model: place among all values, and how many there are */
  int32_t order;                   /* of a model: 0 reads q, 1 reads v too, 2 acceleration or forces too */
  double field[3];                 /* MAGNETOMETER: magnetic field, world axes; default (0, -0.5, 0) */
  double delay;                    /* s, for dyn_sensor_delay; default 0 */
  dynSide side, other_side;        /* of object and reference, where a quantity has sides; default ANY */
  uint32_t values;                 /* RANGEFINDER, CONTACT: DYN_VALUE_...; default 0: as the quantity says */
  dynReduction reduction;          /* CONTACT; default NONE */
  int32_t count;                   /* CONTACT: contacts, default 1; USER: values, default 1 */
  int32_t of_values;               /* of a model: how many values a contact has; else 0 */
} dynSensor;
DYN_API void dyn_sensor_init(dynSensor* sensor, uint32_t struct_size, dynQuantity quantity);
#define dyn_sensor_init(x, quantity) dyn_sensor_init(x, sizeof(dynSensor), quantity)
#ifndef DYN_BARE
/* Adds a sensor. object: the name of what it is on; NULL where the quantity has none. reference: the name of
   a frame, of the other side, or NULL. */
DYN_API dynStatus dyn_builder_add_sensor(dynBuilder* builder, const char* name, const dynSensor* sensor,
                                         const char* object, const char* reference);
#endif
/* Returns the number of sensors. */
DYN_API int dyn_model_nsensors(const dynModel* model);
/* Returns the number of values of all sensors. */
DYN_API int dyn_model_nsensordata(const dynModel* model);
/* Returns the name of a sensor, or NULL when out of range. */
DYN_API const char* dyn_model_sensor_name(const dynModel* model, int sensor);
/* Returns the id of a sensor by name, or -1. */
DYN_API int dyn_model_sensor_id(const dynModel* model, const char* name);
/* Describes a sensor of the model. */
DYN_API dynStatus dyn_model_sensor_info(const dynModel* model, int sensor, dynSensor* out);
/* Values of all sensors, nsensordata, at q, v and the acceleration a. Those of order 2 read contacts too:
   those of the last step, as by dyn_data_step_contacts. After forward dynamics give its ddq as a. Steps
   compute no sensor and leave a alone; the mean acceleration of a step is (v' - v) / dt. Needs the part
   KINEMATICS; SIMULATION for forces of actuators and contacts; ENERGY for energies; COLLISION for distances
   and rays. Clamped, without
   noise. */
DYN_API dynStatus dyn_sensors(const dynModel* model, dynData* data, const double* q, const double* v,
                              const double* a, double* values);
/* Adds Gaussian noise to values of dyn_sensors. It depends on seed, count and the place of the value alone:
   count is the number of the reading. */
DYN_API dynStatus dyn_sensor_noise(const dynModel* model, uint64_t seed, uint64_t count, double* values);
/* Values with the sensors' delays, from a history of `count` readings: times, ascending, and nsensordata
   values each. A value is that of the last reading at time - delay or before, or else that of the first. */
DYN_API dynStatus dyn_sensor_delay(const dynModel* model, const double* times, const double* readings,
                                   int64_t count, double time, double* values);

/* --------------------------------------------------------------------------------------------- simulation */

/* Steps move the q, v held in data, under constant tau, controls and wrenches. They apply the effects that
   are on, the contacts of tested pairs, and the enabled constraints. Rotations are integrated on the group,
   so orders hold for them too. A step with contacts, limits or constraints solves for their impulses
   (dynContactProblem), one problem for each island of bodies that they join. The impulses of contacts and
   joint limits in the last step are the first guess:
     v_free = v + dt ddq      v' = v_free + M^-1 J' lambda, with c_n >= -gap / dt
     q' = q (+) (dt v' + M^-1 J' mu)
   (Stewart and Trinkle 1996; Anitescu and Potra 1997; impacts by Moreau's law.) mu removes half of an overlap
   in a step, at most 1 m/s for bodies of 20 cm, and leaves v' unchanged. Such steps have order 1. The other
   integrators have order 3 there while contacts and limits last: such a step is made in one, two and three
   parts and extrapolated. It ends where something meets; a short step of order 1 has the jump, and the rest
   follows. In islands of more than 24 rows and with a time_budget they step as IMPLICIT_FAST; REFERENCE also
   where something meets. Steps with permanent constraints alone keep their orders. Free flyers keep their
   momentum. */
typedef enum dynIntegrator {
  /* Order 1; damping, friction, and springs with h^2 k > I / 4 are implicit: no coefficient is too large. */
  DYN_INTEGRATOR_SEMI_IMPLICIT_EULER = 0,
  DYN_INTEGRATOR_RK4 = 1, /* Order 4, four evaluations of forward dynamics. Refuses what is too stiff. */
  /* Order 1; damping, dry friction and springs are implicit, so no stiffness is too large. */
  DYN_INTEGRATOR_IMPLICIT_FAST = 2,
  /* Order 2, time-reversible, symplectic on vector spaces, solved to rounding: for long times. */
  DYN_INTEGRATOR_IMPLICIT_MIDPOINT = 3,
  /* Order 5 with an error estimate (Dormand and Prince), seven evaluations a step. */
  DYN_INTEGRATOR_RK45 = 4,
  /* As exact as rounding allows: order 8 (DOP853), with as many steps within dt as needed. */
  DYN_INTEGRATOR_REFERENCE = 5
} dynIntegrator;

/* How contacts, limits and equalities of a model give way. */
typedef enum dynContactModel {
  DYN_CONTACT_MODEL_RIGID = 0, /* Not at all, but for contacts of materials with a stiffness or damping. */
  /* As the MJCF file states it for MuJoCo (solref, solimp, solmix, impratio), and its defaults elsewhere. */
  DYN_CONTACT_MODEL_AS_FILE = 1
} dynContactModel;

/* Options of steps, kept in the data. */
typedef struct dynStepOptions {
  uint32_t struct_size;        /* set by dyn_step_options_init */
  dynIntegrator integrator;    /* default SEMI_IMPLICIT_EULER */
  double dt;                   /* s, > 0; default 1e-3 */
  /* > 0: dyn_advance chooses its steps, so that errors (m and rad, m/s and rad/s) add up to at most this.
     Order 8; order 5 with RK45; order 3 through contact. Chaos amplifies errors beyond it. Default 0: steps
     of dt. */
  double accuracy;
  dynContactSolverType solver; /* of contacts, limits and constraints; default ADMM */
  /* of the solver, for each island and step, over everything that it tries: sweeps, Newton steps, fall-backs.
     Then the best impulses act: in their cones, with their residual in the report. Default 0: 100; 1200 with
     a tolerance or an accuracy. Without a tolerance ADMM and NEWTON begin with accelerated sweeps, which end
     where the residual stops falling. */
  int32_t max_iterations;
  double tolerance;            /* of the solver's residual (dynContactReport); 0: 1e-4, 1e-9 with accuracy */
  double sleep_speed;          /* m/s, rad/s, > 0; default 1e-4: see below */
  double sleep_time;           /* s, > 0; default 0.5 */
  int32_t visit_sleepers; /* non-zero: steps compute sleeping islands too, with the same bits; default 0 */
  /* non-zero: steps keep the error ledger (dyn_data_ledger), with DYN_PART_ENERGY; default 0 costs nothing */
  int32_t ledger;
  /* s, for a whole step of dt. The solver stops where its next sweep or factorization, and what follows it,
     would end later: earlier steps say how long they take. Then the best impulses act, as with
     max_iterations. Islands not begun get one sweep from the step before. Finding contacts, forward dynamics
     and one sweep are always made. Steps chosen by accuracy have no such limit. No other option lets results
     depend on a clock. Default 0: none, and no clock is read. */
  double time_budget;
  /* default RIGID. AS_FILE is for comparisons with MuJoCo: rows are springs and dampers of the file, and
     impulses those of MuJoCo's convex problem, in which sliding contacts rise. It needs a model from an MJCF
     file, without mimic joints; an Euler step (SEMI_IMPLICIT_EULER, IMPLICIT_FAST); no accuracy. Nothing
     corrects positions. Restitution, stiffness and damping of materials have no effect. */
  dynContactModel contact_model;
  int32_t reserved; /* 0 */
} dynStepOptions;
/* Sleep (DYN_EFFECT_SLEEPING, off in new data) works in steps of SEMI_IMPLICIT_EULER and IMPLICIT_FAST
   without error control. An island is a tree of bodies and all that contacts, limits and constraints join it
   to.
     Rest    An island comes to rest when it was slower than sleep_speed for sleep_time. A step then leaves it
             with v' = 0, q' = q, if it would change velocities by at most dt sleep_speed / sleep_time and
             coordinates by at most dt sleep_speed. Contact forces stay too, if solved to the same (1e-6 of
             the largest). So accelerations below sleep_speed / sleep_time, 2e-4 m/s^2, move nothing that
             rests.
     Sleep   After two steps without a change of one bit, steps leave the island out. It wakes when something
             awake meets it, or when an input changes: q, v, its tau and controls, dt, options, gravity,
             wrenches, effects, materials, pairs, masks, constraints. It is then as if it had never slept:
             steps with visit_sleepers end at the same bits.
     Awake   A tree stays awake with a joint that may not sleep, and while one of its filtered or integrated
             controls changes. So does all of a model with mimic joints, or without contacts. Islands at rest
             are computed while any constraint of the data is enabled. */
DYN_API void dyn_step_options_init(dynStepOptions* options, uint32_t struct_size);
#define dyn_step_options_init(x) dyn_step_options_init(x, sizeof(dynStepOptions))
/* Writes the options of steps of new data: the defaults, with dt and integrator of the model's file if it
   states them. */
DYN_API dynStatus dyn_model_step_options(const dynModel* model, dynStepOptions* options);
/* Sets the options of steps. */
DYN_API dynStatus dyn_data_set_step_options(const dynModel* model, dynData* data,
                                            const dynStepOptions* options);
/* Writes the options of steps. */
DYN_API dynStatus dyn_data_step_options(const dynModel* model, dynData* data, dynStepOptions* options);

/* One step of dt. An error leaves state and time. Unexplained energy: up to 32 parts, then an error. */
DYN_API dynStatus dyn_step(const dynModel* model, dynData* data);
/* Steps over duration (s, >= 0), with a shorter last step, or with lengths chosen by accuracy. After an error
   the state and time are those before the failing step. */
DYN_API dynStatus dyn_advance(const dynModel* model, dynData* data, double duration);

/* Report on the last dyn_step or dyn_advance. */
typedef struct dynStepReport {
  uint32_t struct_size;
  int64_t steps, rejected; /* steps made; steps tried with too large an error */
  int64_t evaluations;     /* of forward dynamics */
  double time;             /* s, advanced */
  double smallest_dt;      /* s */
  double error_estimate;   /* sum of the steps' estimated errors; 0 if there are none (dyn_data_error_bar) */
  /* largest in a step: contact points, active rows, groups of bodies that they join */
  int32_t contacts, rows, islands;
  int32_t dropped;         /* contact points beyond the capacity, the shallowest, in all steps */
  int64_t iterations;      /* of the contact solver, with its Newton steps */
  double residual;         /* largest of the contact solver */
  double penetration;      /* m, largest depth at the beginning of a step, of awake bodies */
  int32_t sleeping;        /* islands asleep in the last step */
  /* islands with a residual above the tolerance, in all steps: max_iterations or time_budget ran out, or
     equalities contradict each other */
  int32_t unsolved;
} dynStepReport;
/* Writes the report on the last call. */
DYN_API dynStatus dyn_data_step_report(const dynModel* model, dynData* data, dynStepReport* report);

/* Bounds on the error of a state. */
typedef struct dynErrorBar {
  uint32_t struct_size;
  int32_t lost; /* 1: motion has amplified errors to a tenth of a rad, or of the model's length, and more */
  double q, v;  /* of the largest entry of dyn_difference (m, rad), and of v (m/s, rad/s) */
} dynErrorBar;
/* Bounds the error of data's state by a second run. finer, of the same model, began like it (dyn_data_copy),
   was driven alike, and is at the same time. Its steps are at most half as long, or for at most half the
   accuracy. The bounds are 4 / (1 - r) times what the two differ by, r the ratio of dt or of accuracy; 4
   times where finer alone has an accuracy. They hold for at least 95 of 100 states of random scenes, with and
   without contact, and are 5 times the error in the median. After `lost` they say nothing. */
DYN_API dynStatus dyn_data_error_bar(const dynModel* model, dynData* data, dynData* finer, dynErrorBar* bar);

/* Error ledger: energy and momentum over the steps of the last call. The defects are the steps' error. Work
   in J. Impulses of contacts, limits and constraints, and of forces at joints in an Euler step: times the
   mean of their velocity before and after, which is the kinetic energy that they add. Other forces: the
   quadrature of the integrator; the trapezoidal rule for wrenches in an Euler step, and where `accuracy`
   meets contacts. (Hairer, Lubich, Wanner 2006, IX: energy shows an integrator's error.) All zero without the
   option `ledger`. */
typedef struct dynErrorLedger {
  uint32_t struct_size;
  int64_t steps;
  double energy_change;            /* kinetic and potential, springs included */
  double applied, actuators;       /* work of tau, and of actuators */
  double wrenches;                 /* work of wrenches and of gravity compensation */
  double damping, friction, fluid; /* work of joint damping, of dry friction, and of drag */
  /* work of contacts along their normals (with impacts), and across */
  double contact_normal, contact_friction;
  double limits, constraints;      /* work of limits and dry friction rows, and of equalities */
  double correction;               /* work of removing overlaps and drift, which moves q alone */
  double energy_defect;            /* energy_change minus all of these */
  /* N s: change of linear momentum minus outer impulses; zero unless free flyers alone join the trees to the
     world */
  double momentum_defect[3];
  double constraint_drift;         /* m, rad: largest error of an equality row at the beginning of a step */
  double cone;                     /* N: largest of |f_t| - mu f_n over contacts, at least 0 */
  double complementarity;          /* W: largest |f_n (c_n + bias)| over contacts: force without touch */
} dynErrorLedger;
/* Writes the ledger of the last call. */
DYN_API dynStatus dyn_data_ledger(const dynModel* model, dynData* data, dynErrorLedger* ledger);

/* Contact points of the last step, ascending by shapes and features, with their mean forces over the step. At
   most capacity of them are written; *count is the total. A step holds 8 a pair, where pairs are listed,
   and at most what its shapes or the builder say: see dyn_builder_set_contact_capacity. */
typedef struct dynContactForce {
  dynContact contact;    /* as at the beginning of the step */
  double force_on_b[3];  /* N, world, on shape_b; the opposite on shape_a */
  double moment_on_b[3]; /* N m, world: of torsion and rolling */
} dynContactForce;
/* Writes the contact points of the last step. */
DYN_API dynStatus dyn_data_step_contacts(const dynModel* model, dynData* data, dynContactForce* contacts,
                                         int capacity, int* count);

/* The whole state of a simulation: q, v, a, tau, controls, act, time, how long bodies have been slow (for
   sleep), the contacts of the last step, and the forces of its joint limits. Steps after
   dyn_data_restore_state equal, bit for bit, the steps after dyn_data_save_state. The data, of the same model
   in the same process, must have the same options, effects, gravity, wrenches, pairs, materials and
   constraints. memory: dyn_model_state_size bytes (0 for an invalid handle). */
DYN_API size_t dyn_model_state_size(const dynModel* model);
/* Saves the state of the simulation. */
DYN_API dynStatus dyn_data_save_state(const dynModel* model, dynData* data, void* memory, size_t size);
/* Restores a saved state. */
DYN_API dynStatus dyn_data_restore_state(const dynModel* model, dynData* data, const void* memory,
                                         size_t size);
/* Copies the state of from, and everything that is set in it: options, effects, gravity, wrenches, pairs,
   masks, materials and constraints. Both data are of the model and have the same parts, else DYN_ERROR_MODEL
   or DYN_ERROR_PART. Steps of both are then equal, bit for bit. Results are not copied. */
DYN_API dynStatus dyn_data_copy(const dynModel* model, dynData* to, dynData* from);

/* Derivatives of a step. */

/* How derivatives of a step are found. */
typedef enum dynDerivativeMethod {
  /* ANALYTIC where it covers the step, CENTRAL_DIFFERENCES elsewhere. The report says which. */
  DYN_DERIVATIVE_METHOD_AUTO = 0,
  /* Implicit differentiation of the step in its modes. DYN_ERROR_UNSUPPORTED where it does not cover it. */
  DYN_DERIVATIVE_METHOD_ANALYTIC = 1,
  /* Central differences of the step: two steps for each coordinate. They cover every step. */
  DYN_DERIVATIVE_METHOD_CENTRAL_DIFFERENCES = 2
} dynDerivativeMethod;

/* Mode of a contact point in a step. */
typedef enum dynContactMode {
  DYN_CONTACT_MODE_OPEN = 0,  /* It has no force. */
  DYN_CONTACT_MODE_STICK = 1, /* It has a force, and the shapes do not slide at the end of the step. */
  DYN_CONTACT_MODE_SLIDE = 2, /* It has a force, and the shapes slide, or the contact has no friction. */
  DYN_CONTACT_MODE_IMPACT = 3 /* It rebounds with its restitution. */
} dynContactMode;

typedef struct dynStepDerivativeOptions {
  uint32_t struct_size;       /* set by dyn_step_derivative_options_init */
  dynDerivativeMethod method; /* default AUTO */
  /* > 0: change of each coordinate in CENTRAL_DIFFERENCES, m and rad, m/s and rad/s, N and N m, and units of
     controls; default 1e-6 */
  double epsilon;
  /* >= 0: a mode is degenerate within it of its end: gaps (m, rad), speeds (m/s, rad/s), forces relative to
     the largest; default 1e-6 */
  double margin;
} dynStepDerivativeOptions;
DYN_API void dyn_step_derivative_options_init(dynStepDerivativeOptions* options, uint32_t struct_size);
#define dyn_step_derivative_options_init(x) \
  dyn_step_derivative_options_init(x, sizeof(dynStepDerivativeOptions))

/* Report on derivatives of a step. */
typedef struct dynStepDerivativeReport {
  uint32_t struct_size;
  dynDerivativeMethod method; /* the one used: ANALYTIC or CENTRAL_DIFFERENCES */
  int32_t contacts;           /* contact points of the step */
  int32_t active;             /* those with a force */
  int32_t degenerate;         /* contact points, limits and actuators whose mode is not strictly held */
  int32_t steps;              /* steps made */
  const char* reason;         /* why ANALYTIC does not cover the step; "" if it does. Lives forever. */
} dynStepDerivativeReport;

/* Parameters of a step by which it has derivatives. Each stands for 1 number unless said otherwise. Its index
   is that of a joint, a degree of freedom (0 .. nv - 1) or a shape. */
typedef enum dynStepParameterType {
  /* 10 numbers: inertial parameters of the body of joint `index`, from 1, as in dyn_joint_torque_regressor.
     ANALYTIC alone. */
  DYN_STEP_PARAMETER_TYPE_INERTIA = 0,
  DYN_STEP_PARAMETER_TYPE_ARMATURE = 1, /* armature of a degree of freedom, kg m^2 or kg */
  DYN_STEP_PARAMETER_TYPE_DAMPING = 2,  /* damping of a degree of freedom, N m s/rad or N s/m */
  DYN_STEP_PARAMETER_TYPE_FRICTION = 3, /* dry friction of a degree of freedom, N m or N */
  DYN_STEP_PARAMETER_TYPE_GRAVITY = 4,  /* 3 numbers: gravity, m/s^2, world axes. index is 0. */
  /* Coefficient of friction of all contacts of shape `index`, whichever of the two shapes it comes from. */
  DYN_STEP_PARAMETER_TYPE_CONTACT_FRICTION = 5,
  DYN_STEP_PARAMETER_TYPE_RESTITUTION = 6, /* the same of their restitution */
  /* dt of the step options, s. By central differences in each method. index is 0. */
  DYN_STEP_PARAMETER_TYPE_TIME_STEP = 7
} dynStepParameterType;

/* What is asked for, and where it is written. x = (q, v) on the tangent space: columns are along q (+) e_k t,
   rows are those of the next state's own tangent space. Rows 0 to nv - 1 are of q', the others of v'.
   Products have the inputs in the order q, v, tau, controls, parameters: n = 3 nv + nu + np numbers, with np
   the numbers of the parameters. They are made without the matrices. */
typedef struct dynStepDerivatives {
  uint32_t struct_size;      /* set by dyn_step_derivatives_init */
  int32_t capacity;          /* contact points that contacts, modes and degenerate hold; default 0 */
  double* A;                 /* 2 nv x 2 nv: by (q, v) */
  double* B;                 /* 2 nv x nv: by tau */
  double* B_control;         /* 2 nv x nu: by controls */
  double *q, *v;             /* the next state, nq and nv */
  dynContactForce* contacts; /* capacity: contact points of the step, as by dyn_data_step_contacts */
  dynContactMode* modes;     /* capacity */
  int32_t* degenerate;       /* capacity: 1: the mode is not strictly held */
  dynStepDerivativeReport* report;
  const dynStepParameterType* parameters; /* parameter_count */
  const int32_t* parameter_index;         /* parameter_count; NULL: all 0 */
  double* P;                 /* 2 nv x np: by the parameters */
  const double* tangents;    /* n x tangent_count: changes of the inputs */
  double* jvp;               /* 2 nv x tangent_count: [A B B_control P] tangents: of the next state */
  const double* cotangents;  /* 2 nv x cotangent_count: gradients by the next state */
  double* vjp;               /* n x cotangent_count: [A B B_control P]^T cotangents: by the inputs */
  int32_t parameter_count, tangent_count, cotangent_count; /* default 0 */
  int32_t reserved;                                        /* 0 */
} dynStepDerivatives;
DYN_API void dyn_step_derivatives_init(dynStepDerivatives* out, uint32_t struct_size);
#define dyn_step_derivatives_init(x) dyn_step_derivatives_init(x, sizeof(dynStepDerivatives))
/* Derivatives of the step that dyn_step would make, and that step's result. The state, the contact forces
   and the report of the last step stay as they are. Results of algorithms are stale afterwards. options may
   be NULL (defaults); out is required. Results are in `out` alone. Activations are no part of x. Contacts are
   solved to 1e-12 or to options.tolerance, the smaller one, and no time_budget counts. Sleeping bodies are
   awake in it.
     Modes       Each contact opens, sticks, slides or rebounds in the step. Within its mode the step is
                 smooth, and derivatives are those of the mode. Redundant contacts share a change of their
                 forces in some way; the motion does not depend on it.
     Degenerate  Between two modes the step has a kink. ANALYTIC gives the derivative of one side, a member of
                 Clarke's generalised Jacobian. CENTRAL_DIFFERENCES gives the mean of both sides.
   ANALYTIC covers SEMI_IMPLICIT_EULER and IMPLICIT_FAST with rigid contacts. The report's reason names what
   it does not cover. Needs part STEP_DERIVATIVES. (de Avila Belbute-Peres 2018; Werling 2021) */
DYN_API dynStatus dyn_step_derivatives(const dynModel* model, dynData* data,
                                       const dynStepDerivativeOptions* options,
                                       const dynStepDerivatives* out);

/* Optimal control: inputs of N steps that minimise a sum of costs, within bounds. */

/* The inputs that a planner chooses. */
typedef enum dynPlanInput {
  DYN_PLAN_INPUT_TAU = 0,    /* tau, nv numbers. Controls stay as they are in the data. */
  DYN_PLAN_INPUT_CONTROL = 1 /* Controls of actuators, nu numbers. tau stays as it is in the data. */
} dynPlanInput;

/* Error e of a cost and its number of components. */
typedef enum dynPlanCostType {
  /* 2 nv: dyn_difference from the reference's q to q, and v minus the reference's v. Reference: q and v,
     nq + nv numbers; default: neutral, at rest. */
  DYN_PLAN_COST_TYPE_STATE = 0,
  DYN_PLAN_COST_TYPE_INPUT = 1, /* nv or nu: input minus reference (default zero). None at the last knot. */
  /* 3: origin of the frame minus reference (default zero), world axes. */
  DYN_PLAN_COST_TYPE_FRAME_POSITION = 2,
  /* 3: rotation vector from the reference (9 numbers, default identity) to the frame, in the frame's axes. */
  DYN_PLAN_COST_TYPE_FRAME_ORIENTATION = 3,
  /* 6: logarithm of the placement in the reference (12 numbers, default identity), [linear; angular]. */
  DYN_PLAN_COST_TYPE_FRAME_PLACEMENT = 4,
  DYN_PLAN_COST_TYPE_COM = 5 /* 3: centre of mass minus reference (default zero), world axes. */
} dynPlanCostType;

/* A cost: weight / 2 times the sum of weights[i] e[i]^2, at each knot. */
typedef struct dynPlanCost {
  uint32_t struct_size;       /* set by dyn_plan_cost_init */
  dynPlanCostType type;       /* default STATE */
  int32_t frame;              /* of FRAME_...; default 0 */
  int32_t reference_stride;   /* numbers from a knot's reference to the next one's; default 0: one for all */
  double weight;              /* >= 0, of knots 0 to N - 1; default 1 */
  double terminal_weight;     /* >= 0, of knot N; default 1 */
  const double* knot_weights; /* N + 1 factors >= 0 on these weights; NULL: 1 */
  const double* weights;      /* of each component, >= 0; NULL: 1 */
  const double* reference;    /* NULL: see the type */
} dynPlanCost;
DYN_API void dyn_plan_cost_init(dynPlanCost* cost, uint32_t struct_size);
#define dyn_plan_cost_init(x) dyn_plan_cost_init(x, sizeof(dynPlanCost))

/* A knot as the caller's cost sees it. x = (q, v) on the tangent space, 2 nv; n inputs: nv or nu. The
   function adds to what the pointers hold, to both halves of symmetric matrices. Without derivatives, when
   the cost alone is asked for, their pointers are NULL. Hessians should be positive semi-definite. */
typedef struct dynPlanPoint {
  int32_t knot;            /* 0 to N */
  int32_t inputs;          /* n; 0 at knot N */
  const dynModel* model;
  dynData* data;           /* to compute with: it may be changed, but for its options and contents of parts */
  const double *q, *v, *u; /* u: NULL at knot N */
  double* cost;
  double *l_x, *l_u;       /* gradients: 2 nv, n */
  double *l_xx, *l_ux, *l_uu; /* 2 nv x 2 nv, n x 2 nv, n x n */
} dynPlanPoint;

/* What is to be minimised, and within which bounds. */
typedef struct dynPlanProblem {
  uint32_t struct_size;        /* set by dyn_plan_problem_init */
  int32_t cost_count;
  const dynPlanCost* costs;    /* cost_count */
  /* nv or nu: of inputs, may be infinite. An input with equal bounds has that value. NULL: ranges of
     controls; effort limits, and none on the degrees of freedom of free flyers (tau = 0) */
  const double *lower, *upper;
  /* adds other costs; NULL: none. Returning non-zero ends the call with DYN_ERROR_CANCELLED */
  int (*function)(void* context, const dynPlanPoint* point);
  void* context;
} dynPlanProblem;
DYN_API void dyn_plan_problem_init(dynPlanProblem* problem, uint32_t struct_size);
#define dyn_plan_problem_init(x) dyn_plan_problem_init(x, sizeof(dynPlanProblem))

typedef struct dynPlanOptions {
  uint32_t struct_size;        /* set by dyn_plan_options_init */
  int32_t max_iterations;      /* >= 1; default 100. 1: an iteration a call, as in model predictive control */
  double tolerance;            /* >= 0: converged if an iteration would lower the cost by less than
                                  tolerance (1 + |cost|); default 1e-9 */
  double gap_tolerance;        /* >= 0: and no gap is larger; default 1e-8 */
  /* >= 0: share of the diagonal of the inputs' Hessian that is added to it at first; default 0 */
  double regularisation;
  double max_regularisation;   /* default 1e9: beyond it the call ends */
  double epsilon, margin;      /* see dynStepDerivativeOptions; default 1e-6 */
  dynDerivativeMethod method;  /* of derivatives of steps; default AUTO */
  int32_t steps;               /* >= 1: steps of dt from a knot to the next; default 1 */
} dynPlanOptions;
DYN_API void dyn_plan_options_init(dynPlanOptions* options, uint32_t struct_size);
#define dyn_plan_options_init(x) dyn_plan_options_init(x, sizeof(dynPlanOptions))

/* Why a planner ended. */
typedef enum dynPlanStatus {
  DYN_PLAN_STATUS_CONVERGED = 0,      /* The tolerances are met. */
  DYN_PLAN_STATUS_MAX_ITERATIONS = 1, /* The iterations ran out. */
  DYN_PLAN_STATUS_REGULARISATION = 2, /* No step lowers the cost, and the regularisation is at its limit. */
  DYN_PLAN_STATUS_STEP_FAILED = 3     /* A step from a knot of the guess fails: see knot. */
} dynPlanStatus;

/* Report of a planner. */
typedef struct dynPlanReport {
  uint32_t struct_size;
  dynPlanStatus status;
  int32_t iterations;         /* backward passes */
  int32_t knot;               /* whose step failed; -1: none */
  double cost;
  double gap;                 /* largest component of a gap */
  double bound_violation;     /* largest; 0: inputs are clamped */
  double expected_decrease;   /* of the cost, by the quadratic model of the last iteration */
  double regularisation;      /* to go on with */
  double step_length;         /* of the last iteration, 0 to 1 */
  int64_t steps;              /* steps made, derivatives not counted */
  int32_t analytic, differences; /* derivatives of steps by each method */
} dynPlanReport;

/* Outputs. x = (q, v) on the tangent space. The best input at a state x near knot k's is
   u[k] + K[k] (x (-) x[k]), clamped to its bounds. */
typedef struct dynPlanOutput {
  uint32_t struct_size; /* set by dyn_plan_output_init */
  int32_t reserved;     /* 0 */
  double *q, *v;        /* N + 1 columns: nq, nv */
  double* u;            /* N columns: nv or nu */
  double* K;            /* N matrices: nv or nu x 2 nv */
  double* gaps; /* N columns: 2 nv, the step from knot k minus knot k + 1; zero: the states are a motion */
  dynPlanReport* report;
} dynPlanOutput;
DYN_API void dyn_plan_output_init(dynPlanOutput* out, uint32_t struct_size);
#define dyn_plan_output_init(x) dyn_plan_output_init(x, sizeof(dynPlanOutput))

typedef struct dynPlanner dynPlanner; /* keeps a plan of N steps of a model; one thread at a time */
#ifndef DYN_BARE
/* Makes a planner of N = knots steps on the heap. */
DYN_API dynStatus dyn_planner_new(const dynModel* model, int knots, dynPlanInput input, dynPlanner** planner);
#endif
/* Returns bytes for dyn_planner_init; 0: an argument is wrong. */
DYN_API size_t dyn_planner_size(const dynModel* model, int knots, dynPlanInput input);
/* Makes the planner in the caller's memory, aligned to 64, without heap. Freeing it leaves the memory. */
DYN_API dynStatus dyn_planner_init(const dynModel* model, int knots, dynPlanInput input, void* memory,
                                   size_t size, dynPlanner** planner);
DYN_API void dyn_planner_free(dynPlanner* planner); /* NULL is allowed */
/* Sets the guess of the next solve. u: N columns; NULL: zero. q and v: N + 1 columns, which need not be a
   motion; NULL, both: the motion by u. New planners have the guess of NULL. */
DYN_API dynStatus dyn_planner_set_guess(dynPlanner* planner, const dynModel* model, const double* q,
                                        const double* v, const double* u);
/* Moves the plan by some knots to the front, for the next sample of time. Its end is repeated. */
DYN_API dynStatus dyn_planner_shift(dynPlanner* planner, int knots);
/* Lowers the cost from the guess, or from the last plan. The plan begins at the data's q and v; the data's
   options of steps, effects, contacts and held inputs count. The data keeps its state; its results are stale
   afterwards. Needs part STEP_DERIVATIVES, and COM for costs of frames and of the centre of mass. options
   NULL: defaults. A plan that has not converged is no error: see status. Two calls from equal states and
   guesses give the same bits. Activations of actuators are no part of x: models that have some are refused.
   Each iteration takes derivatives of the steps, solves the linear-quadratic problem backwards (with the
   bounds of the inputs), and moves along the solution with the largest step 1, 1/2, 1/4, .. that lowers the
   cost and the gaps. Gaps shrink by 1 - step. (Tassa, Mansard, Todorov 2014; Mastalli et al. 2020) */
DYN_API dynStatus dyn_planner_solve(dynPlanner* planner, const dynModel* model, dynData* data,
                                    const dynPlanProblem* problem, const dynPlanOptions* options,
                                    const dynPlanOutput* out);

/* Material of a collision shape in this data; shape -1: of all shapes. Checked as in the builder. */
DYN_API dynStatus dyn_data_set_shape_material(const dynModel* model, dynData* data, int shape,
                                              const dynMaterial* material);
/* Writes the material of a collision shape in this data. */
DYN_API dynStatus dyn_data_shape_material(const dynModel* model, dynData* data, int shape,
                                          dynMaterial* material);

/* ------------------------------------------------------------------------------------------------- meshes */

#ifndef DYN_BARE
/* Triangle meshes, in metres, immutable: threads may share one. Equal vertices are merged. Triangles without
   area, and duplicates, are dropped; dynMeshInfo counts them. At most 10^7 triangles. Hulls need the module
   libdyn_mesh.so (qhull), found beside libdyn.so at first use. Without it: DYN_ERROR_UNSUPPORTED, with the
   places searched. */
typedef struct dynMeshOptions {
  uint32_t struct_size;            /* set by dyn_mesh_options_init */
  double scale[3]; /* factors along the file's axes; default 1. Mirrored triangles are turned round. */
  double weld_tolerance;           /* m: vertices this close are merged; default 0: equal ones only */
  int32_t up_z;                    /* non-zero: the file's up becomes z; default 0: the file's axes */
  const char* const* package_dirs; /* for package://NAME/..., as in dynLoadOptions; may be NULL */
  size_t package_dirs_count;
  /* the robot file that names the mesh: relative paths start in its folder, and package:// is searched above
     it too; NULL: the working directory */
  const char* relative_to;
} dynMeshOptions;
DYN_API void dyn_mesh_options_init(dynMeshOptions* options, uint32_t struct_size);
#define dyn_mesh_options_init(x) dyn_mesh_options_init(x, sizeof(dynMeshOptions))

/* Reads all triangles of an STL (binary, ASCII), OBJ, COLLADA (.dae) or glTF (.gltf, .glb) scene, placed by
   its nodes. Units: COLLADA's <unit> is applied, glTF is in metres, STL and OBJ are taken as metres (see
   scale). Axes: the file's, as URDF puts meshes in their link's axes. With up_z, COLLADA's <up_axis>, and y
   of glTF, become z. Binary files hold single precision. A damaged file is an error that names it. options
   may be NULL. */
DYN_API dynStatus dyn_mesh_load(const char* path, const dynMeshOptions* options, dynMesh** mesh);
/* vertices: 3 x vertex_count. triangles: 3 x triangle_count indices, counter-clockwise seen from outside.
   Without triangles (0, NULL) the mesh is a cloud of points, for dyn_mesh_hull. Vertices without a triangle
   are dropped. */
DYN_API dynStatus dyn_mesh_from_arrays(const double* vertices, size_t vertex_count, const int32_t* triangles,
                                       size_t triangle_count, dynMesh** mesh);
typedef struct dynHeightField {
  uint32_t struct_size;  /* set by dyn_height_field_init */
  int32_t columns, rows; /* points of the grid, at most 5 10^6 */
  /* m, columns x rows: heights[i + columns j] is at x = (i - (columns - 1) / 2) step_x, and y likewise */
  const double* heights;
  double step_x, step_y; /* m, > 0 */
  double bottom;         /* m, below all heights: the end of the solid */
} dynHeightField;
DYN_API void dyn_height_field_init(dynHeightField* field, uint32_t struct_size);
#define dyn_height_field_init(x) dyn_height_field_init(x, sizeof(dynHeightField))
/* A height field. As a mesh it has the surface's triangles, two a cell, without walls. */
DYN_API dynStatus dyn_mesh_from_height_field(const dynHeightField* field, dynMesh** mesh);
DYN_API void dyn_mesh_free(dynMesh* mesh); /* NULL is allowed */

typedef struct dynMeshInfo {
  uint32_t struct_size;
  int32_t vertices, triangles;
  int64_t welded;            /* merged vertices */
  int64_t degenerate;        /* dropped triangles without area */
  int64_t duplicates;        /* dropped duplicate triangles */
  int64_t skipped;           /* points and lines of the file */
  double lower[3], upper[3]; /* bounding box */
  double area;
  int32_t components;        /* parts that share no edge */
  int32_t open_edges;        /* edges of one triangle */
  int32_t flipped_edges;     /* edges that two triangles pass the same way: one of them is inside out */
  int32_t nonmanifold_edges; /* edges of more than two triangles */
  int32_t closed; /* 1: each edge is passed as often one way as the other, so the triangles bound a solid */
  int32_t orientation; /* 1: counter-clockwise from outside; -1: inside out; 0: not closed, or no volume */
  /* m^3. volume, com and inertia are exact but for rounding with orientation 1 or -1 (inside out: of the mesh
     turned round; overlapping parts count twice). With orientation 0 they are NaN. */
  double volume;
  double com[3];
  double inertia[9];         /* kg m^2, about com, at density 1 kg/m^3 */
  dynStatus hull_status;     /* DYN_OK, DYN_ERROR_INVALID (flat), or DYN_ERROR_UNSUPPORTED (no module) */
  /* 1: closed, one component, hull_depth at most 1e-6 of the box's diagonal; 0: not; -1: no module */
  int32_t convex;
  double hull_volume;        /* NaN without a hull */
  double hull_volume_ratio;  /* hull_volume / volume: 1 for a convex mesh; NaN without either */
  double hull_depth; /* m: largest depth of a triangle's middle under the hull's faces; NaN without a hull */
} dynMeshInfo;
/* Makes the hull, which takes time. */
DYN_API dynStatus dyn_mesh_info(const dynMesh* mesh, dynMeshInfo* info);

/* Views, which live as long as the mesh. */
typedef struct dynMeshArrays {
  uint32_t struct_size;
  const double* vertices;         /* 3 x vertex_count */
  const int32_t* triangles;       /* 3 x triangle_count */
  size_t vertex_count, triangle_count;
  /* of a hull, otherwise NULL and 0 */
  size_t face_count;
  const double* planes;           /* 4 x face_count: outward unit normal n and offset: n . x <= offset */
  const int32_t* face_start;      /* face_count + 1: first corner of each face in face_corners */
  const int32_t* face_corners; /* vertices, counter-clockwise from outside; coplanar triangles are one face */
  const int32_t* neighbour_start; /* vertex_count + 1 */
  const int32_t* neighbours;      /* vertices that share an edge with each vertex */
} dynMeshArrays;
/* Writes views of the mesh. */
DYN_API dynStatus dyn_mesh_arrays(const dynMesh* mesh, dynMeshArrays* arrays);
/* Colours of a file's triangles, red, green, blue as in dyn_model_shape_rgba, 3 x triangle_count. The diffuse
   colour of the material (glTF: the base colour) times the mean of the corners' colours. -1 where the file
   gives none. No textures, no opacity. */
DYN_API dynStatus dyn_mesh_rgb(const dynMesh* mesh, double* rgb);

/* The convex hull of the vertices, a new mesh. Returns DYN_ERROR_INVALID for fewer than four points, or all
   in a plane. */
DYN_API dynStatus dyn_mesh_hull(const dynMesh* mesh, dynMesh** hull);
#endif

/* ------------------------------------------------------------------------------------------------ batches */

#ifndef DYN_BARE
/* One algorithm over n states with several threads. Row k of an output is the result of the function of the
   same name, on new data, for row k of the inputs. It is the same bits with any number of threads. Arrays are
   contiguous, state after state. Row k of q begins at q + k nq, and row k of a 6 x nv matrix at M + k 6 nv
   (column-major as everywhere).
     Threads   dyn_batch_new starts them; they sleep between calls. dyn_batch_run wakes them once a call (a
               futex) and works itself. Nothing allocates, locks or makes a system call for each state. A
               batch belongs to one thread at a time.
     Memory    One dynData a thread, with the given parts. The model must live as long as the batch.
     Errors    A state that fails leaves its rows unchanged; all others are computed. dyn_batch_run returns
               the status of the first failed state, and dyn_last_error() tells which and why. status (n, or
               NULL) has that of every state. */
typedef struct dynBatch dynBatch;

/* threads: 1 to 256, the caller's included. parts as in dyn_data_new. */
DYN_API dynStatus dyn_batch_new(const dynModel* model, dynParts parts, int threads, dynBatch** batch);
DYN_API void dyn_batch_free(dynBatch* batch); /* NULL is allowed */

/* dyn_data_set_effects for every thread's data. */
DYN_API dynStatus dyn_batch_set_effects(dynBatch* batch, int joint, uint32_t effects);

/* DYN_ALGORITHM_X computes what dyn_x does. Values are never renumbered. Each comment is
     PART: inputs -> out[0], out[1], ...; after FUNCTIONS
   with the part of data that it needs, the size of each output, and the calls that it makes first. A third
   size counts matrices one after another. b is the right-hand side of CHOLESKY_SOLVE, and lambda of
   RNEA_SECOND_ORDER_PRODUCT. COM reads v and a for vcom and acom alone. */
typedef enum dynAlgorithm {
  DYN_ALGORITHM_FRAME_PLACEMENT = 0, /* KINEMATICS: frame; q -> placement 12; after dyn_forward_kinematics */
  DYN_ALGORITHM_FRAME_PLACEMENTS = 1, /* FRAMES: q -> placements 12 x nframes; after dyn_forward_kinematics */
  /* KINEMATICS: frame, reference; q, v -> velocity 6; after dyn_forward_kinematics */
  DYN_ALGORITHM_FRAME_VELOCITY = 2,
  /* KINEMATICS: frame, reference; q, v, a -> acceleration 6; after dyn_forward_kinematics */
  DYN_ALGORITHM_FRAME_ACCELERATION = 3,
  /* KINEMATICS: frame, reference; q, v, a -> acceleration 6; after dyn_forward_kinematics */
  DYN_ALGORITHM_FRAME_CLASSICAL_ACCELERATION = 4,
  DYN_ALGORITHM_JOINT_JACOBIANS = 5,                /* JACOBIANS: q -> J 6 x nv */
  DYN_ALGORITHM_JOINT_JACOBIANS_TIME_VARIATION = 6, /* JACOBIANS: q, v -> dJ 6 x nv */
  /* KINEMATICS: frame, reference; q -> J 6 x nv; after dyn_forward_kinematics */
  DYN_ALGORITHM_FRAME_JACOBIAN = 7,
  /* KINEMATICS: frame, reference; q, v -> dJ 6 x nv; after dyn_forward_kinematics */
  DYN_ALGORITHM_FRAME_JACOBIAN_TIME_VARIATION = 8,
  DYN_ALGORITHM_COM = 9,                            /* COM: q, v, a -> com 3, vcom 3, acom 3 */
  DYN_ALGORITHM_JCOM = 10,                          /* COM: q -> Jcom 3 x nv */
  DYN_ALGORITHM_SUBTREE_COM = 11,                   /* COM: joint; q -> com 3, mass 1; after dyn_com */
  DYN_ALGORITHM_SUBTREE_JCOM = 12,                  /* COM: joint; q -> J 3 x nv; after dyn_com */
  DYN_ALGORITHM_RNEA = 13,                          /* INVERSE: q, v, a, fext -> tau nv */
  DYN_ALGORITHM_NLE = 14,                           /* INVERSE: q, v -> nle nv */
  DYN_ALGORITHM_GRAVITY_TORQUE = 15,                /* INVERSE: q -> g nv */
  DYN_ALGORITHM_STATIC_TORQUE = 16,                 /* INVERSE: q, fext -> tau nv */
  DYN_ALGORITHM_CORIOLIS_MATRIX = 17,               /* CORIOLIS: q, v -> C nv x nv */
  DYN_ALGORITHM_ABA = 18,                           /* FORWARD: q, v, tau, fext -> ddq nv */
  DYN_ALGORITHM_CRBA = 19,                          /* MASS: q -> M nv x nv */
  DYN_ALGORITHM_CHOLESKY_SOLVE = 20,                /* CHOLESKY: q, b -> x nv; after dyn_crba, dyn_cholesky */
  DYN_ALGORITHM_MINV = 21,                          /* MINV: q -> Minv nv x nv */
  /* INVERSE_DERIVATIVES: q, v, a, fext -> dtau_dq nv x nv, dtau_dv nv x nv */
  DYN_ALGORITHM_RNEA_DERIVATIVES = 22,
  /* FORWARD_DERIVATIVES: q, v, tau, fext -> ddq_dq nv x nv, ddq_dv nv x nv, ddq_dtau nv x nv */
  DYN_ALGORITHM_ABA_DERIVATIVES = 23,
  DYN_ALGORITHM_ENERGY = 24,                        /* ENERGY: q, v -> kinetic 1, potential 1 */
  DYN_ALGORITHM_KINETIC_ENERGY = 25,                /* ENERGY: q, v -> kinetic 1 */
  DYN_ALGORITHM_POTENTIAL_ENERGY = 26,              /* ENERGY: q -> potential 1 */
  DYN_ALGORITHM_CENTROIDAL_MAP = 27,                /* CENTROIDAL: q, v -> Ag 6 x nv, Ig 6 x 6, hg 6 */
  DYN_ALGORITHM_CENTROIDAL_MAP_TIME_VARIATION = 28, /* CENTROIDAL: q, v -> dAg 6 x nv */
  DYN_ALGORITHM_CENTROIDAL_MOMENTUM = 29,           /* CENTROIDAL: q, v -> hg 6 */
  DYN_ALGORITHM_CENTROIDAL_MOMENTUM_TIME_VARIATION = 30,/* CENTROIDAL: q, v, a -> dhg 6 */
  /* CENTROIDAL: q, v, a -> dh_dq 6 x nv, dhdot_dq 6 x nv, dhdot_dv 6 x nv, dhdot_da 6 x nv */
  DYN_ALGORITHM_CENTROIDAL_DERIVATIVES = 31,
  DYN_ALGORITHM_JOINT_TORQUE_REGRESSOR = 32,        /* REGRESSOR: q, v, a -> Y nv x nparameters */
  DYN_ALGORITHM_STATIC_REGRESSOR = 33,              /* REGRESSOR: q -> Y 3 x nparameters */
  DYN_ALGORITHM_KINETIC_ENERGY_REGRESSOR = 34,      /* REGRESSOR: q, v -> y nparameters */
  DYN_ALGORITHM_POTENTIAL_ENERGY_REGRESSOR = 35,    /* REGRESSOR: q -> y nparameters */
  /* KINEMATICS: joint; q, v, a -> Y 6 x 10; after dyn_forward_kinematics */
  DYN_ALGORITHM_JOINT_BODY_REGRESSOR = 36,
  /* KINEMATICS: frame; q, v, a -> Y 6 x 10; after dyn_forward_kinematics */
  DYN_ALGORITHM_FRAME_BODY_REGRESSOR = 37,
  DYN_ALGORITHM_INTEGRATE = 38,                     /* q, v -> out nq */
  DYN_ALGORITHM_GRAVITY_TORQUE_DERIVATIVES = 39,    /* INVERSE_DERIVATIVES: q -> dg_dq nv x nv */
  /* INVERSE_DERIVATIVES: q, fext -> dstatic_torque_dq nv x nv */
  DYN_ALGORITHM_STATIC_TORQUE_DERIVATIVES = 40,
  DYN_ALGORITHM_VCOM_DERIVATIVES = 41,              /* COM: q, v -> dvcom_dq 3 x nv, dvcom_dv 3 x nv */
  /* KINEMATICS: frame, reference; q, v -> dv_dq 6 x nv, dv_dv 6 x nv; after dyn_forward_kinematics */
  DYN_ALGORITHM_FRAME_VELOCITY_DERIVATIVES = 42,
  /* KINEMATICS: frame, reference; q, v, a -> da_dq 6 x nv, da_dv 6 x nv, da_da 6 x nv; after
     dyn_forward_kinematics */
  DYN_ALGORITHM_FRAME_ACCELERATION_DERIVATIVES = 43,
  /* KINEMATICS: frame, reference; q, v, a -> da_dq 6 x nv, da_dv 6 x nv, da_da 6 x nv; after
     dyn_forward_kinematics */
  DYN_ALGORITHM_FRAME_CLASSICAL_ACCELERATION_DERIVATIVES = 44,
  /* SECOND_ORDER: b; q, v, a, fext -> dqdq nv x nv, dvdv nv x nv, dqdv nv x nv, dadq nv x nv */
  DYN_ALGORITHM_RNEA_SECOND_ORDER_PRODUCT = 45,
  /* SECOND_ORDER: q, v, a, fext -> d2tau_dqdq nv x nv x nv, d2tau_dvdv nv x nv x nv, d2tau_dqdv nv x nv x
     nv, d2tau_dadq nv x nv x nv */
  DYN_ALGORITHM_RNEA_SECOND_ORDER_DERIVATIVES = 46,
  /* JACOBIANS: frame, reference; q -> H 6 x nv x nv; after dyn_forward_kinematics */
  DYN_ALGORITHM_FRAME_KINEMATIC_HESSIAN = 47,
  DYN_ALGORITHM_DIFFERENCE = 48,                    /* q, q1 -> v nv */
  DYN_ALGORITHM_STEP = 49,                          /* SIMULATION: dt, integrator; q, v, tau -> q nq, v nv */
  /* q, v -> length ntendons, velocity ntendons, J ntendons x nv */
  DYN_ALGORITHM_TENDONS = 50,
  DYN_ALGORITHM_SENSORS = 51                        /* q, v, a -> sensor_data nsensordata */
} dynAlgorithm;

/* Inputs and outputs. An algorithm ignores inputs that it does not read. An output may be an input with rows
   of the same size; otherwise arrays must not overlap. */
typedef struct dynBatchArrays {
  uint32_t struct_size;              /* set by dyn_batch_arrays_init */
  int32_t frame, joint;
  dynReference reference;
  const double *q, *v, *a, *tau, *b; /* n rows of nq, nv, nv, nv, nv; NULL: zeros, but q and b are required */
  const double* fext;                /* n rows of 6 njoints; NULL: none */
  const double* q1;                  /* n rows of nq, required by DIFFERENCE */
  double dt;
  dynIntegrator integrator;
  int32_t exact;                     /* 1: the bits of single calls; default 0 */
  double* out[4];                    /* n rows each; NULL: not wanted, but one at least must be */
  dynStatus* status;                 /* n, or NULL */
  const double* mocap; /* n rows of 12 nmocaps, placements of mocap bodies; NULL: the initial ones */
} dynBatchArrays;
DYN_API void dyn_batch_arrays_init(dynBatchArrays* arrays, uint32_t struct_size);
#define dyn_batch_arrays_init(x) dyn_batch_arrays_init(x, sizeof(dynBatchArrays))
/* Computes an algorithm for n states. A state's bits depend on nothing but the state: not on n, threads,
   order or neighbours. In small models placements, joint Jacobians, RNEA, ABA, CRBA, Minv and derivatives
   take several states side by side, in the lanes of registers. Sums then have another order than in single
   calls: with exact they have the same bits. */
DYN_API dynStatus dyn_batch_run(dynBatch* batch, dynAlgorithm algorithm, int64_t n,
                                const dynBatchArrays* arrays);
/* One state on any data, as dyn_X does it: inputs that are NULL are those held, outputs may be NULL. */
DYN_API dynStatus dyn_algorithm_run(const dynModel* model, dynData* data, dynAlgorithm algorithm,
                                    const dynBatchArrays* arrays);

/* The same table for programs. Without a model (NULL) sizes that depend on it are 0. */
typedef struct dynAlgorithmInfo {
  uint32_t struct_size;
  const char* name;         /* "rnea" */
  const char* inputs;       /* separated by blanks: "q v a fext", "frame reference q v" */
  int32_t outputs;
  const char* output[4];    /* names */
  int32_t rows[4], cols[4]; /* of one state; vectors have cols = 1 */
  int32_t pages[4];         /* matrices one after another; 1 for others */
  dynParts part;            /* of data that it needs; 0: none */
  const char* precondition; /* calls that it makes first: "dyn_crba dyn_cholesky"; "": none */
} dynAlgorithmInfo;
/* Describes an algorithm. */
DYN_API dynStatus dyn_algorithm_info(const dynModel* model, dynAlgorithm algorithm, dynAlgorithmInfo* info);

/* ----------------------------------------------------------------------------------------------- rollouts */

/* Sensors that a rollout records beside states. */
typedef enum dynSensorType {
  DYN_SENSOR_TYPE_PLACEMENT = 0, /* Of a frame, 7: position (m) and quaternion (x, y, z, w), world. */
  DYN_SENSOR_TYPE_VELOCITY = 1,  /* Of a frame, 6: [linear; angular] (m/s, rad/s), axes of the frame. */
  /* Of a frame, 6, its axes: acceleration of its origin minus gravity, mean over the last step (m/s^2), and
     angular velocity (rad/s). */
  DYN_SENSOR_TYPE_IMU = 2,
  /* Of a link, 6: [force; moment] of all contacts on its shapes, mean over the last step (N, N m), axes of
     the world, about its origin. */
  DYN_SENSOR_TYPE_FORCE = 3,
  DYN_SENSOR_TYPE_COM = 4,       /* 6: centre of mass of the robot (m) and its velocity (m/s), world. */
  DYN_SENSOR_TYPE_ENERGY = 5     /* 2: kinetic and potential energy (J). */
} dynSensorType;
/* Returns the size of a sensor; 0 for an unknown one. */
DYN_API int dyn_sensor_size(dynSensorType sensor);

/* n simulations of the batch's model on its threads. Inputs are controls; outputs are states, sensors and
   contacts. Each simulation makes `steps` steps of stepping->dt. Controls are held for `every` steps, and a
   record is made at their end: R = steps / every records. Arrays are contiguous, simulation after simulation,
   record after record. NULL: not given, not wanted. A simulation begins as new data, or at its row of states;
   q0 and v0 override.
     Same bits   Simulation k equals dyn_data_set_control, dyn_data_set_state and dyn_step on a data with the
                 batch's effects, with any number of threads and any neighbours. Begun at final_states it
                 continues as one longer rollout would.
     Errors      A simulation that fails ends; its later records stay unchanged, and its status tells why.
                 Others go on. The call returns the status of the first failed one.
     progress    Called by the calling thread alone: at the beginning, about every 10 ms, and at the end, with
                 the steps made and the total. A non-zero return cancels: unfinished simulations, and the
                 call, then have DYN_ERROR_CANCELLED. */
typedef struct dynRollout {
  uint32_t struct_size;           /* set by dyn_rollout_init */
  int32_t steps, every;           /* default 1, 1; every divides steps */
  int32_t contact_capacity;       /* contacts of a record; default 0 */
  int32_t sensors;                /* number of sensors; default 0 */
  const dynStepOptions* stepping; /* NULL: as dyn_model_step_options */
  const dynSensorType* sensor;    /* sensors */
  const int32_t* sensor_frame;    /* sensors: a frame each, read where the sensor has one */
  const void* states; /* n of dyn_model_state_size bytes, from dyn_data_save_state or final_states */
  const double *q0, *v0;          /* n x nq, n x nv */
  const double* tau;              /* n x R x nv */
  const double* control;          /* n x R x nu, for actuators */
  double *q, *v;                  /* n x R x nq, n x R x nv */
  double* sensor_data;            /* n x R x the sum of the sensors' sizes */
  dynContactForce* contacts; /* n x R x contact_capacity: of the last step, as by dyn_data_step_contacts */
  int32_t* contact_count;         /* n x R: total contacts */
  void* final_states;             /* n of dyn_model_state_size bytes */
  dynStatus* status;              /* n */
  int (*progress)(void* context, int64_t steps, int64_t of);
  void* context;
  double* model_sensors; /* n x R x nsensordata, by dyn_sensors at the mean acceleration of the last step */
  int32_t sensor_delays; /* 1: each value is as old as its delay, rounded to steps; default 0 */
  /* 1: noise, with the seed sensor_seed + simulation and the record as count; default 0 */
  int32_t sensor_noise;
  uint64_t sensor_seed;
  const double* mocap; /* n x R x 12 nmocaps: placements of mocap bodies, set where controls are */
  /* n models, of simulations whose masses, frictions or gains differ: the batch's with other numbers
     (dyn_builder_set_parameter). states are of these models. NULL: all have the batch's */
  const dynModel* const* models;
} dynRollout;
DYN_API void dyn_rollout_init(dynRollout* rollout, uint32_t struct_size);
#define dyn_rollout_init(x) dyn_rollout_init(x, sizeof(dynRollout))
/* Runs n simulations. */
DYN_API dynStatus dyn_batch_rollout(dynBatch* batch, int64_t n, const dynRollout* rollout);
#endif

/* ------------------------------------------------------------------------------------------ what there is */

/* Everything that this header declares, for programs: bindings, command lines, tables. Texts live forever. */

/* An enumeration, or a set of bits. */
typedef struct dynEnumInfo {
  uint32_t struct_size;
  const char* name;     /* "dynIntegrator"; of bits "dynEffects", "dynParts", "dynTerms", "dynImages" */
  const char* prefix;   /* "DYN_INTEGRATOR_" */
  const char* sentence; /* the comment above it */
  int32_t count;        /* number of values */
  int32_t bits;         /* 1: values are masks */
} dynEnumInfo;
/* Number of enumerations. */
DYN_API int dyn_enum_count(void);
/* Index of an enumeration; -1: unknown. */
DYN_API int dyn_enum_id(const char* name);
DYN_API dynStatus dyn_enum_info(int index, dynEnumInfo* info);

/* One value of an enumeration. */
typedef struct dynEnumValueInfo {
  uint32_t struct_size;
  int32_t value;
  const char* identifier; /* "DYN_INTEGRATOR_RK4" */
  const char* name;       /* "RK4" */
  const char* sentence;   /* the comment beside it */
} dynEnumValueInfo;
/* Value k of an enumeration, in the header's order. */
DYN_API dynStatus dyn_enum_value_info(int index, int k, dynEnumValueInfo* info);

/* A type of joint. Sizes of FIXED are 0; those of COMPOSITE are the sums of its parts, here 0. */
typedef struct dynJointTypeInfo {
  uint32_t struct_size;
  int32_t nq, nv;
  int32_t axis, axis2, pitch; /* 1: it reads that of dynJointSpec */
  const char* name;           /* "planar" */
  /* Its simple motions, one after another: "prismatic axis_x, prismatic axis_y, revolute axis". Each is
     revolute, prismatic, helical or revolute_unbounded with its axis, or spherical or free_flyer. An axis is
     x, y, z, axis, axis2, axis_x or axis_y. The last two are x and y, turned by the smallest rotation that
     takes z to axis. */
  const char* chain;
  const char* sentence;
} dynJointTypeInfo;
DYN_API dynStatus dyn_joint_type_info(dynJointType type, dynJointTypeInfo* info);

/* A type of shape. */
typedef struct dynShapeTypeInfo {
  uint32_t struct_size;
  int32_t sizes;       /* numbers of dynShapeSpec.size that it reads */
  int32_t convex;      /* 1: convex */
  int32_t surface;     /* 1: it is made of a mesh, dynShapeSpec.surface */
  const char* name;    /* "capsule" */
  const char* size[3]; /* their meaning; "" beyond */
  const char* sentence;
} dynShapeTypeInfo;
DYN_API dynStatus dyn_shape_type_info(dynShapeType type, dynShapeTypeInfo* info);

/* A type of constraint. */
typedef struct dynConstraintTypeInfo {
  uint32_t struct_size;
  int32_t rows;      /* 0 for LOOP: it has 6 - nv of its joint type; 0 for NONE */
  int32_t joints;    /* 1: first and second are joints, else frames */
  int32_t one_sided; /* 1: its force is bounded */
  const char* name;  /* "weld" */
  const char* sentence;
} dynConstraintTypeInfo;
DYN_API dynStatus dyn_constraint_type_info(dynConstraintType type, dynConstraintTypeInfo* info);

/* An integrator. */
typedef struct dynIntegratorInfo {
  uint32_t struct_size;
  int32_t order;       /* without contacts */
  int32_t evaluations; /* of forward dynamics in a step; 0: as many as it takes */
  int32_t implicit;    /* 1: it solves for the end of the step */
  int32_t estimates;   /* 1: it estimates its error */
  const char* name;    /* "rk4" */
  const char* sentence;
} dynIntegratorInfo;
DYN_API dynStatus dyn_integrator_info(dynIntegrator integrator, dynIntegratorInfo* info);

/* An effect of joints and links. */
typedef struct dynEffectTypeInfo {
  uint32_t struct_size;
  uint32_t bit;           /* DYN_EFFECT_... */
  dynParts part;          /* data without this part never has the effect; 0: all data may have it */
  int32_t implicit;       /* Euler steps take it at their end: 0 none, 1 all, 2 IMPLICIT_FAST alone */
  int32_t array;          /* the dynModelArray of its numbers, one a degree of freedom; -1: it has none */
  const char* name;       /* "damping" */
  const char* quantity;   /* what the array holds: "dry friction"; "" without an array */
  const char* absent;     /* why a model does not have it: "no joint has damping" */
  const char* sentence;
} dynEffectTypeInfo;
/* Describes the effect of one DYN_EFFECT_... bit. */
DYN_API dynStatus dyn_effect_type_info(uint32_t bit, dynEffectTypeInfo* info);

/* A contact solver. */
typedef struct dynContactSolverTypeInfo {
  uint32_t struct_size;
  int32_t refined;  /* 1: Newton's method finishes what it finds */
  const char* name; /* "admm" */
  const char* sentence;
} dynContactSolverTypeInfo;
DYN_API dynStatus dyn_contact_solver_type_info(dynContactSolverType type, dynContactSolverTypeInfo* info);

/* The whole header as JSON, in its order. Each value is a list of objects; doc is the comment:
     constants   name, value, doc
     macros      name, parameters (names), body, doc
     enums       name, prefix, bits, doc, values: identifier, name, value, doc
     handles     name, doc
     types       name, type, doc
     callbacks   name, returns, parameters, doc
     structs     name, doc, fields
     functions   name, returns, parameters, section, doc
   Fields and parameters are {name, type, length, doc}. type is the C type, as "const double*". length, a
   list, is there for arrays alone. A pointer to a function has returns and parameters instead of type. */
DYN_API const char* dyn_interface_json(void);

#ifdef __cplusplus
}
#endif
#endif
