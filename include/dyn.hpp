// libdyn for C++17: owners, exceptions and views over dyn.h, and nothing else. Conventions are those of dyn.h.
//
//   auto model = dyn::Model::load("go2.urdf", dyn::LoadOptions().base(DYN_BASE_FLOATING));
//   dyn::Data data(model);
//   dyn::View tau = data.rnea(q, v, a);       // a view of the result in data: no copy, no allocation
//   dyn::View M = data.crba(q);               // M(i, j)
//
// Vectors go in as anything with data() and size() (std::vector, std::array, Eigen::VectorXd, dyn::View), as {pointer, size},
// or as dyn::held: the value that data holds. Sizes are checked. Views follow the data and live as long as it does.
// The names live in dyn_api, and dyn uses them: a program that has a namespace dyn of its own writes dyn_api::Model.
#ifndef DYN_HPP
#define DYN_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "dyn.h"

namespace dyn_api {

// A call that failed: what() is the library's sentence.
class Error : public std::runtime_error {
 public:
  explicit Error(dynStatus status) : Error(status, dyn_last_error()) {}
  Error(dynStatus status, const std::string& message) : std::runtime_error(message), status_(status) {}
  dynStatus status() const noexcept { return status_; }
  const char* status_name() const noexcept { return dyn_status_name(status_); }

 private:
  dynStatus status_;
};

inline void check(dynStatus status) {
  if (status != DYN_OK) throw Error(status);
}

// The value that data holds, or "none": NULL in dyn.h.
struct Held {};
inline constexpr Held held{};
inline constexpr Held none{};

// Numbers going in.
class Input {
 public:
  Input(Held) noexcept {}
  Input(const double* data, std::size_t size) noexcept : data_(data), size_(size), given_(true) {}
  template <class V, class = decltype(static_cast<const double*>(std::declval<const V&>().data())),
            class = decltype(std::declval<const V&>().size())>
  Input(const V& vector) : Input(vector.data(), static_cast<std::size_t>(vector.size())) {}

  bool given() const noexcept { return given_; }
  // The pointer that dyn.h wants; refuses a wrong size.
  const double* of(int64_t size, const char* name) const {
    if (given_ && size_ != static_cast<std::size_t>(size))
      throw Error(DYN_ERROR_SIZE,
                  std::string(name) + " has " + std::to_string(size_) + " numbers, but needs " + std::to_string(size) + ".");
    return data_;
  }

 private:
  const double* data_ = nullptr;
  std::size_t size_ = 0;
  bool given_ = false;
};

// Numbers in the library's memory, read only.
class View {
 public:
  explicit View(const dynArray& array) : array_(array) {}
  int rows() const noexcept { return array_.rows; }
  int cols() const noexcept { return array_.cols; }
  std::size_t size() const noexcept { return static_cast<std::size_t>(array_.rows) * static_cast<std::size_t>(array_.cols); }
  const double* data() const noexcept { return array_.data; }
  const double* begin() const noexcept { return data(); }
  const double* end() const noexcept { return data() + size(); }
  double operator[](std::size_t i) const noexcept { return array_.data[i]; }
  double operator()(int i, int j = 0) const noexcept { return array_.data[i * array_.stride[0] + j * array_.stride[1]]; }
  std::vector<double> copy() const { return {begin(), end()}; }

 private:
  dynArray array_;
};

// A matrix of one's own, column-major.
struct Matrix {
  int rows, cols;
  std::vector<double> values;
  Matrix(int r, int c) : rows(r), cols(c), values(static_cast<std::size_t>(r) * static_cast<std::size_t>(c)) {}
  double operator()(int i, int j) const {
    return values[static_cast<std::size_t>(i) + static_cast<std::size_t>(j) * static_cast<std::size_t>(rows)];
  }
  double* data() noexcept { return values.data(); }
  const double* data() const noexcept { return values.data(); }
  std::size_t size() const noexcept { return values.size(); }
};

using Vector = std::vector<double>;
using Vector6 = std::array<double, 6>;  // [linear; angular]
using Vector3 = std::array<double, 3>;
using Rotation = std::array<double, 9>;    // by columns
using Quaternion = std::array<double, 4>;  // (x, y, z, w)
using Placement = std::array<double, 12>;  // rotation by columns, then translation

struct ConstraintOptions {
  dynConstraintOptions value;
  ConstraintOptions() { dyn_constraint_options_init(&value); }
  ConstraintOptions& regularisation(double x) { return value.regularisation = x, *this; }
  ConstraintOptions& tolerance(double x) { return value.tolerance = x, *this; }
  ConstraintOptions& max_iterations(int n) { return value.max_iterations = n, *this; }
};
struct ProjectOptions {
  dynProjectOptions value;
  ProjectOptions() { dyn_project_options_init(&value); }
};

struct LoadOptions {
  dynLoadOptions value;
  std::vector<std::string> folders;
  std::string srdf_path;
  LoadOptions() { dyn_load_options_init(&value); }
  LoadOptions& base(dynBase b) { return value.base = b, *this; }
  LoadOptions& strict(bool on = true) { return value.strict = on, *this; }
  LoadOptions& cos_sin(bool on = true) { return value.cos_sin = on, *this; }
  LoadOptions& gravity(double x, double y, double z) {
    return value.gravity[0] = x, value.gravity[1] = y, value.gravity[2] = z, *this;
  }
  LoadOptions& package_dir(std::string folder) { return folders.push_back(std::move(folder)), *this; }
  LoadOptions& constraint_slots(int n) { return value.constraint_slots = n, *this; }
  LoadOptions& contact_capacity(int n) { return value.contact_capacity = n, *this; }
  LoadOptions& confined(bool yes = true) { return value.confined = yes, *this; }
  LoadOptions& max_bodies(int n) { return value.max_bodies = n, *this; }
  LoadOptions& max_shapes(int n) { return value.max_shapes = n, *this; }
  LoadOptions& max_constraint_rows(int n) { return value.max_constraint_rows = n, *this; }
  LoadOptions& max_keys(int n) { return value.max_keys = n, *this; }
  LoadOptions& max_bytes(int64_t n) { return value.max_bytes = n, *this; }
  LoadOptions& max_seconds(double t) { return value.max_seconds = t, *this; }
  LoadOptions& meshes(dynMeshUse use) { return value.meshes = use, *this; }
  LoadOptions& srdf(std::string path) { return srdf_path = std::move(path), *this; }
};

// How another library stores the state of the same robot.
struct StateLayout {
  dynStateLayout value;
  std::vector<std::string> names;  // our joints in the peer's order; none: the model's
  std::vector<int32_t> idx_q, idx_v;
  std::string frame;
  explicit StateLayout(dynConvention convention) { dyn_state_layout_init(&value), value.convention = convention; }
  StateLayout& joints(std::vector<std::string> order) { return names = std::move(order), *this; }
  // where each joint begins in the peer's q and v, and their sizes
  StateLayout& places(std::vector<int32_t> q, std::vector<int32_t> v, int nq = 0, int nv = 0) {
    return idx_q = std::move(q), idx_v = std::move(v), value.nq = nq, value.nv = nv, *this;
  }
  StateLayout& continuous(dynAngle angle) { return value.continuous = angle, *this; }
  StateLayout& child_frame(std::string name) { return frame = std::move(name), *this; }
};
struct State {
  Vector q, v, a, tau;  // empty: not given
};

// A task of inverse kinematics: IkTask::pose(hand, X).weight(2), IkTask::posture(q0).priority(1), ...
struct IkTask {
  dynIkTask value;
  Vector reference, component_weights;

  static IkTask pose(int frame, const Placement& X) { return IkTask(DYN_IK_TASK_TYPE_POSE, frame, X.data(), 0, 12); }
  static IkTask position(int frame, const Vector3& x) { return IkTask(DYN_IK_TASK_TYPE_POSITION, frame, x.data(), 9, 3); }
  static IkTask orientation(int frame, const std::array<double, 9>& R) {
    return IkTask(DYN_IK_TASK_TYPE_ORIENTATION, frame, R.data(), 0, 9);
  }
  static IkTask com(const Vector3& x) { return IkTask(DYN_IK_TASK_TYPE_COM, 0, x.data(), 9, 3); }
  static IkTask posture(Vector q) {
    IkTask task(DYN_IK_TASK_TYPE_POSTURE, 0, nullptr, 0, 0);
    return task.reference = std::move(q), task;
  }
  IkTask& weight(double w) { return value.weight = w, *this; }
  IkTask& weights(Vector w) { return component_weights = std::move(w), *this; }
  IkTask& priority(int p) { return value.priority = p, *this; }

  // As dyn.h takes it; refuses wrong sizes. Points into this.
  dynIkTask of(int nq, int nv) const {
    dynIkTask out = value;
    if (value.type == DYN_IK_TASK_TYPE_POSTURE) out.posture = Input(reference).of(nq, "posture");
    const int n = value.type == DYN_IK_TASK_TYPE_POSTURE ? nv : value.type == DYN_IK_TASK_TYPE_POSE ? 6 : 3;
    out.weights = component_weights.empty() ? nullptr : Input(component_weights).of(n, "weights");
    return out;
  }

 private:
  IkTask(dynIkTaskType type, int frame, const double* x, int at, int n) {
    dyn_ik_task_init(&value);
    value.type = type, value.frame = frame;
    for (int k = 0; k < n; ++k) value.target[at + k] = x[k];
  }
};

struct IkOptions {
  dynIkOptions value;
  IkOptions() { dyn_ik_options_init(&value); }
};

// The robot. Immutable: copies share it, and threads may.
class Model {
 public:
  // Takes over a model made by dyn.h.
  explicit Model(dynModel* model) : model_(model, dyn_model_free), nq_(dyn_model_nq(model)), nv_(dyn_model_nv(model)) {
    if (nq_ < 0) throw Error(DYN_ERROR_HANDLE);
  }
  static Model load(const std::string& path, const LoadOptions& options = {}) { return load_(dyn_model_load, path, options); }
  static Model load_string(const std::string& text, const LoadOptions& options = {}) {
    return load_(dyn_model_load_string, text, options);
  }
  // A model in a buffer, without a copy. The buffer lies on a boundary of 64 bytes and outlives all copies of the model.
  static Model from_buffer(const void* buffer, std::size_t size) {
    const dynModel* model = nullptr;
    check(dyn_model_from_buffer(buffer, size, &model));
    return Model(const_cast<dynModel*>(model));
  }
  // The bytes for it: flags DYN_IMAGE_...
  std::vector<char> image(std::uint32_t flags = 0) const {
    std::size_t size = 0;
    check(dyn_model_image(get(), flags, nullptr, 0, &size));
    std::vector<char> out(size);
    check(dyn_model_image(get(), flags, out.data(), size, &size));
    return out;
  }
  // Writes the format of the extension: .urdf, .xml or .mjcf, .dynb. Returns the losses (WARNING) and other forms (INFO).
  std::vector<std::pair<dynReportLevel, std::string>> save(const std::string& path, bool strict = false) const {
    std::vector<std::pair<dynReportLevel, std::string>> lines;
    dynSaveOptions options;
    dyn_save_options_init(&options);
    options.strict = strict, options.context = &lines;
    options.report = [](void* to, dynReportLevel level, const char* message) {
      static_cast<decltype(lines)*>(to)->emplace_back(level, message);
    };
    check(dyn_model_save(get(), path.c_str(), &options));
    return lines;
  }
  const dynModel* get() const noexcept { return model_.get(); }

  int nq() const noexcept { return nq_; }
  int nv() const noexcept { return nv_; }
  int njoints() const noexcept { return dyn_model_njoints(get()); }
  int nframes() const noexcept { return dyn_model_nframes(get()); }
  int nbodies() const noexcept { return dyn_model_nbodies(get()); }
  int nshapes() const noexcept { return dyn_model_nshapes(get()); }
  std::size_t size() const noexcept { return dyn_model_size(get()); }
  double total_mass() const noexcept { return dyn_model_total_mass(get()); }
  std::string name() const { return dyn_model_name(get()); }

  int joint_id(const std::string& name) const { return id_(dyn_model_joint_id(get(), name.c_str())); }
  int frame_id(const std::string& name) const { return id_(dyn_model_frame_id(get(), name.c_str())); }
  int frame_id(const std::string& name, dynFrameType type) const {
    return id_(dyn_model_frame_id_of_type(get(), name.c_str(), type));
  }
  std::string joint_name(int joint) const { return name_(dyn_model_joint_name(get(), joint)); }
  std::string frame_name(int frame) const { return name_(dyn_model_frame_name(get(), frame)); }
  dynJointInfo joint_info(int joint) const { return info_<dynJointInfo>(dyn_model_joint_info, joint); }
  dynFrameInfo frame_info(int frame) const { return info_<dynFrameInfo>(dyn_model_frame_info, frame); }
  dynShapeInfo shape_info(int shape) const { return info_<dynShapeInfo>(dyn_model_shape_info, shape); }
  int npairs() const noexcept { return dyn_model_npairs(get()); }
  // The shapes of a pair.
  std::pair<int, int> pair(int pair) const {
    std::pair<int, int> out;
    check(dyn_model_pair(get(), pair, &out.first, &out.second, nullptr));
    return out;
  }
  int nconstraints() const noexcept { return dyn_model_nconstraints(get()); }
  int nconstraint_slots() const noexcept { return dyn_model_nconstraint_slots(get()); }
  int contact_capacity() const noexcept { return dyn_model_contact_capacity(get()); }
  std::string constraint_name(int constraint) const { return name_(dyn_model_constraint_name(get(), constraint)); }
  int constraint_id(const std::string& name) const { return id_(dyn_model_constraint_id(get(), name.c_str())); }
  dynConstraint constraint_info(int constraint) const { return info_<dynConstraint>(dyn_model_constraint_info, constraint); }
  int nactuators() const noexcept { return dyn_model_nactuators(get()); }
  int nu() const noexcept { return dyn_model_nu(get()); }
  std::string actuator_name(int actuator) const { return name_(dyn_model_actuator_name(get(), actuator)); }
  int actuator_id(const std::string& name) const { return id_(dyn_model_actuator_id(get(), name.c_str())); }
  dynActuator actuator_info(int actuator) const { return info_<dynActuator>(dyn_model_actuator_info, actuator); }
  int nforce_limits() const noexcept { return dyn_model_nforce_limits(get()); }
  dynForceLimit force_limit_info(int limit) const { return info_<dynForceLimit>(dyn_model_force_limit_info, limit); }
  int nmocaps() const noexcept { return dyn_model_nmocaps(get()); }
  int mocap_id(const std::string& name) const { return id_(dyn_model_mocap_id(get(), name.c_str())); }
  int mocap_frame(int mocap) const { return id_(dyn_model_mocap_frame(get(), mocap)); }
  int ntendons() const noexcept { return dyn_model_ntendons(get()); }
  std::string tendon_name(int tendon) const { return name_(dyn_model_tendon_name(get(), tendon)); }
  int tendon_id(const std::string& name) const { return id_(dyn_model_tendon_id(get(), name.c_str())); }
  dynTendon tendon_info(int tendon) const { return info_<dynTendon>(dyn_model_tendon_info, tendon); }
  dynTendonElement tendon_element(int tendon, int element) const {
    dynTendonElement out{};
    out.struct_size = sizeof out;
    check(dyn_model_tendon_element(get(), tendon, element, &out));
    return out;
  }
  int nsensors() const noexcept { return dyn_model_nsensors(get()); }
  int nsensordata() const noexcept { return dyn_model_nsensordata(get()); }
  std::string sensor_name(int sensor) const { return name_(dyn_model_sensor_name(get(), sensor)); }
  int sensor_id(const std::string& name) const { return id_(dyn_model_sensor_id(get(), name.c_str())); }
  dynSensor sensor_info(int sensor) const { return info_<dynSensor>(dyn_model_sensor_info, sensor); }
  // adds noise to values of Data::sensors
  void sensor_noise(std::uint64_t seed, std::uint64_t count, Vector& values) const {
    check(dyn_sensor_noise(get(), seed, count, values.data()));
  }
  // values with the sensors' delays; readings: nsensordata for each of the times
  Vector sensor_delay(const Vector& times, const Vector& readings, double time) const {
    Vector values(static_cast<std::size_t>(nsensordata()));
    if (readings.size() != times.size() * values.size()) throw Error(DYN_ERROR_SIZE);
    const auto count = static_cast<std::int64_t>(times.size());
    check(dyn_sensor_delay(get(), times.data(), readings.data(), count, time, values.data()));
    return values;
  }
  int report_count() const noexcept { return dyn_model_report_count(get()); }
  dynReportEntry report_entry(int index) const { return info_<dynReportEntry>(dyn_model_report_entry, index); }

  // 10 x (njoints - 1): the ten of each joint's body
  Matrix inertial_parameters() const {
    Matrix pi(10, njoints() - 1);
    check(dyn_model_inertial_parameters(get(), pi.data()));
    return pi;
  }
  // Limits, armature, damping, friction, springs, gravity: lives as long as the model.
  View array(dynModelArray which) const {
    const bool of_q =
        which == DYN_MODEL_ARRAY_LOWER_LIMIT || which == DYN_MODEL_ARRAY_UPPER_LIMIT || which == DYN_MODEL_ARRAY_SPRING_REFERENCE;
    const int n = which == DYN_MODEL_ARRAY_GRAVITY ? 3 : of_q ? nq_ : nv_;
    const double* p = dyn_model_array(get(), which);
    if (!p && n) throw Error(DYN_ERROR_ARGUMENT);
    return View({sizeof(dynArray), n, 1, {1, n}, p});
  }
  // How a shape looks: red, green, blue, opacity, 0 to 1; -1 where its file does not say.
  std::array<double, 4> shape_rgba(int shape) const {
    std::array<double, 4> rgba;
    check(dyn_model_shape_rgba(get(), shape, rgba.data()));
    return rgba;
  }
  // Two links that an SRDF takes out of collision tests.
  struct DisabledPair {
    int frame1, frame2;
    std::string reason;
  };
  std::vector<DisabledPair> disabled_pairs() const {
    std::vector<DisabledPair> out;
    for (int i = 0; i < dyn_model_ndisabled_pairs(get()); ++i) {
      DisabledPair pair;
      const char* reason;
      check(dyn_model_disabled_pair(get(), i, &pair.frame1, &pair.frame2, &reason));
      pair.reason = reason;
      out.push_back(std::move(pair));
    }
    return out;
  }
  std::vector<std::string> configurations() const {
    std::vector<std::string> names;
    for (int i = 0; i < dyn_model_nconfigurations(get()); ++i) names.push_back(name_(dyn_model_configuration_name(get(), i)));
    return names;
  }
  Vector configuration(const std::string& name) const {
    return q_([&](double* q) { return dyn_model_configuration(get(), name.c_str(), q); });
  }
  // First index in q and in v of each joint.
  std::pair<std::vector<int32_t>, std::vector<int32_t>> q_permutation(const std::vector<std::string>& names) const {
    std::vector<const char*> pointers;
    for (const auto& n : names) pointers.push_back(n.c_str());
    std::pair<std::vector<int32_t>, std::vector<int32_t>> out{std::vector<int32_t>(names.size()),
                                                              std::vector<int32_t>(names.size())};
    check(dyn_model_q_permutation(get(), pointers.data(), names.size(), out.first.data(), out.second.data()));
    return out;
  }

  // Sizes of the peer's q and v.
  std::pair<int, int> sizes(const StateLayout& layout) const {
    std::pair<int, int> n;
    layout_(layout, [&](const dynStateLayout* l) { return dyn_state_layout_sizes(get(), l, &n.first, &n.second); });
    return n;
  }
  State to_peer(const StateLayout& layout, Input q, Input v = none, Input a = none, Input tau = none) const {
    return convert_(layout, DYN_DIRECTION_TO_PEER, {nq_, nv_}, sizes(layout), {q, v, a, tau});
  }
  State from_peer(const StateLayout& layout, Input q, Input v = none, Input a = none, Input tau = none) const {
    return convert_(layout, DYN_DIRECTION_FROM_PEER, sizes(layout), {nq_, nv_}, {q, v, a, tau});
  }

  Vector neutral() const {
    return q_([&](double* q) { return dyn_configuration_neutral(get(), q); });
  }
  Vector random(uint64_t seed, Input lower = none, Input upper = none) const {
    return q_(
        [&](double* q) { return dyn_configuration_random(get(), seed, lower.of(nq_, "lower"), upper.of(nq_, "upper"), q); });
  }
  Vector integrate(Input q, Input v) const {
    return q_([&](double* out) { return dyn_integrate(get(), q.of(nq_, "q"), v.of(nv_, "v"), out); });
  }
  Vector interpolate(Input q0, Input q1, double u) const {
    return q_([&](double* out) { return dyn_interpolate(get(), q0.of(nq_, "q0"), q1.of(nq_, "q1"), u, out); });
  }
  Vector difference(Input q0, Input q1) const {
    Vector v(static_cast<std::size_t>(nv_));
    check(dyn_difference(get(), q0.of(nq_, "q0"), q1.of(nq_, "q1"), v.data()));
    return v;
  }
  double distance(Input q0, Input q1) const {
    double out;
    check(dyn_configuration_distance(get(), q0.of(nq_, "q0"), q1.of(nq_, "q1"), &out));
    return out;
  }
  Vector normalize(Vector q) const {
    Input(q).of(nq_, "q");
    check(dyn_configuration_normalize(get(), q.data()));
    return q;
  }
  bool is_normalized(Input q, double tolerance = 1e-9) const {
    int yes;
    check(dyn_configuration_is_normalized(get(), q.of(nq_, "q"), tolerance, &yes));
    return yes != 0;
  }
  std::pair<Matrix, Matrix> integrate_jacobians(Input q, Input v) const {
    std::pair<Matrix, Matrix> out{Matrix(nv_, nv_), Matrix(nv_, nv_)};
    check(dyn_integrate_jacobians(get(), q.of(nq_, "q"), v.of(nv_, "v"), out.first.data(), out.second.data()));
    return out;
  }
  std::pair<Matrix, Matrix> difference_jacobians(Input q0, Input q1) const {
    std::pair<Matrix, Matrix> out{Matrix(nv_, nv_), Matrix(nv_, nv_)};
    check(dyn_difference_jacobians(get(), q0.of(nq_, "q0"), q1.of(nq_, "q1"), out.first.data(), out.second.data()));
    return out;
  }

 private:
  std::shared_ptr<dynModel> model_;
  int nq_, nv_;

  template <class F>
  static Model load_(F call, const std::string& what, const LoadOptions& options) {
    std::vector<const char*> folders;
    for (const auto& f : options.folders) folders.push_back(f.c_str());
    dynLoadOptions o = options.value;
    if (!folders.empty()) o.package_dirs = folders.data(), o.package_dirs_count = folders.size();
    if (!options.srdf_path.empty()) o.srdf = options.srdf_path.c_str();
    dynModel* model = nullptr;
    check(call(what.c_str(), &o, &model));
    return Model(model);
  }
  template <class F>
  Vector q_(F call) const {
    Vector q(static_cast<std::size_t>(nq_));
    check(call(q.data()));
    return q;
  }
  template <class F>
  static void layout_(const StateLayout& layout, F call) {
    dynStateLayout l = layout.value;
    std::vector<const char*> names;
    for (const auto& n : layout.names) names.push_back(n.c_str());
    if (!names.empty()) l.joints = names.data(), l.joints_count = names.size();
    if (!layout.idx_q.empty() || !layout.idx_v.empty()) {
      if (layout.idx_q.size() != names.size() || layout.idx_v.size() != names.size())
        throw Error(DYN_ERROR_SIZE, "StateLayout: idx_q and idx_v need one index for each of joints.");
      l.idx_q = layout.idx_q.data(), l.idx_v = layout.idx_v.data();
    }
    if (!layout.frame.empty()) l.child_frame = layout.frame.c_str();
    check(call(&l));
  }
  State convert_(const StateLayout& layout, dynDirection direction, std::pair<int, int> from, std::pair<int, int> to,
                 const std::array<Input, 4>& in) const {
    const dynStateInput given = {sizeof given, in[0].of(from.first, "q"), in[1].of(from.second, "v"), in[2].of(from.second, "a"),
                                 in[3].of(from.second, "tau")};
    auto room = [](bool wanted, int n) { return Vector(wanted ? static_cast<std::size_t>(n) : 0); };
    State s{room(true, to.first), room(in[1].given(), to.second), room(in[2].given(), to.second), room(in[3].given(), to.second)};
    auto out = [](Vector& x) { return x.empty() ? nullptr : x.data(); };
    layout_(layout, [&](const dynStateLayout* l) {
      const dynStateOutput where = {sizeof where, out(s.q), out(s.v), out(s.a), out(s.tau)};
      return dyn_state_layout_convert(get(), l, direction, &given, &where);
    });
    return s;
  }
  template <class T, class F>
  T info_(F call, int index) const {
    T info{};
    info.struct_size = sizeof(T);
    check(call(get(), index, &info));
    return info;
  }
  static int id_(int id) { return id < 0 ? throw Error(DYN_ERROR_NAME) : id; }
  static std::string name_(const char* name) { return name ? name : throw Error(DYN_ERROR_ARGUMENT); }
};

// State and results: one for each thread. Keeps the model alive.
class Data {
 public:
  explicit Data(Model model, dynParts parts = DYN_PART_ALL) : model_(std::move(model)) {
    dynData* data = nullptr;
    check(dyn_data_new(m(), parts, &data));
    data_.reset(data);
  }
  // In the caller's memory: no heap.
  Data(Model model, dynParts parts, void* memory, std::size_t size) : model_(std::move(model)) {
    dynData* data = nullptr;
    check(dyn_data_init(m(), parts, memory, size, &data));
    data_.reset(data);
  }
  static std::size_t size(const Model& model, dynParts parts = DYN_PART_ALL) { return dyn_data_size(model.get(), parts); }
  const Model& model() const noexcept { return model_; }
  dynData* get() const noexcept { return data_.get(); }

  void set_state(Input q, Input v = held, Input a = held, Input tau = held) {
    check(dyn_data_set_state(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), a.of(nv(), "a"), tau.of(nv(), "tau")));
  }
  // To be called once in each thread with a deadline: later calls wait for no page of memory.
  void warm_up() { check(dyn_data_warm_up(m(), get())); }
  // Each effect of steps, whether it acts, and its memory.
  std::vector<dynEffectInfo> plan() {
    std::vector<dynEffectInfo> out(static_cast<std::size_t>(dyn_effect_count()));
    for (std::size_t k = 0; k < out.size(); ++k) {
      out[k].struct_size = sizeof out[k];
      check(dyn_data_effect_info(m(), get(), static_cast<int>(k), &out[k]));
    }
    return out;
  }
  // DYN_EFFECT_... of a joint, or of all (0).
  void set_effects(uint32_t effects, int joint = 0) { check(dyn_data_set_effects(m(), get(), joint, effects)); }
  uint32_t effects(int joint = 0) const {
    uint32_t out;
    check(dyn_data_effects(m(), get(), joint, &out));
    return out;
  }
  View field(dynField id) const {
    dynArray array{};
    array.struct_size = sizeof array;
    check(dyn_data_array(m(), get(), id, &array));
    return View(array);
  }
  View field(const std::string& name) const {
    const dynField id = dyn_field_id(name.c_str());
    if (id < 0) throw Error(DYN_ERROR_NAME);
    return field(id);
  }
  View q() const {
    static const dynField id = dyn_field_id("q");
    return field(id);
  }
  View v() const {
    static const dynField id = dyn_field_id("v");
    return field(id);
  }
  double time() const {
    static const dynField id = dyn_field_id("time");
    return field(id)[0];
  }

  // kinematics
  void forward_kinematics(Input q = held, Input v = none, Input a = none) {
    check(dyn_forward_kinematics(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), a.of(nv(), "a")));
  }
  Placement frame_placement(int frame) {
    Placement out;
    check(dyn_frame_placement(m(), get(), frame, out.data()));
    return out;
  }
  View frame_placements() {  // 12 x nframes
    static const dynField id = dyn_field_id("placements");
    check(dyn_frame_placements(m(), get(), nullptr));
    return field(id);
  }
  Vector6 frame_velocity(int frame, dynReference r = DYN_REFERENCE_LOCAL) { return six(dyn_frame_velocity, frame, r); }
  Vector6 frame_acceleration(int frame, dynReference r = DYN_REFERENCE_LOCAL) { return six(dyn_frame_acceleration, frame, r); }
  Vector6 frame_classical_acceleration(int frame, dynReference r = DYN_REFERENCE_LOCAL) {
    return six(dyn_frame_classical_acceleration, frame, r);
  }
  View joint_jacobians(Input q = held) {
    static const dynField id = dyn_field_id("J");
    return result(id, dyn_joint_jacobians(m(), get(), q.of(nq(), "q"), nullptr));
  }
  View joint_jacobians_time_variation(Input q = held, Input v = held) {
    static const dynField id = dyn_field_id("dJ");
    return result(id, dyn_joint_jacobians_time_variation(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), nullptr));
  }
  Matrix frame_jacobian(int frame, dynReference r = DYN_REFERENCE_LOCAL) {
    return own(6, [&](double* J) { return dyn_frame_jacobian(m(), get(), frame, r, J); });
  }
  Matrix frame_jacobian_time_variation(int frame, dynReference r = DYN_REFERENCE_LOCAL) {
    return own(6, [&](double* J) { return dyn_frame_jacobian_time_variation(m(), get(), frame, r, J); });
  }
  struct FrameVelocityDerivatives {
    Matrix dv_dq, dv_dv;
  };
  FrameVelocityDerivatives frame_velocity_derivatives(int frame, dynReference r = DYN_REFERENCE_LOCAL) {
    FrameVelocityDerivatives x{Matrix(6, nv()), Matrix(6, nv())};
    check(dyn_frame_velocity_derivatives(m(), get(), frame, r, x.dv_dq.data(), x.dv_dv.data()));
    return x;
  }
  struct FrameAccelerationDerivatives {
    Matrix da_dq, da_dv, da_da;
  };
  FrameAccelerationDerivatives frame_acceleration_derivatives(int frame, dynReference r = DYN_REFERENCE_LOCAL) {
    return by_q_v_a(dyn_frame_acceleration_derivatives, frame, r);
  }
  FrameAccelerationDerivatives frame_classical_acceleration_derivatives(int frame, dynReference r = DYN_REFERENCE_LOCAL) {
    return by_q_v_a(dyn_frame_classical_acceleration_derivatives, frame, r);
  }
  // 6 x nv nv: the k-th 6 x nv is the derivative of the Jacobian by q_k
  Matrix frame_kinematic_hessian(int frame, dynReference r = DYN_REFERENCE_LOCAL) {
    Matrix H(6, nv() * nv());
    check(dyn_frame_kinematic_hessian(m(), get(), frame, r, H.data()));
    return H;
  }

  struct Tendons {
    Vector length, velocity;
    Matrix J;  // ntendons x nv
  };
  Tendons tendons(Input q = held, Input v = held) {
    const int n = dyn_model_ntendons(m());
    Tendons x{Vector(static_cast<std::size_t>(n)), Vector(static_cast<std::size_t>(n)), Matrix(n, nv())};
    check(dyn_tendons(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), x.length.data(), x.velocity.data(), x.J.data()));
    return x;
  }
  // 3 x n: points of the path of a SPATIAL tendon at the configuration of tendons(); begins: 1 where a branch begins
  Matrix tendon_path(int tendon, std::vector<std::int32_t>* begins = nullptr) {
    const int n = dyn_tendon_path(m(), get(), tendon, 0, nullptr, nullptr);
    if (n < 0) throw Error(DYN_ERROR_ARGUMENT);
    Matrix points(3, n);
    if (begins) begins->resize(static_cast<std::size_t>(n));
    dyn_tendon_path(m(), get(), tendon, n, points.data(), begins ? begins->data() : nullptr);
    return points;
  }

  // values of all sensors
  Vector sensors(Input q = held, Input v = held, Input a = held) {
    Vector values(static_cast<std::size_t>(dyn_model_nsensordata(m())));
    check(dyn_sensors(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), a.of(nv(), "a"), values.data()));
    return values;
  }

  // centre of mass; with v and a also the fields "vcom" and "acom"
  View compute_com(Input q = held, Input v = none, Input a = none) {
    static const dynField id = dyn_field_id("com");
    return result(id,
                  dyn_com(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), a.of(nv(), "a"), nullptr, nullptr, nullptr));
  }
  View jcom(Input q = held) {
    static const dynField id = dyn_field_id("Jcom");
    return result(id, dyn_jcom(m(), get(), q.of(nq(), "q"), nullptr));
  }
  struct VcomDerivatives {
    View dvcom_dq, dvcom_dv;
  };
  VcomDerivatives vcom_derivatives(Input q = held, Input v = held) {
    check(dyn_vcom_derivatives(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), nullptr, nullptr));
    return {field("dvcom_dq"), field("Jcom")};
  }
  std::pair<Vector3, double> subtree_com(int joint) {  // and its mass
    std::pair<Vector3, double> out;
    check(dyn_subtree_com(m(), get(), joint, out.first.data(), &out.second));
    return out;
  }
  Matrix subtree_jcom(int joint) {
    return own(3, [&](double* J) { return dyn_subtree_jcom(m(), get(), joint, J); });
  }

  // centroidal; the map also brings the fields "Ig" and "hg"
  View centroidal_map(Input q = held, Input v = held) {
    static const dynField id = dyn_field_id("Ag");
    return result(id, dyn_centroidal_map(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), nullptr, nullptr, nullptr));
  }
  View centroidal_map_time_variation(Input q = held, Input v = held) {
    static const dynField id = dyn_field_id("dAg");
    return result(id, dyn_centroidal_map_time_variation(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), nullptr));
  }
  View centroidal_momentum(Input q = held, Input v = held) {
    static const dynField id = dyn_field_id("hg");
    return result(id, dyn_centroidal_momentum(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), nullptr));
  }
  View centroidal_momentum_time_variation(Input q = held, Input v = held, Input a = held) {
    static const dynField id = dyn_field_id("dhg");
    return result(id,
                  dyn_centroidal_momentum_time_variation(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), a.of(nv(), "a"), nullptr));
  }
  struct CentroidalDerivatives {
    View dh_dq, dhdot_dq, dhdot_dv, dhdot_da;
  };
  CentroidalDerivatives centroidal_derivatives(Input q = held, Input v = held, Input a = held) {
    check(dyn_centroidal_derivatives(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), a.of(nv(), "a"), nullptr));
    return {field("dh_dq"), field("dhdot_dq"), field("dhdot_dv"), field("Ag")};
  }

  // identification: regressors of Model::inertial_parameters
  View joint_torque_regressor(Input q = held, Input v = held, Input a = held) {
    static const dynField id = dyn_field_id("regressor");
    return result(id, dyn_joint_torque_regressor(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), a.of(nv(), "a"), nullptr));
  }
  View compute_static_regressor(Input q = held) {
    static const dynField id = dyn_field_id("static_regressor");
    return result(id, dyn_static_regressor(m(), get(), q.of(nq(), "q"), nullptr));
  }
  View compute_kinetic_energy_regressor(Input q = held, Input v = held) {
    static const dynField id = dyn_field_id("kinetic_energy_regressor");
    return result(id, dyn_kinetic_energy_regressor(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), nullptr));
  }
  View compute_potential_energy_regressor(Input q = held) {
    static const dynField id = dyn_field_id("potential_energy_regressor");
    return result(id, dyn_potential_energy_regressor(m(), get(), q.of(nq(), "q"), nullptr));
  }
  Matrix joint_body_regressor(int joint) {
    Matrix Y(6, 10);
    check(dyn_joint_body_regressor(m(), get(), joint, Y.data()));
    return Y;
  }
  Matrix frame_body_regressor(int frame) {
    Matrix Y(6, 10);
    check(dyn_frame_body_regressor(m(), get(), frame, Y.data()));
    return Y;
  }

  // dynamics
  View rnea(Input q = held, Input v = held, Input a = held, Input fext = none) {
    static const dynField id = dyn_field_id("tau");
    return result(id, dyn_rnea(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), a.of(nv(), "a"), forces(fext), nullptr));
  }
  View compute_nle(Input q = held, Input v = held) {
    static const dynField id = dyn_field_id("nle");
    return result(id, dyn_nle(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), nullptr));
  }
  View gravity_torque(Input q = held) {
    static const dynField id = dyn_field_id("g");
    return result(id, dyn_gravity_torque(m(), get(), q.of(nq(), "q"), nullptr));
  }
  View compute_static_torque(Input q = held, Input fext = none) {
    static const dynField id = dyn_field_id("static_torque");
    return result(id, dyn_static_torque(m(), get(), q.of(nq(), "q"), forces(fext), nullptr));
  }
  View coriolis_matrix(Input q = held, Input v = held) {
    static const dynField id = dyn_field_id("coriolis");
    return result(id, dyn_coriolis_matrix(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), nullptr));
  }
  View aba(Input q = held, Input v = held, Input tau = held, Input fext = none) {
    static const dynField id = dyn_field_id("ddq");
    return result(id, dyn_aba(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), tau.of(nv(), "tau"), forces(fext), nullptr));
  }
  View crba(Input q = held) {
    static const dynField id = dyn_field_id("M");
    return result(id, dyn_crba(m(), get(), q.of(nq(), "q"), nullptr));
  }
  void cholesky() { check(dyn_cholesky(m(), get())); }
  Vector cholesky_solve(Input b, int nrhs = 1) {
    Vector x(static_cast<std::size_t>(nv()) * static_cast<std::size_t>(nrhs));
    check(dyn_cholesky_solve(m(), get(), b.of(nv() * nrhs, "b"), nrhs, x.data()));
    return x;
  }
  View minv(Input q = held) {
    static const dynField id = dyn_field_id("Minv");
    return result(id, dyn_minv(m(), get(), q.of(nq(), "q"), nullptr));
  }
  struct InverseDerivatives {
    View dtau_dq, dtau_dv, dtau_da;
  };
  InverseDerivatives rnea_derivatives(Input q = held, Input v = held, Input a = held, Input fext = none) {
    check(dyn_rnea_derivatives(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), a.of(nv(), "a"), forces(fext), nullptr, nullptr));
    return {field("dtau_dq"), field("dtau_dv"), field("M")};
  }
  struct ForwardDerivatives {
    View ddq_dq, ddq_dv, ddq_dtau;
  };
  ForwardDerivatives aba_derivatives(Input q = held, Input v = held, Input tau = held, Input fext = none) {
    check(dyn_aba_derivatives(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), tau.of(nv(), "tau"), forces(fext), nullptr));
    return {field("ddq_dq"), field("ddq_dv"), field("Minv")};
  }
  View gravity_torque_derivatives(Input q = held) {
    static const dynField id = dyn_field_id("dg_dq");
    return result(id, dyn_gravity_torque_derivatives(m(), get(), q.of(nq(), "q"), nullptr));
  }
  View static_torque_derivatives(Input q = held, Input fext = none) {
    static const dynField id = dyn_field_id("dstatic_torque_dq");
    return result(id, dyn_static_torque_derivatives(m(), get(), q.of(nq(), "q"), forces(fext), nullptr));
  }
  struct SecondOrderProduct {
    View dqdq, dvdv, dqdv, dadq;
  };
  SecondOrderProduct rnea_second_order_product(Input lambda, Input q = held, Input v = held, Input a = held, Input fext = none) {
    check(dyn_rnea_second_order_product(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), a.of(nv(), "a"), forces(fext),
                                        lambda.of(nv(), "lambda"), nullptr));
    return {field("lambda_d2tau_dqdq"), field("lambda_d2tau_dvdv"), field("lambda_d2tau_dqdv"), field("lambda_d2tau_dadq")};
  }
  struct SecondOrderDerivatives {  // nv matrices nv x nv one after another, that of tau_1 first
    Vector d2tau_dqdq, d2tau_dvdv, d2tau_dqdv, d2tau_dadq;
  };
  SecondOrderDerivatives rnea_second_order_derivatives(Input q = held, Input v = held, Input a = held, Input fext = none) {
    const std::size_t n = static_cast<std::size_t>(nv());
    SecondOrderDerivatives x{Vector(n * n * n), Vector(n * n * n), Vector(n * n * n), Vector(n * n * n)};
    const dynSecondOrderDerivatives out = {sizeof out, x.d2tau_dqdq.data(), x.d2tau_dvdv.data(), x.d2tau_dqdv.data(),
                                           x.d2tau_dadq.data()};
    check(dyn_rnea_second_order_derivatives(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), a.of(nv(), "a"), forces(fext), &out));
    return x;
  }
  struct Energy {
    double kinetic, potential;
    double mechanical() const { return kinetic + potential; }
  };
  Energy energy(Input q = held, Input v = held) {
    Energy out;
    check(dyn_energy(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), &out.kinetic, &out.potential));
    return out;
  }
  double kinetic_energy(Input q = held, Input v = held) {
    double out;
    check(dyn_kinetic_energy(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), &out));
    return out;
  }
  double potential_energy(Input q = held) {
    double out;
    check(dyn_potential_energy(m(), get(), q.of(nq(), "q"), &out));
    return out;
  }
  uint32_t all_terms(uint32_t mask = DYN_TERM_ALL, Input q = held, Input v = held) {
    uint32_t filled;
    check(dyn_all_terms(m(), get(), mask, q.of(nq(), "q"), v.of(nv(), "v"), &filled));
    return filled;
  }

  // inverse kinematics
  struct IkSolution {
    Vector q;
    std::vector<std::array<double, 2>> residuals;  // of each task: m, rad
    dynIkResult result;
    bool converged() const { return result.reason == DYN_IK_REASON_CONVERGED; }
  };
  IkSolution ik(const std::vector<IkTask>& tasks, Input q = held, const IkOptions& options = {}) {
    std::vector<dynIkTask> list;
    for (const IkTask& task : tasks) list.push_back(task.of(nq(), nv()));
    IkSolution out{Vector(static_cast<std::size_t>(nq())), std::vector<std::array<double, 2>>(list.size()), {}};
    out.result.struct_size = sizeof out.result;
    const dynIkOutput where = {sizeof where, out.q.data(), out.residuals.empty() ? nullptr : out.residuals.front().data(),
                               &out.result};
    check(dyn_ik(m(), get(), q.of(nq(), "q"), list.data(), static_cast<int>(list.size()), &options.value, &where));
    return out;
  }

  // constraints: slots
  void set_constraint(int slot, const dynConstraint& c) { check(dyn_data_set_constraint(m(), get(), slot, &c)); }
  void clear_constraint(int slot) { check(dyn_data_set_constraint(m(), get(), slot, nullptr)); }
  dynConstraint constraint(int slot) {
    dynConstraint out;
    dyn_constraint_init(&out, DYN_CONSTRAINT_TYPE_NONE);
    check(dyn_data_constraint(m(), get(), slot, &out));
    return out;
  }
  void set_constraint_enabled(int slot, bool on = true) { check(dyn_data_set_constraint_enabled(m(), get(), slot, on)); }
  void anchor_constraint(int slot, Input q = held) { check(dyn_data_anchor_constraint(m(), get(), slot, q.of(nq(), "q"))); }
  // First row and number of rows of a slot; -1: of all.
  std::pair<int, int> constraint_rows(int slot = -1) {
    std::pair<int, int> out;
    check(dyn_data_constraint_rows(m(), get(), slot, &out.first, &out.second));
    return out;
  }
  struct ConstraintTerms {
    Vector C, Jv, drift;
    Matrix J;
  };
  ConstraintTerms constraint_terms(Input q = held, Input v = held) {
    const int n = constraint_rows().second;
    ConstraintTerms out{rows_(), rows_(), rows_(), Matrix(n, nv())};
    check(dyn_constraint_terms(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), out.C.data(), out.J.data(), out.Jv.data(),
                               out.drift.data()));
    return out;
  }
  // x: ddq, tau, or the velocity after an impact; lambda: forces or impulses of the rows.
  struct Constrained {
    Vector x, lambda;
    dynConstraintResult result;
  };
  Constrained constrained_dynamics(Input q = held, Input v = held, Input tau = held, Input fext = none,
                                   const ConstraintOptions& options = {}) {
    return constrained_([&](Constrained& out) {
      const dynConstrainedOutput where = {sizeof where, out.x.data(), nullptr, out.lambda.data(), &out.result};
      return dyn_constrained_dynamics(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), tau.of(nv(), "tau"), forces(fext),
                                      &options.value, &where);
    });
  }
  // actuated: one number for each degree of freedom, 0: not; empty: all but a floating base.
  Constrained constrained_inverse_dynamics(Input q = held, Input v = held, Input a = held, Input fext = none,
                                           const std::vector<int32_t>& actuated = {}) {
    if (!actuated.empty() && actuated.size() != static_cast<std::size_t>(nv()))
      throw Error(DYN_ERROR_SIZE, "actuated must have nv numbers.");
    return constrained_([&](Constrained& out) {
      const dynConstrainedOutput where = {sizeof where, nullptr, out.x.data(), out.lambda.data(), &out.result};
      return dyn_constrained_inverse_dynamics(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), a.of(nv(), "a"), forces(fext),
                                              actuated.empty() ? nullptr : actuated.data(), &where);
    });
  }
  Constrained constraint_impulse(Input q = held, Input v = held, const ConstraintOptions& options = {}) {
    return constrained_([&](Constrained& out) {
      return dyn_constraint_impulse(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), &options.value, out.x.data(), out.lambda.data(),
                                    &out.result);
    });
  }
  struct Projection {
    Vector q, v;
    dynConstraintResult result;
  };
  Projection project(Input q = held, Input v = held, const ProjectOptions& options = {}) {
    Projection out{Vector(static_cast<std::size_t>(nq())), Vector(static_cast<std::size_t>(nv())), {}};
    out.result.struct_size = sizeof out.result;
    check(dyn_project(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), &options.value, out.q.data(), out.v.data(), &out.result));
    return out;
  }
  Matrix delassus(Input q = held) {
    Matrix out(constraint_rows().second, constraint_rows().second);
    check(dyn_delassus(m(), get(), q.of(nq(), "q"), out.data()));
    return out;
  }
  // Y (nv x rows) and D (nv) of Y' diag(D) Y.
  std::pair<Matrix, Vector> delassus_factor(Input q = held) {
    std::pair<Matrix, Vector> out{Matrix(nv(), constraint_rows().second), Vector(static_cast<std::size_t>(nv()))};
    check(dyn_delassus_factor(m(), get(), q.of(nq(), "q"), out.first.data(), out.second.data()));
    return out;
  }
  Vector delassus_times(Input x, Input q = held) {
    Vector out = rows_();
    check(dyn_delassus_times(m(), get(), q.of(nq(), "q"), x.of(static_cast<int>(out.size()), "x"), out.data()));
    return out;
  }
  Vector delassus_solve(Input x, double mu = 0, Input q = held) {
    Vector out = rows_();
    check(dyn_delassus_solve(m(), get(), q.of(nq(), "q"), mu, x.of(static_cast<int>(out.size()), "x"), out.data()));
    return out;
  }
  struct ConstrainedDerivatives {
    Matrix ddq_dq, ddq_dv, ddq_dtau, lambda_dq, lambda_dv, lambda_dtau;  // of impulses: v_plus, and nothing by tau
    dynConstraintResult result;
  };
  ConstrainedDerivatives constrained_dynamics_derivatives(Input q = held, Input v = held, Input tau = held, Input fext = none) {
    return derivatives_(true, [&](const dynConstraintDerivatives* out) {
      return dyn_constrained_dynamics_derivatives(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), tau.of(nv(), "tau"), forces(fext),
                                                  nullptr, out);
    });
  }
  ConstrainedDerivatives constraint_impulse_derivatives(Input q = held, Input v = held) {
    return derivatives_(false, [&](const dynConstraintDerivatives* out) {
      return dyn_constraint_impulse_derivatives(m(), get(), q.of(nq(), "q"), v.of(nv(), "v"), nullptr, out);
    });
  }
  std::pair<dynConstraintReport, std::vector<dynRowReport>> constraint_report(Input q = held) {
    std::pair<dynConstraintReport, std::vector<dynRowReport>> out;
    out.first = {}, out.first.struct_size = sizeof out.first;
    out.second.resize(static_cast<std::size_t>(constraint_rows().second));
    check(dyn_constraint_report(m(), get(), q.of(nq(), "q"), &out.first, out.second.data(), static_cast<int>(out.second.size())));
    return out;
  }

  // collision
  Vector distances(Input q = held) {
    Vector out(static_cast<std::size_t>(model_.npairs()));
    check(dyn_distances(m(), get(), q.of(nq(), "q"), out.data()));
    return out;
  }
  dynDistance pair_distance(int pair) {
    dynDistance out{};
    out.struct_size = sizeof out;
    check(dyn_pair_distance(m(), get(), pair, &out));
    return out;
  }
  Matrix distance_gradients() {  // npairs x nv
    Matrix out(model_.npairs(), static_cast<int>(nv()));
    check(dyn_distance_gradients(m(), get(), out.data()));
    return out;
  }
  std::vector<int> collisions(Input q = held, double margin = 0) {
    std::vector<int> out(static_cast<std::size_t>(model_.npairs()));
    int count = 0;
    check(dyn_collisions(m(), get(), q.of(nq(), "q"), margin, out.data(), static_cast<int>(out.size()), &count));
    out.resize(static_cast<std::size_t>(count));
    return out;
  }
  void set_pair(int pair, bool tested) { check(dyn_data_set_pair(m(), get(), pair, tested)); }
  dynPairReason pair_reason(int pair) {
    dynPairReason out;
    check(dyn_data_pair(m(), get(), pair, &out));
    return out;
  }
  // Contact points of all tested pairs.
  std::vector<dynContact> contacts(Input q = held, double margin = 0) {
    std::vector<dynContact> out(64);
    int count = 0;
    const double* at = q.of(nq(), "q");
    check(dyn_contacts(m(), get(), at, margin, out.data(), static_cast<int>(out.size()), &count));
    if (static_cast<std::size_t>(count) > out.size()) {
      out.resize(static_cast<std::size_t>(count));
      check(dyn_contacts(m(), get(), nullptr, margin, out.data(), count, &count));
    }
    out.resize(static_cast<std::size_t>(count));
    return out;
  }
  struct SmoothDistances {
    Vector distances;
    Matrix gradients;         // npairs x nv
    std::vector<int> points;  // 1: the plain distance, more: smoothed
  };
  SmoothDistances smooth_distances(double smoothing, Input q = held) {
    const int n = model_.npairs();
    SmoothDistances out{Vector(static_cast<std::size_t>(n)), Matrix(n, static_cast<int>(nv())),
                        std::vector<int>(static_cast<std::size_t>(n))};
    check(dyn_smooth_distances(m(), get(), q.of(nq(), "q"), smoothing, out.distances.data(), out.gradients.data(),
                               out.points.data()));
    return out;
  }
  // First hits of rays. origins and directions are 3 x n.
  struct Rays {
    Vector t;
    std::vector<int> shapes;  // -1: nothing
    Matrix normals;           // 3 x n
  };
  Rays rays(Input origins, Input directions, int n, Input q = held, double max_t = std::numeric_limits<double>::infinity(),
            uint32_t mask = 0xffffffffu) {
    Rays out{Vector(static_cast<std::size_t>(n)), std::vector<int>(static_cast<std::size_t>(n)), Matrix(3, n)};
    const dynRays rays = {sizeof rays, n, mask, origins.of(3 * n, "origins"), directions.of(3 * n, "directions"), max_t};
    check(dyn_rays(m(), get(), q.of(nq(), "q"), &rays, out.t.data(), out.shapes.data(), out.normals.data()));
    return out;
  }
  void set_shape_masks(int shape, uint32_t contype, uint32_t conaffinity) {
    check(dyn_data_set_shape_masks(m(), get(), shape, contype, conaffinity));
  }
  std::pair<uint32_t, uint32_t> shape_masks(int shape) {
    std::pair<uint32_t, uint32_t> out;
    check(dyn_data_shape_masks(m(), get(), shape, &out.first, &out.second));
    return out;
  }

  // simulation
  void set_step_options(dynIntegrator integrator, double dt = 1e-3, double accuracy = 0) {
    dynStepOptions options;
    dyn_step_options_init(&options);
    options.integrator = integrator, options.dt = dt, options.accuracy = accuracy;
    set_step_options(options);
  }
  // actuators, and forces from outside
  // placement of a mocap body: 12 numbers, rotation by columns, then translation
  void set_mocap(int mocap, const std::array<double, 12>& placement) {
    check(dyn_data_set_mocap(m(), get(), mocap, placement.data()));
  }
  std::array<double, 12> mocap(int mocap) {
    std::array<double, 12> out;
    check(dyn_data_mocap(m(), get(), mocap, out.data()));
    return out;
  }
  void set_control(const Vector& u) { check(dyn_data_set_control(m(), get(), Input(u).of(dyn_model_nu(m()), "u"))); }
  void apply_wrench(int frame, const Vector& wrench, dynReference reference = DYN_REFERENCE_LOCAL_WORLD_ALIGNED,
                    Input point = none) {
    check(dyn_data_apply_wrench(m(), get(), frame, point.of(3, "point"), Input(wrench).of(6, "wrench"), reference));
  }
  void clear_wrenches() { check(dyn_data_clear_wrenches(m(), get())); }
  void set_gravity(const Vector3& gravity) { check(dyn_data_set_gravity(m(), get(), gravity.data())); }
  void set_step_options(const dynStepOptions& options) { check(dyn_data_set_step_options(m(), get(), &options)); }
  dynStepOptions step_options() const {
    dynStepOptions options;
    dyn_step_options_init(&options);
    check(dyn_data_step_options(m(), get(), &options));
    return options;
  }
  void step() { check(dyn_step(m(), get())); }
  // Derivatives of a step, on the tangent space; x = (q, v).
  struct StepDerivatives {
    Matrix A, B, B_control;  // 2 nv x 2 nv; 2 nv x nv, by tau; 2 nv x nu
    Vector q, v;             // the next state
    std::vector<dynContactForce> contacts;
    std::vector<dynContactMode> modes;
    std::vector<bool> degenerate;
    dynStepDerivativeReport report;
    Matrix P;  // 2 nv x the numbers of the parameters
  };
  // A parameter of a step, and the joint, degree of freedom or shape that it is of.
  struct StepParameter {
    dynStepParameterType type;
    std::int32_t index = 0;
  };
  static dynStepDerivativeOptions step_derivative_options() {
    dynStepDerivativeOptions options;
    dyn_step_derivative_options_init(&options);
    return options;
  }
  StepDerivatives step_derivatives(const dynStepDerivativeOptions& options = step_derivative_options(),
                                   const std::vector<StepParameter>& parameters = {}) {
    const int nu = dyn_model_nu(m()), capacity = dyn_model_contact_capacity(m());
    const auto room = static_cast<std::size_t>(capacity);
    StepDerivatives x{Matrix(2 * nv(), 2 * nv()), Matrix(2 * nv(), nv()), Matrix(2 * nv(), nu),
                      Vector(static_cast<std::size_t>(nq())),
                      Vector(static_cast<std::size_t>(nv())), {}, {}, {}, {}, Matrix(2 * nv(), numbers_of_(parameters))};
    x.contacts.resize(room), x.modes.resize(room), x.report.struct_size = sizeof x.report;
    std::vector<std::int32_t> degenerate(room);
    dynStepDerivatives out;
    dyn_step_derivatives_init(&out);
    out.capacity = capacity, out.A = x.A.data(), out.B = x.B.data(), out.B_control = nu ? x.B_control.data() : nullptr;
    out.q = x.q.data(), out.v = x.v.data(), out.contacts = x.contacts.data(), out.modes = x.modes.data();
    out.degenerate = degenerate.data(), out.report = &x.report, out.P = x.P.data();
    differentiate_(out, options, parameters);
    const auto count = static_cast<std::size_t>(x.report.contacts);
    x.contacts.resize(count), x.modes.resize(count);
    x.degenerate.assign(degenerate.begin(), degenerate.begin() + x.report.contacts);
    return x;
  }
  // [A B B_control P] tangent, of the next state, without these matrices. tangent: of q, v, tau, controls and parameters.
  Vector step_jvp(Input tangent, const std::vector<StepParameter>& parameters = {},
                  const dynStepDerivativeOptions& options = step_derivative_options()) {
    Vector jvp(2 * static_cast<std::size_t>(nv()));
    dynStepDerivatives out;
    dyn_step_derivatives_init(&out);
    out.tangents = tangent.of(step_inputs_(parameters), "tangent"), out.jvp = jvp.data(), out.tangent_count = 1;
    differentiate_(out, options, parameters);
    return jvp;
  }
  // Its transpose: gradients by q, v, tau, controls and parameters from one by the next state, 2 nv numbers.
  Vector step_vjp(Input cotangent, const std::vector<StepParameter>& parameters = {},
                  const dynStepDerivativeOptions& options = step_derivative_options()) {
    Vector vjp(static_cast<std::size_t>(step_inputs_(parameters)));
    dynStepDerivatives out;
    dyn_step_derivatives_init(&out);
    out.cotangents = cotangent.of(2 * nv(), "cotangent"), out.vjp = vjp.data(), out.cotangent_count = 1;
    differentiate_(out, options, parameters);
    return vjp;
  }
  void advance(double duration) { check(dyn_advance(m(), get(), duration)); }
  dynStepReport step_report() const {
    dynStepReport report{};
    report.struct_size = sizeof report;
    check(dyn_data_step_report(m(), get(), &report));
    return report;
  }
  // Bounds on the error of this state, by a run with finer steps that began alike.
  dynErrorBar error_bar(Data& finer) {
    dynErrorBar bar{};
    bar.struct_size = sizeof bar;
    check(dyn_data_error_bar(m(), get(), finer.get(), &bar));
    return bar;
  }
  // Where energy and momentum went in them, with the option `ledger`.
  dynErrorLedger ledger() const {
    dynErrorLedger out{};
    out.struct_size = sizeof out;
    check(dyn_data_ledger(m(), get(), &out));
    return out;
  }
  // Contact points of the last step with their forces.
  std::vector<dynContactForce> step_contacts() {
    int count = 0;
    check(dyn_data_step_contacts(m(), get(), nullptr, 0, &count));
    std::vector<dynContactForce> out(static_cast<std::size_t>(count));
    check(dyn_data_step_contacts(m(), get(), out.data(), count, &count));
    return out;
  }
  // The state, with the contacts that the next step begins from.
  std::vector<unsigned char> save_state() {
    std::vector<unsigned char> out(dyn_model_state_size(m()));
    check(dyn_data_save_state(m(), get(), out.data(), out.size()));
    return out;
  }
  void restore_state(const std::vector<unsigned char>& state) {
    check(dyn_data_restore_state(m(), get(), state.data(), state.size()));
  }
  // The other's state and settings.
  void copy_from(Data& other) { check(dyn_data_copy(m(), get(), other.get())); }
  void set_shape_material(int shape, const dynMaterial& material) {
    check(dyn_data_set_shape_material(m(), get(), shape, &material));
  }
  dynMaterial shape_material(int shape) {
    dynMaterial out;
    check(dyn_data_shape_material(m(), get(), shape, &out));
    return out;
  }

 private:
  static int numbers_of_(const std::vector<StepParameter>& parameters) {
    int numbers = 0;
    for (const StepParameter& p : parameters)
      numbers += p.type == DYN_STEP_PARAMETER_TYPE_INERTIA ? 10 : p.type == DYN_STEP_PARAMETER_TYPE_GRAVITY ? 3 : 1;
    return numbers;
  }
  int step_inputs_(const std::vector<StepParameter>& parameters) const {
    return 3 * nv() + dyn_model_nu(m()) + numbers_of_(parameters);
  }
  void differentiate_(dynStepDerivatives& out, const dynStepDerivativeOptions& options,
                      const std::vector<StepParameter>& parameters) {
    std::vector<dynStepParameterType> types;
    std::vector<std::int32_t> index;
    for (const StepParameter& p : parameters) types.push_back(p.type), index.push_back(p.index);
    out.parameters = types.data(), out.parameter_index = index.data();
    out.parameter_count = static_cast<std::int32_t>(types.size());
    check(dyn_step_derivatives(m(), get(), &options, &out));
  }
  Vector rows_() { return Vector(static_cast<std::size_t>(constraint_rows().second)); }
  template <class F>
  Constrained constrained_(F f) {
    Constrained out{Vector(static_cast<std::size_t>(nv())), rows_(), {}};
    out.result.struct_size = sizeof out.result;
    check(f(out));
    return out;
  }
  template <class F>
  ConstrainedDerivatives derivatives_(bool by_tau, F f) {
    const int n = nv(), rows = constraint_rows().second;
    ConstrainedDerivatives out{Matrix(n, n), Matrix(n, n), Matrix(n, n), Matrix(rows, n), Matrix(rows, n), Matrix(rows, n), {}};
    out.result.struct_size = sizeof out.result;
    const dynConstraintDerivatives where = {sizeof where,
                                            out.ddq_dq.data(),
                                            out.ddq_dv.data(),
                                            by_tau ? out.ddq_dtau.data() : nullptr,
                                            out.lambda_dq.data(),
                                            out.lambda_dv.data(),
                                            by_tau ? out.lambda_dtau.data() : nullptr,
                                            &out.result};
    check(f(&where));
    return out;
  }
  struct Free {
    void operator()(dynData* data) const noexcept { dyn_data_free(data); }
  };
  Model model_;
  std::unique_ptr<dynData, Free> data_;

  const dynModel* m() const noexcept { return model_.get(); }
  int nq() const noexcept { return model_.nq(); }
  int nv() const noexcept { return model_.nv(); }
  const double* forces(const Input& fext) const { return fext.of(6 * model_.njoints(), "fext"); }
  View result(dynField id, dynStatus status) const { return check(status), field(id); }
  template <class F>
  Vector6 six(F call, int frame, dynReference r) {
    Vector6 out;
    check(call(m(), get(), frame, r, out.data()));
    return out;
  }
  template <class F>
  FrameAccelerationDerivatives by_q_v_a(F call, int frame, dynReference r) {
    FrameAccelerationDerivatives x{Matrix(6, nv()), Matrix(6, nv()), Matrix(6, nv())};
    check(call(m(), get(), frame, r, x.da_dq.data(), x.da_dv.data(), x.da_da.data()));
    return x;
  }
  template <class F>
  Matrix own(int rows, F call) {
    Matrix out(rows, nv());
    check(call(out.data()));
    return out;
  }
};

inline dynRollout rollout() {
  dynRollout x;
  dyn_rollout_init(&x);
  return x;
}
inline int sensor_size(dynSensorType sensor) { return dyn_sensor_size(sensor); }

// Inputs and outputs of a batch, state after state. dyn.h lists those of each algorithm.
class BatchArrays {
 public:
  BatchArrays() { dyn_batch_arrays_init(&value_); }
  BatchArrays& frame(int id) { return value_.frame = id, *this; }
  BatchArrays& joint(int id) { return value_.joint = id, *this; }
  BatchArrays& reference(dynReference r) { return value_.reference = r, *this; }
  BatchArrays& q(Input x) { return q_ = x, *this; }
  BatchArrays& v(Input x) { return v_ = x, *this; }
  BatchArrays& a(Input x) { return a_ = x, *this; }
  BatchArrays& tau(Input x) { return tau_ = x, *this; }
  BatchArrays& b(Input x) { return b_ = x, *this; }
  BatchArrays& fext(Input x) { return fext_ = x, *this; }
  BatchArrays& q1(Input x) { return q1_ = x, *this; }
  BatchArrays& mocap(Input x) { return mocap_ = x, *this; }
  BatchArrays& dt(double seconds) { return value_.dt = seconds, *this; }
  BatchArrays& integrator(dynIntegrator i) { return value_.integrator = i, *this; }
  BatchArrays& exact(bool x = true) { return value_.exact = x, *this; }
  // An output: a vector (or the like) of the right size.
  template <class V>
  BatchArrays& out(int k, V& x) {
    if (k < 0 || k > 3) throw Error(DYN_ERROR_ARGUMENT, "out " + std::to_string(k) + " does not exist: give 0 to 3.");
    value_.out[k] = x.data(), sizes_[static_cast<std::size_t>(k)] = static_cast<std::size_t>(x.size());
    return *this;
  }
  // The status of every state.
  BatchArrays& status(std::vector<dynStatus>& x) { return value_.status = x.data(), status_size_ = x.size(), *this; }

  // Checks all sizes.
  dynBatchArrays of(const Model& m, const dynAlgorithmInfo& info, int64_t n) const {
    dynBatchArrays x = value_;
    x.q = q_.of(n * m.nq(), "q"), x.v = v_.of(n * m.nv(), "v"), x.a = a_.of(n * m.nv(), "a"), x.tau = tau_.of(n * m.nv(), "tau");
    x.b = b_.of(n * m.nv(), "b"), x.fext = fext_.of(n * 6 * m.njoints(), "fext"), x.q1 = q1_.of(n * m.nq(), "q1");
    x.mocap = mocap_.of(n * 12 * m.nmocaps(), "mocap");
    for (int k = 0; k < info.outputs; ++k)
      if (x.out[k])
        Input(x.out[k], sizes_[static_cast<std::size_t>(k)]).of(n * info.rows[k] * info.cols[k] * info.pages[k], info.output[k]);
    if (x.status && status_size_ != static_cast<std::size_t>(n))
      throw Error(DYN_ERROR_SIZE, "status must have one element for each state.");
    return x;
  }

 private:
  dynBatchArrays value_;
  Input q_ = none, v_ = none, a_ = none, tau_ = none, b_ = none, fext_ = none, q1_ = none, mocap_ = none;
  std::array<std::size_t, 4> sizes_{};
  std::size_t status_size_ = 0;
};

// Every algorithm over n states with several threads:
//   dyn::Batch batch(model, 4);
//   batch.run(DYN_ALGORITHM_RNEA, n, dyn::BatchArrays().q(q).v(v).a(a).out(0, tau));
class Batch {
 public:
  explicit Batch(Model model, int threads, dynParts parts = DYN_PART_ALL) : model_(std::move(model)) {
    dynBatch* batch = nullptr;
    check(dyn_batch_new(model_.get(), parts, threads, &batch));
    batch_.reset(batch);
  }
  dynBatch* get() const noexcept { return batch_.get(); }
  const Model& model() const noexcept { return model_; }
  dynAlgorithmInfo info(dynAlgorithm algorithm) const {
    dynAlgorithmInfo out{};
    out.struct_size = sizeof out;
    check(dyn_algorithm_info(model_.get(), algorithm, &out));
    return out;
  }
  // Throws for the first state that fails; the others are computed.
  void run(dynAlgorithm algorithm, int64_t n, const BatchArrays& arrays) {
    const dynBatchArrays x = arrays.of(model_, info(algorithm), n);
    check(dyn_batch_run(get(), algorithm, n, &x));
  }
  // Each thread's data.
  void set_effects(std::uint32_t effects, int joint = 0) { check(dyn_batch_set_effects(get(), joint, effects)); }
  // n simulations. Array sizes are not checked (dynRollout). Throws the first failure; the other simulations go on.
  void rollout(int64_t n, const dynRollout& rollout) { check(dyn_batch_rollout(get(), n, &rollout)); }

 private:
  struct Free {
    void operator()(dynBatch* batch) const noexcept { dyn_batch_free(batch); }
  };
  Model model_;
  std::unique_ptr<dynBatch, Free> batch_;
};

// Inertial parameters of one body, and their other forms.
using Parameters = std::array<double, 10>;
inline Matrix body_regressor(const Vector6& velocity, const Vector6& acceleration) {
  Matrix Y(6, 10);
  check(dyn_body_regressor(velocity.data(), acceleration.data(), Y.data()));
  return Y;
}
inline Matrix pseudo_inertia_from_parameters(const Parameters& pi) {
  Matrix J(4, 4);
  check(dyn_pseudo_inertia_from_parameters(pi.data(), J.data()));
  return J;
}
inline Parameters parameters_from_pseudo_inertia(Input J) {
  Parameters pi;
  check(dyn_parameters_from_pseudo_inertia(J.of(16, "J"), pi.data()));
  return pi;
}
inline Parameters log_cholesky_from_parameters(const Parameters& pi) {
  Parameters theta;
  check(dyn_log_cholesky_from_parameters(pi.data(), theta.data()));
  return theta;
}
inline Parameters parameters_from_log_cholesky(const Parameters& theta) {
  Parameters pi;
  check(dyn_parameters_from_log_cholesky(theta.data(), pi.data()));
  return pi;
}
inline Matrix log_cholesky_jacobian(const Parameters& theta) {
  Matrix jacobian(10, 10);
  check(dyn_log_cholesky_jacobian(theta.data(), jacobian.data()));
  return jacobian;
}
inline bool is_physically_consistent(const Parameters& pi) {
  int yes;
  check(dyn_is_physically_consistent(pi.data(), &yes));
  return yes != 0;
}

// Rotations and placements: dyn_so3_... and dyn_se3_... for one element.
enum class Side { right, left };  // of a Jacobian
namespace detail {
template <class Out, class F, class... In>
Out group(F f, const In&... in) {
  Out out;
  check(f(1, in.data()..., out.data()));
  return out;
}
template <class F, class In>
Matrix group_jacobian(F f, int n, const In& in, Side side) {
  Matrix J(n, n);
  check(f(1, in.data(), side == Side::left, J.data()));
  return J;
}
template <class X, class F, class In>
In group_action(F f, const X& x, In in) {
  check(f(x.data(), 1, in.data(), in.data()));
  return in;
}
}  // namespace detail
namespace so3 {
inline Rotation compose(const Rotation& R_AB, const Rotation& R_BC) {
  return detail::group<Rotation>(dyn_so3_compose, R_AB, R_BC);
}
inline Rotation inverse(const Rotation& R) { return detail::group<Rotation>(dyn_so3_inverse, R); }
inline Vector3 act(const Rotation& R_AB, const Vector3& x_B) { return detail::group_action(dyn_so3_act, R_AB, x_B); }
inline Rotation exp(const Vector3& w) { return detail::group<Rotation>(dyn_so3_exp, w); }
inline Vector3 log(const Rotation& R) { return detail::group<Vector3>(dyn_so3_log, R); }
inline Matrix jexp(const Vector3& w, Side side = Side::right) { return detail::group_jacobian(dyn_so3_jexp, 3, w, side); }
inline Matrix jlog(const Rotation& R, Side side = Side::right) { return detail::group_jacobian(dyn_so3_jlog, 3, R, side); }
inline Rotation interpolate(const Rotation& R0, const Rotation& R1, double u) {
  return detail::group<Rotation>(dyn_so3_interpolate, R0, R1, std::array<double, 1>{u});
}
inline Rotation from_quaternion(const Quaternion& q) { return detail::group<Rotation>(dyn_so3_from_quaternion, q); }
inline Quaternion to_quaternion(const Rotation& R) { return detail::group<Quaternion>(dyn_so3_to_quaternion, R); }
inline Rotation from_rpy(const Vector3& rpy) { return detail::group<Rotation>(dyn_so3_from_rpy, rpy); }
inline Vector3 to_rpy(const Rotation& R) { return detail::group<Vector3>(dyn_so3_to_rpy, R); }
}  // namespace so3
namespace se3 {
using Pose = std::array<double, 7>;  // [position; quaternion]
inline Placement compose(const Placement& X_AB, const Placement& X_BC) {
  return detail::group<Placement>(dyn_se3_compose, X_AB, X_BC);
}
inline Placement inverse(const Placement& X) { return detail::group<Placement>(dyn_se3_inverse, X); }
inline Vector3 act(const Placement& X_AB, const Vector3& p_B) { return detail::group_action(dyn_se3_act, X_AB, p_B); }
inline Vector6 act_motion(const Placement& X_AB, const Vector6& m_B) {
  return detail::group_action(dyn_se3_act_motion, X_AB, m_B);
}
inline Vector6 act_force(const Placement& X_AB, const Vector6& f_B) { return detail::group_action(dyn_se3_act_force, X_AB, f_B); }
inline Matrix act_inertia(const Placement& X_AB, Input I_B) {
  Matrix I_A(6, 6);
  check(dyn_se3_act_inertia(X_AB.data(), 1, I_B.of(36, "I_B"), I_A.data()));
  return I_A;
}
inline Matrix adjoint(const Placement& X_AB) {
  Matrix Ad(6, 6);
  check(dyn_se3_adjoint(1, X_AB.data(), Ad.data()));
  return Ad;
}
inline Placement exp(const Vector6& twist) { return detail::group<Placement>(dyn_se3_exp, twist); }
inline Vector6 log(const Placement& X) { return detail::group<Vector6>(dyn_se3_log, X); }
inline Matrix jexp(const Vector6& twist, Side side = Side::right) {
  return detail::group_jacobian(dyn_se3_jexp, 6, twist, side);
}
inline Matrix jlog(const Placement& X, Side side = Side::right) { return detail::group_jacobian(dyn_se3_jlog, 6, X, side); }
inline Placement interpolate(const Placement& X0, const Placement& X1, double u) {
  return detail::group<Placement>(dyn_se3_interpolate, X0, X1, std::array<double, 1>{u});
}
inline Placement from_matrix(Input matrix) {
  Placement X;
  check(dyn_se3_from_matrix(1, matrix.of(16, "matrix"), X.data()));
  return X;
}
inline Matrix to_matrix(const Placement& X) {
  Matrix out(4, 4);
  check(dyn_se3_to_matrix(1, X.data(), out.data()));
  return out;
}
inline Placement from_quaternion(const Pose& q) { return detail::group<Placement>(dyn_se3_from_quaternion, q); }
inline Pose to_quaternion(const Placement& X) { return detail::group<Pose>(dyn_se3_to_quaternion, X); }
inline Placement from_rpy(const Vector6& xyz_rpy) { return detail::group<Placement>(dyn_se3_from_rpy, xyz_rpy); }
inline Vector6 to_rpy(const Placement& X) { return detail::group<Vector6>(dyn_se3_to_rpy, X); }
}  // namespace se3

// A joint for Builder::add_joint.
struct JointSpec {
  std::string name, parent, mimic;                                     // "": the world; none
  dynJointSpec value;                                                  // all else; its names are set from those above
  Vector lower, upper, velocity, effort;                               // empty: infinite
  Vector armature, damping, friction, stiffness, spring_reference;     // empty: zero, or neutral
  std::vector<JointSpec> parts;
  JointSpec(std::string joint, dynJointType type, std::string above = "") : name(std::move(joint)), parent(std::move(above)) {
    dyn_joint_spec_init(&value);
    value.type = type;
  }
  JointSpec& placement(const Placement& X) { return copy(X, value.placement); }
  JointSpec& axis(const Vector3& a) { return copy(a, value.axis); }
  JointSpec& axis2(const Vector3& a) { return copy(a, value.axis2); }
  JointSpec& follow(std::string leader, double ratio = 1, double offset = 0) {
    mimic = std::move(leader), value.mimic_ratio = ratio, value.mimic_offset = offset;
    return *this;
  }

 private:
  template <class A>
  JointSpec& copy(const A& from, double* to) {
    for (double x : from) *to++ = x;
    return *this;
  }
};

// A shape by itself, for geometry_distance.
inline dynGeometry geometry(dynShapeType type, const Vector3& size, double radius = 0, const dynMesh* surface = nullptr) {
  dynGeometry g;
  dyn_geometry_init(&g);
  g.type = type, g.radius = radius, g.surface = surface;
  for (std::size_t k = 0; k < 3; ++k) g.size[k] = size[k];
  return g;
}
inline dynDistance geometry_distance(const dynGeometry& a, const Placement& X_a, const dynGeometry& b, const Placement& X_b,
                                     double tolerance = 0, dynDistanceMethod method = DYN_DISTANCE_METHOD_GJK) {
  dynDistance out{};
  out.struct_size = sizeof out;
  dynDistanceOptions options;
  dyn_distance_options_init(&options);
  options.tolerance = tolerance, options.method = method;
  check(dyn_geometry_distance(&a, X_a.data(), &b, X_b.data(), &options, &out));
  return out;
}

inline std::vector<dynContact> geometry_contacts(const dynGeometry& a, const Placement& X_a, const dynGeometry& b,
                                                 const Placement& X_b, double margin = 0, double tolerance = 0) {
  std::vector<dynContact> out(DYN_MAX_CONTACTS_PER_PAIR);
  int count = 0;
  const dynGeometryPair pair = {sizeof pair, &a, &b, X_a.data(), X_b.data(), nullptr, nullptr};
  check(dyn_geometry_contacts(&pair, margin, tolerance, out.data(), &count));
  out.resize(static_cast<std::size_t>(count));
  return out;
}
inline dynRayHit geometry_ray(const dynGeometry& shape, const Placement& X, const Vector3& origin, const Vector3& direction) {
  dynRayHit out{};
  out.struct_size = sizeof out;
  check(dyn_geometry_ray(&shape, X.data(), origin.data(), direction.data(), &out));
  return out;
}
inline dynClosestPoint geometry_closest_point(const dynGeometry& shape, const Placement& X, const Vector3& point) {
  dynClosestPoint out{};
  out.struct_size = sizeof out;
  check(dyn_geometry_closest_point(&shape, X.data(), point.data(), &out));
  return out;
}
inline dynImpact geometry_sweep(const dynGeometry& a, const Placement& X_a, const std::array<double, 6>& motion_a,
                                const dynGeometry& b, const Placement& X_b, const std::array<double, 6>& motion_b,
                                double duration, double margin = 0) {
  dynImpact out{};
  out.struct_size = sizeof out;
  const dynGeometryPair pair = {sizeof pair, &a, &b, X_a.data(), X_b.data(), motion_a.data(), motion_b.data()};
  check(dyn_geometry_sweep(&pair, duration, margin, &out));
  return out;
}

// The contact problem on a given Delassus matrix: room for so many rows.
class ContactSolver {
 public:
  explicit ContactSolver(int max_rows) {
    dynContactSolver* made = nullptr;
    check(dyn_contact_solver_new(max_rows, &made));
    solver_.reset(made);
  }
  dynContactSolver* get() const noexcept { return solver_.get(); }
  // lambda: in with options->warm_start, out; velocity may be null.
  dynContactReport solve(const dynContactProblem& problem, double* lambda, double* velocity = nullptr,
                         const dynContactOptions* options = nullptr) {
    dynContactReport report{};
    report.struct_size = sizeof report;
    check(dyn_contact_solver_solve(get(), &problem, options, lambda, velocity, &report));
    return report;
  }
  dynContactReport residuals(const dynContactProblem& problem, const double* lambda) {
    dynContactReport report{};
    report.struct_size = sizeof report;
    check(dyn_contact_solver_residuals(get(), &problem, lambda, &report));
    return report;
  }

 private:
  struct Free {
    void operator()(dynContactSolver* s) const noexcept { dyn_contact_solver_free(s); }
  };
  std::unique_ptr<dynContactSolver, Free> solver_;
};
inline dynContactProblem contact_problem() {
  dynContactProblem problem;
  dyn_contact_problem_init(&problem);
  return problem;
}
inline dynContactOptions contact_options() {
  dynContactOptions options;
  dyn_contact_options_init(&options);
  return options;
}
inline dynPlanCost plan_cost(dynPlanCostType type) {
  dynPlanCost cost;
  dyn_plan_cost_init(&cost);
  cost.type = type;
  return cost;
}
inline dynPlanProblem plan_problem() {
  dynPlanProblem problem;
  dyn_plan_problem_init(&problem);
  return problem;
}
inline dynPlanOptions plan_options() {
  dynPlanOptions options;
  dyn_plan_options_init(&options);
  return options;
}
// Inputs of N steps that minimise costs within bounds.
class Planner {
 public:
  struct Plan {
    Matrix q, v, u;         // a column for each knot; u: one less
    std::vector<Matrix> K;  // of each knot: inputs x 2 nv
    Matrix gaps;            // 2 nv x N
    dynPlanReport report;
  };
  Planner(Model model, int knots, dynPlanInput input) : model_(std::move(model)), knots_(knots) {
    dynPlanner* made = nullptr;
    check(dyn_planner_new(model_.get(), knots, input, &made));
    planner_.reset(made);
    inputs_ = input == DYN_PLAN_INPUT_TAU ? model_.nv() : dyn_model_nu(model_.get());
  }
  dynPlanner* get() const noexcept { return planner_.get(); }
  // q, v: N + 1 columns, or held: the motion by u, of N columns, or held: zero.
  void set_guess(Input q, Input v, Input u) {
    check(dyn_planner_set_guess(get(), model_.get(), q.of((knots_ + 1) * model_.nq(), "q"), v.of((knots_ + 1) * model_.nv(), "v"),
                                u.of(knots_ * inputs_, "u")));
  }
  void shift(int knots = 1) { check(dyn_planner_shift(get(), knots)); }
  // The problem's arrays are not checked for their sizes (dynPlanProblem, dynPlanCost).
  Plan solve(Data& data, const dynPlanProblem& problem, const dynPlanOptions& options = plan_options()) {
    const int N = knots_, n = 2 * model_.nv();
    Plan x{Matrix(model_.nq(), N + 1), Matrix(model_.nv(), N + 1), Matrix(inputs_, N), {}, Matrix(n, N), {}};
    std::vector<double> K(static_cast<std::size_t>(N) * static_cast<std::size_t>(inputs_ * n));
    dynPlanOutput out;
    dyn_plan_output_init(&out);
    x.report.struct_size = sizeof x.report;
    out.q = x.q.data(), out.v = x.v.data(), out.u = x.u.data(), out.gaps = x.gaps.data(), out.report = &x.report;
    out.K = K.data();
    check(dyn_planner_solve(get(), model_.get(), data.get(), &problem, &options, &out));
    const double* next = K.data();
    for (int k = 0; k < N; ++k, next += inputs_ * n)
      x.K.emplace_back(inputs_, n), x.K.back().values.assign(next, next + inputs_ * n);
    return x;
  }

 private:
  struct Free {
    void operator()(dynPlanner* planner) const noexcept { dyn_planner_free(planner); }
  };
  Model model_;
  int knots_, inputs_ = 0;
  std::unique_ptr<dynPlanner, Free> planner_;
};
// (compliance, bias) of a spring and damper.
inline std::array<double, 2> contact_compliance(double stiffness, double damping, double dt, double gap = 0) {
  std::array<double, 2> out{};
  check(dyn_contact_compliance(stiffness, damping, dt, gap, &out[0], &out[1]));
  return out;
}
// (stiffness, damping) of a frequency and a damping ratio at a mass.
inline std::array<double, 2> contact_stiffness_hertz(double frequency, double damping_ratio, double mass) {
  std::array<double, 2> out{};
  check(dyn_contact_stiffness_hertz(frequency, damping_ratio, mass, &out[0], &out[1]));
  return out;
}
// A quadratic program that owns its arrays.
struct Qp {
  dynQp sizes{};
  std::vector<int32_t> H_columns, H_rows, A_columns, A_rows;
  std::vector<double> H, g, A, lower, upper;
};
inline Qp contact_problem_qp(const dynContactProblem& problem, int facets = 8, bool inscribed = true) {
  Qp q;
  dyn_qp_init(&q.sizes);
  check(dyn_contact_problem_qp(&problem, facets, inscribed, &q.sizes));
  const auto n = static_cast<std::size_t>(q.sizes.n), m = static_cast<std::size_t>(q.sizes.m);
  q.H_columns.resize(n + 1), q.A_columns.resize(n + 1), q.g.resize(n), q.lower.resize(m), q.upper.resize(m);
  q.H_rows.resize(static_cast<std::size_t>(q.sizes.H_nonzeros)), q.H.resize(q.H_rows.size());
  q.A_rows.resize(static_cast<std::size_t>(q.sizes.A_nonzeros)), q.A.resize(q.A_rows.size());
  dynQp fill = q.sizes;
  fill.H_columns = q.H_columns.data(), fill.H_rows = q.H_rows.data(), fill.A_columns = q.A_columns.data(),
  fill.A_rows = q.A_rows.data();
  fill.H = q.H.data(), fill.g = q.g.data(), fill.A = q.A.data(), fill.lower = q.lower.data(), fill.upper = q.upper.data();
  check(dyn_contact_problem_qp(&problem, facets, inscribed, &fill));
  return q;
}

// Which of many boxes overlap.
class BroadPhase {
 public:
  BroadPhase(int capacity, int64_t pair_capacity, double margin = 0) : capacity_(capacity) {
    dynBroadPhase* made = nullptr;
    check(dyn_broad_phase_new(capacity, pair_capacity, margin, &made));
    broad_phase_.reset(made);
  }
  dynBroadPhase* get() const noexcept { return broad_phase_.get(); }
  int insert(const Vector3& lower, const Vector3& upper) {
    int id = 0;
    check(dyn_broad_phase_insert(get(), lower.data(), upper.data(), &id));
    return id;
  }
  void update(int id, const Vector3& lower, const Vector3& upper) {
    check(dyn_broad_phase_update(get(), id, lower.data(), upper.data()));
  }
  void remove(int id) { check(dyn_broad_phase_remove(get(), id)); }
  std::vector<std::array<int, 2>> pairs() {
    int64_t count = 0;
    check(dyn_broad_phase_pairs(get(), nullptr, 0, &count));
    std::vector<std::array<int, 2>> out(static_cast<std::size_t>(count));
    if (count > 0) check(dyn_broad_phase_pairs(get(), out.front().data(), count, &count));
    return out;
  }
  std::vector<int> query(const Vector3& lower, const Vector3& upper) {
    return ids_(
        [&](int* out, int* count) { return dyn_broad_phase_query(get(), lower.data(), upper.data(), out, capacity_, count); });
  }
  std::vector<int> ray(const Vector3& origin, const Vector3& direction, double max_t = std::numeric_limits<double>::infinity()) {
    return ids_([&](int* out, int* count) {
      return dyn_broad_phase_ray(get(), origin.data(), direction.data(), max_t, out, capacity_, count);
    });
  }

 private:
  struct Free {
    void operator()(dynBroadPhase* b) const noexcept { dyn_broad_phase_free(b); }
  };
  int capacity_;
  std::unique_ptr<dynBroadPhase, Free> broad_phase_;

  template <class F>
  std::vector<int> ids_(F call) {
    std::vector<int> out(static_cast<std::size_t>(capacity_));
    int count = 0;
    check(call(out.data(), &count));
    out.resize(static_cast<std::size_t>(count));
    return out;
  }
};

// Makes models.
class Builder {
 public:
  explicit Builder(const std::string& name) {
    dynBuilder* builder = nullptr;
    check(dyn_builder_new(name.c_str(), &builder));
    builder_.reset(builder);
  }
  // With all that the model was made from.
  explicit Builder(const Model& model) {
    dynBuilder* builder = nullptr;
    check(dyn_builder_from_model(model.get(), &builder));
    builder_.reset(builder);
  }
  dynBuilder* get() const noexcept { return builder_.get(); }
  Builder& set_gravity(const Vector3& g) { return ok(dyn_builder_set_gravity(get(), g.data())); }
  // Numbers of limits, armature, ... are nq or nv of the joint.
  Builder& add_joint(const JointSpec& spec) {
    return with(spec, [&](const dynJointSpec& s) { return dyn_builder_add_joint(get(), &s); });
  }
  Builder& add_joint(const std::string& name, dynJointType type, const std::string& parent = "") {
    return add_joint(JointSpec(name, type, parent));
  }
  // Inertia about the centre of mass, both in the link's frame; placement: none is the identity.
  Builder& add_body(const std::string& name, const std::string& parent, double mass, const Vector3& com,
                const std::array<double, 9>& inertia, Input placement = none) {
    return ok(dyn_builder_add_body(get(), name.c_str(), above(parent), placement.of(12, "placement"), mass, com.data(),
                                   inertia.data()));
  }
  Builder& add_frame(const std::string& name, const std::string& parent, Input placement = none,
                 dynFrameType type = DYN_FRAME_TYPE_OP_FRAME) {
    return ok(dyn_builder_add_frame(get(), name.c_str(), above(parent), placement.of(12, "placement"), type));
  }
  Builder& add_shape(const std::string& body, dynShapeType type, const Vector3& size, Input placement = none,
                     dynShapeRole role = DYN_SHAPE_ROLE_COLLISION, const std::string& name = "", const std::string& mesh = "",
                     double radius = 0, uint32_t contype = 1, uint32_t conaffinity = 1, const dynMesh* surface = nullptr) {
    dynShapeSpec s;
    dyn_shape_spec_init(&s);
    s.radius = radius, s.contype = contype, s.conaffinity = conaffinity, s.surface = surface;
    s.name = name.c_str(), s.type = type, s.role = role, s.body = body.c_str(), s.mesh = mesh.c_str();
    for (std::size_t k = 0; k < 3; ++k) s.size[k] = size[k];
    if (const double* X = placement.of(12, "placement"))
      for (int k = 0; k < 12; ++k) s.placement[k] = X[k];
    return ok(dyn_builder_add_shape(get(), &s));
  }
  // How the shape that was added last looks: red, green, blue, opacity, 0 to 1.
  Builder& set_shape_fluid(Input coefficients = none, Input semiaxes = none, Input placement = none) {
    return ok(dyn_builder_set_shape_fluid(get(), coefficients.of(5, "coefficients"), semiaxes.of(3, "semiaxes"),
                                          placement.of(12, "placement")));
  }
  Builder& set_shape_rgba(const std::array<double, 4>& rgba) { return ok(dyn_builder_set_shape_rgba(get(), rgba.data())); }
  // Two collision shapes that are tested whatever the filter says; material: nullptr, that of the shapes.
  Builder& add_pair(const std::string& shape1, const std::string& shape2, const dynMaterial* material = nullptr) {
    return ok(dyn_builder_add_pair(get(), shape1.c_str(), shape2.c_str(), material));
  }
  // target: a joint, a tendon or a frame; reference: with the transmission SITE, the frame that takes the opposite wrench
  Builder& add_actuator(const std::string& name, const dynActuator& a, const std::string& target,
                        const std::string& reference = "") {
    return ok(reference.empty()
                  ? dyn_builder_add_actuator(get(), name.c_str(), &a, target.c_str())
                  : dyn_builder_add_actuator_between(get(), name.c_str(), &a, target.c_str(), reference.c_str()));
  }
  // the sum of the actuators on a joint, and of what gravity compensation gives it
  Builder& limit_actuators(const std::string& joint, double lower, double upper, bool with_weight = false) {
    return ok(dyn_builder_limit_actuators(get(), joint.c_str(), lower, upper, with_weight));
  }
  Builder& limit_tendon_actuators(const std::string& tendon, double lower, double upper) {
    return ok(dyn_builder_limit_tendon_actuators(get(), tendon.c_str(), lower, upper));
  }
  Builder& add_tendon(const std::string& name, const dynTendon& tendon, const std::vector<dynTendonElement>& elements) {
    return ok(dyn_builder_add_tendon(get(), name.c_str(), &tendon, elements.data(), static_cast<int>(elements.size())));
  }
  // object "": the quantity has none
  Builder& add_sensor(const std::string& name, const dynSensor& sensor, const std::string& object,
                      const std::string& reference = "") {
    return ok(dyn_builder_add_sensor(get(), name.c_str(), &sensor, above(object), above(reference)));
  }
  // tendon2 "": L1 - L1_0 is coefficients[0]
  Builder& couple_tendons(const std::string& name, const std::string& tendon1, const std::string& tendon2,
                          const std::array<double, 5>& coefficients) {
    return ok(dyn_builder_couple_tendons(get(), name.c_str(), tendon1.c_str(), above(tendon2), coefficients.data()));
  }
  Builder& set_gravity_compensation(const std::string& body, double share = 1) {
    return ok(dyn_builder_set_gravity_compensation(get(), body.c_str(), share));
  }
  Builder& set_mocap(const std::string& body) { return ok(dyn_builder_set_mocap(get(), body.c_str())); }
  Builder& set_medium(double density, double viscosity, Input wind = none) {
    return ok(dyn_builder_set_medium(get(), density, viscosity, wind.of(3, "wind")));
  }
  Builder& add_configuration(const std::string& name, const Vector& q) {
    return ok(dyn_builder_add_configuration(get(), name.c_str(), q.data(), q.size()));
  }
  // Joints, and their followers, fixed at q.
  Builder& lock(const std::vector<std::string>& joints, const Vector& q) {
    std::vector<const char*> names;
    for (const auto& n : joints) names.push_back(n.c_str());
    return ok(dyn_builder_lock(get(), names.data(), names.size(), q.data(), q.size()));
  }
  // The model's world is what the joint carries, or the builder's.
  Builder& attach(const Model& model, const std::string& prefix, const JointSpec& spec) {
    return with(spec, [&](const dynJointSpec& s) { return dyn_builder_attach(get(), model.get(), prefix.c_str(), &s); });
  }
  Builder& attach(const Model& model, const std::string& prefix) {
    return ok(dyn_builder_attach(get(), model.get(), prefix.c_str(), nullptr));
  }
  // first, second: names of frames or joints; second "": the universe.
  Builder& add_constraint(const std::string& name, const dynConstraint& c, const std::string& first,
                          const std::string& second = "") {
    return ok(dyn_builder_add_constraint(get(), name.c_str(), &c, first.c_str(), above(second)));
  }
  Builder& set_constraint_slots(int slots) { return ok(dyn_builder_set_constraint_slots(get(), slots)); }
  Builder& set_contact_capacity(int contacts) { return ok(dyn_builder_set_contact_capacity(get(), contacts)); }
  Builder& keep_subtree(const std::string& joint) { return ok(dyn_builder_keep_subtree(get(), joint.c_str())); }
  Builder& remove_subtree(const std::string& joint) { return ok(dyn_builder_remove_subtree(get(), joint.c_str())); }
  // Numbers of what was added, one quantity of an object each. Texts and numbers live until the builder changes.
  std::vector<dynParameter> parameters() {
    std::vector<dynParameter> out(static_cast<std::size_t>(std::max(0, dyn_builder_parameter_count(get()))));
    for (std::size_t k = 0; k < out.size(); ++k) {
      out[k].struct_size = sizeof out[k];
      check(dyn_builder_parameter(get(), static_cast<int>(k), &out[k]));
    }
    return out;
  }
  // index: in parameters()
  Builder& set_parameter(int index, const Vector& values) {
    return ok(dyn_builder_set_parameter(get(), index, values.data(), values.size()));
  }
  Model finish() {
    dynModel* model = nullptr;
    check(dyn_builder_finish(get(), &model));
    return Model(model);
  }

 private:
  // f of the C structure of a joint.
  template <class F>
  Builder& with(const JointSpec& spec, F&& f) {
    const auto [nq, nv] = sizes(spec);
    dynJointSpec s = spec.value;
    s.name = spec.name.c_str();
    s.parent = spec.parent.empty() ? nullptr : spec.parent.c_str();
    s.mimic = spec.mimic.empty() ? nullptr : spec.mimic.c_str();
    s.lower = optional(spec.lower, nq, "lower"), s.upper = optional(spec.upper, nq, "upper");
    s.velocity = optional(spec.velocity, nv, "velocity"), s.effort = optional(spec.effort, nv, "effort");
    s.armature = optional(spec.armature, nv, "armature"), s.damping = optional(spec.damping, nv, "damping");
    s.friction = optional(spec.friction, nv, "friction"), s.stiffness = optional(spec.stiffness, nv, "stiffness");
    s.spring_reference = optional(spec.spring_reference, nq, "spring_reference");
    std::vector<dynJointSpec> parts;
    for (const auto& part : spec.parts) parts.push_back(part.value);
    if (!parts.empty()) s.parts = parts.data(), s.parts_count = parts.size();
    return ok(f(s));
  }
  struct Free {
    void operator()(dynBuilder* builder) const noexcept { dyn_builder_free(builder); }
  };
  std::unique_ptr<dynBuilder, Free> builder_;

  Builder& ok(dynStatus status) { return check(status), *this; }
  static const char* above(const std::string& parent) { return parent.empty() ? nullptr : parent.c_str(); }
  static const double* optional(const Vector& v, int n, const char* name) { return v.empty() ? nullptr : Input(v).of(n, name); }
  static std::pair<int, int> sizes(const JointSpec& spec) {  // nq, nv
    std::pair<int, int> sum{0, 0};
    for (const auto& part : spec.parts) sum.first += sizes(part).first, sum.second += sizes(part).second;
    dynJointTypeInfo info{};
    info.struct_size = sizeof info;
    check(dyn_joint_type_info(spec.value.type, &info));
    return {sum.first + info.nq, sum.second + info.nv};
  }
};

// Triangles in metres; copies share them.
class Mesh {
 public:
  // Takes over a mesh made by dyn.h.
  explicit Mesh(dynMesh* mesh) : mesh_(mesh, dyn_mesh_free) {
    if (!mesh) throw Error(DYN_ERROR_HANDLE, "the mesh is NULL.");
  }
  struct Options {
    dynMeshOptions value;
    std::vector<std::string> folders;
    std::string robot;
    Options() { dyn_mesh_options_init(&value); }
    Options& scale(double x, double y, double z) { return value.scale[0] = x, value.scale[1] = y, value.scale[2] = z, *this; }
    Options& weld_tolerance(double metres) { return value.weld_tolerance = metres, *this; }
    Options& up_z(bool on = true) { return value.up_z = on, *this; }
    Options& package_dir(std::string folder) { return folders.push_back(std::move(folder)), *this; }
    Options& relative_to(std::string file) { return robot = std::move(file), *this; }
  };
  static Mesh load(const std::string& path) { return load(path, Options()); }
  static Mesh load(const std::string& path, const Options& options) {
    std::vector<const char*> folders;
    for (const auto& f : options.folders) folders.push_back(f.c_str());
    dynMeshOptions o = options.value;
    if (!folders.empty()) o.package_dirs = folders.data(), o.package_dirs_count = folders.size();
    if (!options.robot.empty()) o.relative_to = options.robot.c_str();
    return make_([&](dynMesh** out) { return dyn_mesh_load(path.c_str(), &o, out); });
  }
  // Three numbers a vertex, three indices a triangle; without triangles: points for hull().
  static Mesh from_arrays(Input vertices, int64_t count, const std::vector<int32_t>& triangles = {}) {
    const double* x = vertices.of(3 * count, "vertices");
    if (triangles.size() % 3)
      throw Error(DYN_ERROR_SIZE,
                  "triangles has " + std::to_string(triangles.size()) + " indices, but needs three for each triangle.");
    return make_([&](dynMesh** out) {
      return dyn_mesh_from_arrays(x, static_cast<std::size_t>(count), triangles.empty() ? nullptr : triangles.data(),
                                  triangles.size() / 3, out);
    });
  }
  // Heights of columns x rows points, row after row.
  static Mesh height_field(Input heights, int columns, int rows, double step_x, double step_y, double bottom) {
    const dynHeightField field = {sizeof field, columns, rows,  heights.of(std::int64_t(columns) * rows, "heights"),
                                  step_x,       step_y,  bottom};
    return make_([&](dynMesh** out) { return dyn_mesh_from_height_field(&field, out); });
  }
  // The surface of a shape of a model.
  static Mesh of_shape(const Model& model, int shape) {
    return make_([&](dynMesh** out) { return dyn_model_shape_mesh(model.get(), shape, out); });
  }
  const dynMesh* get() const noexcept { return mesh_.get(); }
  dynMeshInfo info() const { return get_<dynMeshInfo>(dyn_mesh_info); }
  dynMeshArrays arrays() const { return get_<dynMeshArrays>(dyn_mesh_arrays); }
  // Red, green, blue of each triangle, 0 to 1; -1 where the file says nothing.
  std::vector<double> colours() const {
    std::vector<double> rgb(3 * arrays().triangle_count);
    check(dyn_mesh_rgb(get(), rgb.data()));
    return rgb;
  }
  Mesh hull() const {
    return make_([&](dynMesh** out) { return dyn_mesh_hull(get(), out); });
  }

 private:
  std::shared_ptr<dynMesh> mesh_;

  template <class F>
  static Mesh make_(F call) {
    dynMesh* mesh = nullptr;
    check(call(&mesh));
    return Mesh(mesh);
  }
  template <class S>
  S get_(dynStatus (*call)(const dynMesh*, S*)) const {
    S out{};
    out.struct_size = sizeof out;
    check(call(get(), &out));
    return out;
  }
};

}  // namespace dyn_api

namespace dyn {
using namespace dyn_api;
}

#endif
