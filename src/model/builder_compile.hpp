// A model on its way from a builder into one block: its arrays, and the stages that fill them (builder_finish.cpp gives their
// order).
#pragma once

#include <unordered_map>

#include "builder_impl.hpp"

namespace dyn {

// All strings of the model, at its end, each once: a joint and its frame share their name.
struct Text {
  std::string pool = std::string(1, '\0');
  std::unordered_map<std::string, Index> known = {{"", 0}};
  Index add(const std::string& s) {
    const auto [at, added] = known.try_emplace(s, Index(pool.size()));
    if (added) pool.append(s.c_str(), s.size() + 1);
    return at->second;
  }
};
// The model's arrays.
struct Arrays {
#define FIELD(type, name, count, sentence) std::vector<type> name;
#include "model/model_fields.def"
#undef FIELD
};

struct Compiler {
  const Builder::Impl& in;
  const Findings& known;
  std::vector<int> order;       // joints of the model as added
  std::vector<Leader> leaders;
  std::vector<Index> id;        // of each added joint in the model
  std::vector<Index> idx_q, idx_v;  // of each added joint
  Arrays a = {};
  Text text = {};
  ModelSizes n = {};
  WantedPairs wanted = {};
  std::unordered_map<std::string, std::size_t> materials = {};  // by their bytes and those of a pair's compliance
  std::vector<Compliance> material_compliances = {};
  Index name = 0;               // of the model, in text
  bool mimic = false;
  bool has_medium() const { return in.density > 0 || in.viscosity > 0; }
  ModelPtr model = {};

  Compiler(const Builder::Impl& impl, const Findings& findings);

  // builder_joints.cpp
  void add_universe();
  void assign_coordinates();    // followers of a mimic have their leader's
  void size_coordinate_arrays();
  void add_joints();
  void add_joint(int joint);
  void add_bodies(const JointEntry& e, const Leader& l, JointRecord& r);  // the chain of primitives of a joint
  void add_parts(const JointEntry& e, JointRecord& r);
  void add_coefficients(const JointSpec& s, const Leader& l, JointRecord& r);
  // builder_links.cpp
  void place_on_mocap(const FrameEntry& f, FrameRecord& r);
  void add_frames();            // and the inertia of links
  std::uint16_t number_of(const dynMaterial& x, const Compliance* own = nullptr);
  void add_wanted_pairs();      // before shapes: their materials come first
  void add_shapes();
  void add_ellipsoids();        // after shapes
  void add_pairs();
  void add_reports();
  void add_constraints();
  void add_configurations();
  void add_configuration_states();  // after the actuators
  // builder_indices.cpp
  void add_runs();
  void add_limits();
  void add_compliances();  // builder_compliance.cpp: after all that they are of
  // builder_tendon.cpp: after the actuators
  void add_paths();
  void add_sensors();  // builder_sensor.cpp
  void add_subtrees();
  void sort_names();
  void close_text();
  // builder_block.cpp
  void allocate();
  void fill_header();
  void copy_arrays();
  void settle_configurations();
  void fill_elimination_tree();
  void fill_path_dofs();
  template <class T>
  T* array(Model::Field field) {
    return reinterpret_cast<T*>(reinterpret_cast<char*>(model.get()) + 8 * std::size_t(model->offset[std::size_t(field)]));
  }

  ModelPtr compile();
  std::vector<std::string> massless = {};
};

inline SE3<double> rotation_only(const Mat3<double>& R) { return {R, Vec3<double>::zero()}; }

}  // namespace dyn
