// Every function of dyn.h that works on a model and a data, as one table: those described, and algorithms from
// dyn_algorithm_info.
#pragma once

#include <set>

#include "capi/described_calls.hpp"
#include "common/every.hpp"

namespace dyn_test {

inline CallRow algorithm_row(dynAlgorithm algorithm) {
  const auto info_of = [=](const dynModel* m) {
    dynAlgorithmInfo info{};
    info.struct_size = sizeof info;
    EXPECT_EQ(DYN_OK, dyn_algorithm_info(m, algorithm, &info)) << dyn_last_error();
    return info;
  };
  const dynAlgorithmInfo info = info_of(nullptr);
  static std::set<std::string> names;
  const std::string inputs = " " + std::string(info.inputs) + " ";
  unsigned uses = 0;
  for (const auto& [name, bit] : {std::pair{"q", uses_q},
                                  {"v", uses_v},
                                  {"a", uses_a},
                                  {"tau", uses_tau},
                                  {"fext", uses_fext},
                                  {"b", uses_b},
                                  {"frame", uses_frame},
                                  {"joint", uses_joint},
                                  {"reference", uses_reference}})
    if (inputs.find(" " + std::string(name) + " ") != std::string::npos) uses |= bit;
  const auto size = [=](const dynModel* m, int k) {
    const dynAlgorithmInfo x = info_of(m);
    return std::size_t(x.rows[k]) * std::size_t(x.cols[k]) * std::size_t(x.pages[k]);
  };
  const auto call = [=](const dynModel* m, dynData* d, const Arguments& x) {
    dynBatchArrays arrays;
    dyn_batch_arrays_init(&arrays);
    arrays.q = x.q, arrays.v = x.v, arrays.a = x.a, arrays.tau = x.tau, arrays.fext = x.fext, arrays.b = x.b;
    arrays.frame = x.frame, arrays.joint = x.joint, arrays.reference = x.reference;
    std::copy_n(x.out, 4, arrays.out);
    return dyn_algorithm_run(m, d, algorithm, &arrays);
  };
  return {names.insert("dyn_" + std::string(info.name)).first->c_str(),
          info.part,
          uses,
          Needs::nothing,
          false,
          info.outputs,
          size,
          call};
}

inline const std::vector<CallRow> call_rows = [] {
  std::vector<CallRow> rows(std::begin(described_calls), std::end(described_calls));
  const auto described = [&](const std::string& name) {
    return std::any_of(rows.begin(), rows.end(), [&](const CallRow& r) { return name == r.name; });
  };
  for (const dynAlgorithm algorithm : every<dynAlgorithm>("dynAlgorithm")) {
    const CallRow row = algorithm_row(algorithm);
    if (algorithm != DYN_ALGORITHM_INTEGRATE && algorithm != DYN_ALGORITHM_DIFFERENCE && !described(row.name))
      rows.push_back(row);
  }
  return rows;
}();

// Distances of pairs that are not tested, rays that hit nothing.
inline bool may_be_infinite(const CallRow& row) {
  const std::string name = row.name;
  return name == "dyn_distances" || name == "dyn_smooth_distances" || name == "dyn_rays";
}

// A call with its arguments, its outputs in buffers with a guard behind each.
struct Prepared {
  static constexpr double pattern = -7.25e77;
  static constexpr std::size_t guard = 4;
  const CallRow& row;
  State s;
  Numbers b, out[4];
  std::uint32_t filled = 0xa5a5a5a5u;
  dynArray array = view();
  Arguments x;

  Prepared(const CallRow& r, const dynModel* m, const State& state) : row(r), s(state), b(state.a) {
    x.q = s.q.data(), x.v = s.v.data(), x.a = s.a.data(), x.tau = s.tau.data(), x.fext = s.fext.data(), x.b = x.lambda = b.data();
    x.frame = dyn_model_nframes(m) - 1, x.joint = dyn_model_njoints(m) - 1;
    for (int k = 0; k < row.outputs; ++k) {
      out[k].assign(row.size(m, k) + guard, pattern);
      x.out[k] = out[k].data();
    }
    x.filled = &filled, x.array = &array;
  }
  Prepared(const Prepared&) = delete;
  dynStatus operator()(const dynModel* m, dynData* d) const { return row.call(m, d, x); }
  std::vector<Numbers> results() const {
    std::vector<Numbers> all;
    for (int k = 0; k < row.outputs; ++k) all.emplace_back(out[k].begin(), out[k].end() - guard);
    return all;
  }
  void refill() {
    for (Numbers& o : out) std::fill(o.begin(), o.end(), pattern);
    filled = 0xa5a5a5a5u;
    array = view();
  }
  bool untouched() const {
    for (const Numbers& o : out)
      for (double e : o)
        if (e != pattern) return false;
    const dynArray fresh = view();
    return filled == 0xa5a5a5a5u && array.data == fresh.data && array.rows == 0 && array.cols == 0 && array.stride[0] == 0;
  }
  // Written whole, and nothing behind it.
  bool written() const {
    for (const Numbers& o : out)
      for (std::size_t k = 0; k < o.size(); ++k)
        if ((o[k] == pattern) != (k + guard >= o.size())) return false;
    return true;
  }
};

inline const CallRow& call_row(const std::string& name) {
  for (const CallRow& r : call_rows)
    if (name == r.name) return r;
  ADD_FAILURE() << "no call " << name;
  return call_rows[0];
}

}  // namespace dyn_test
