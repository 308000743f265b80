// Parts of models from MJCF texts, by name.
#pragma once

#include "save/same.hpp"

namespace dyn_test::mjcf {

inline ModelPtr model(const std::string& inside) { return load_string("<mujoco>" + inside + "</mujoco>", {}); }

// The message of the error that a text gives.
inline std::string refusal(const std::string& inside) {
  try {
    model(inside);
  } catch (const Error& e) {
    return e.what();
  }
  return "it is loaded";
}

inline Index frame_id(const Model& m, const std::string& name) {
  for (Index k = 0; k < m.n.frames; ++k)
    if (m.string(m.frames()[k].name) == name && m.frames()[k].type != DYN_FRAME_TYPE_JOINT) return k;
  ADD_FAILURE() << "no frame " << name;
  return 0;
}
inline const JointRecord& joint(const Model& m, const std::string& name) {
  for (Index k = 0; k < m.n.joints; ++k)
    if (m.string(m.joints()[k].name) == name) return m.joints()[k];
  ADD_FAILURE() << "no joint " << name;
  return m.joints()[0];
}
inline const LinkRecord& link(const Model& m, const std::string& name) { return m.links()[m.frames()[frame_id(m, name)].link]; }
inline const ShapeRecord& shape(const Model& m, const std::string& name) {
  for (Index k = 0; k < m.n.shapes; ++k)
    if (m.string(m.shapes()[k].name) == name) return m.shapes()[k];
  ADD_FAILURE() << "no shape " << name;
  return m.shapes()[0];
}

// Placements of all frames at a configuration.
inline std::vector<M4> frames_at(const Model& m, const VectorXd& q) { return Results(m, q, VectorXd::Zero(m.n.nv)).frames; }

template <class X>
void expect_numbers(std::initializer_list<double> expected, const X* x, double tolerance = 1e-14) {
  std::size_t k = 0;
  for (const double e : expected) {
    if (std::isinf(e)) EXPECT_EQ(e, x[k]) << "number " << k;
    else EXPECT_NEAR(e, x[k], tolerance * std::max(1.0, std::abs(e))) << "number " << k;
    ++k;
  }
}

}  // namespace dyn_test::mjcf
