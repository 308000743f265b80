// The rows of dyn_bench: libdyn's algorithms on one model, each a call with one of 64 random states. Results stay in the data.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "dyn.h"

namespace bench {

constexpr int states = 64;
constexpr int dense = 2000;   // beyond so many degrees of freedom nothing of size nv x nv
constexpr int tensors = 150;  // beyond so many nothing of size nv^3

void require(dynStatus s);  // or exit with the message

struct Row {
  std::string name;
  std::function<void(int)> call;                 // with state k
  std::function<void()> prepare = nullptr;       // before a round: what the call needs
  std::vector<double> rounds = {};               // median of each, ns
  double best = 1e300;
};

class Robot {
 public:
  // Frames' rows are about that of joint, the last one's when joint is empty.
  Robot(const dynModel* model, const std::string& joint);
  ~Robot() { dyn_data_free(d); }
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  const int nq, nv;
  std::vector<Row> rows;

  // state k: q, v, a, tau
  const double* Q(int k) const { return q.data() + std::ptrdiff_t(k % states) * nq; }
  const double* V(int k) const { return v.data() + std::ptrdiff_t(k) * nv; }
  const double* A(int k) const { return a.data() + std::ptrdiff_t(k) * nv; }
  const double* U(int k) const { return tau.data() + std::ptrdiff_t(k) * nv; }

 private:
  void add_kinematics();
  void add_dynamics();
  void add_derivatives();
  void add_constraints();
  void add_centroidal();
  void add_regressors();
  void add_configurations();
  void add(const char* name, std::function<void(int)> call, std::function<void()> prepare = nullptr) {
    rows.push_back({name, std::move(call), std::move(prepare)});
  }

  const dynModel* m;
  dynData* d = nullptr;
  int frame = 0, joint = 0;
  std::vector<double> q, v, a, tau;
  std::vector<double> x;  // results that have no place in the data
};

}  // namespace bench
