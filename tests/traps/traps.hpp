// Common mistakes with rigid-body libraries, one test each. Each test shows that the mistake is impossible here, or is an error
// with a message.
#pragma once

#include "capi/calls.hpp"

namespace dyn_test {

inline double distance(const Numbers& a, const Numbers& b) {
  EXPECT_EQ(a.size(), b.size());
  double worst = 0;
  for (std::size_t k = 0; k < a.size() && k < b.size(); ++k) worst = std::max(worst, std::abs(a[k] - b[k]));
  return worst;
}
inline double largest(const Numbers& a) { return distance(a, Numbers(a.size(), 0.0)); }
inline void expect_near(const Numbers& a, const Numbers& b, double tolerance, const std::string& what) {
  EXPECT_LE(distance(a, b), tolerance * (1 + largest(a))) << what;
}
inline Numbers placement(const dynModel* m, dynData* d, int frame) {
  Numbers x(12);
  EXPECT_EQ(DYN_OK, dyn_frame_placement(m, d, frame, x.data())) << dyn_last_error();
  return x;
}
inline Numbers frame6(dynStatus (*call)(const dynModel*, dynData*, int, dynReference, double*), const dynModel* m, dynData* d,
                      int frame, dynReference r) {
  Numbers x(6);
  EXPECT_EQ(DYN_OK, call(m, d, frame, r, x.data())) << dyn_last_error();
  return x;
}
inline Numbers cross(const double* a, const double* b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline dynJointInfo joint_info(const dynModel* m, int joint) {
  dynJointInfo info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(DYN_OK, dyn_model_joint_info(m, joint, &info));
  return info;
}
inline dynFrameInfo frame_info(const dynModel* m, int frame) {
  dynFrameInfo info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(DYN_OK, dyn_model_frame_info(m, frame, &info)) << dyn_last_error();
  return info;
}
inline std::vector<Model> models() {
  std::vector<Model> all;
  all.push_back(all_types()), all.push_back(all_types(false)), all.push_back(robot("panda"));
  all.push_back(robot("go2", DYN_BASE_FLOATING)), all.push_back(robot("gripper"));
  return all;
}

}  // namespace dyn_test
