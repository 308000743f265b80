// What tests of batches share: owners, arrays of random states, and what single calls say.
#pragma once

#include "common/every.hpp"
#include "capi/calls.hpp"

namespace dyn_test {

struct Batch {
  dynBatch* b = nullptr;
  Batch(const dynModel* m, int threads, dynParts parts = 0) {
    EXPECT_EQ(DYN_OK, dyn_batch_new(m, parts, threads, &b)) << dyn_last_error();
  }
  Batch(const Batch&) = delete;
  ~Batch() { dyn_batch_free(b); }
  operator dynBatch*() const { return b; }
};

inline const int batch_algorithms = int(every<dynAlgorithm>("dynAlgorithm").size());

inline dynAlgorithmInfo batch_info(const dynModel* m, int algorithm) {
  dynAlgorithmInfo info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(DYN_OK, dyn_algorithm_info(m, dynAlgorithm(algorithm), &info)) << dyn_last_error();
  return info;
}
inline std::size_t row_size(const dynAlgorithmInfo& info, int output) {
  return std::size_t(info.rows[output]) * std::size_t(info.cols[output]) * std::size_t(info.pages[output]);
}
inline bool reads(const dynAlgorithmInfo& info, const std::string& input) {
  return (" " + std::string(info.inputs) + " ").find(" " + input + " ") != std::string::npos;
}

// n random states as plain arrays, and arrays for the results with a guard behind each.
struct BatchCase {
  static constexpr double pattern = -7.25e77;
  static constexpr std::size_t guard = 3;
  const dynModel* m;
  dynAlgorithm algorithm;
  dynAlgorithmInfo info;
  std::int64_t n;
  Numbers q, v, a, tau, fext, b, q1, out[4];
  std::vector<dynStatus> status;
  dynBatchArrays x;

  BatchCase(const dynModel* model, int which, int states, std::uint64_t seed = 1)
      : m(model),
        algorithm(dynAlgorithm(which)),
        info(batch_info(model, which)),
        n(states),
        status(std::size_t(states), DYN_ERROR_INTERNAL) {
    for (std::uint64_t k = 0; k < std::uint64_t(states); ++k) {
      const State s = random_state(m, seed + k);
      auto append = [](Numbers& to, const Numbers& from) { to.insert(to.end(), from.begin(), from.end()); };
      append(q, s.q), append(v, s.v), append(a, s.a), append(tau, s.tau), append(fext, s.fext), append(b, s.a),
          append(q1, random_state(m, seed + k + 1000).q);
    }
    dyn_batch_arrays_init(&x);
    x.frame = dyn_model_nframes(m) - 1, x.joint = dyn_model_njoints(m) - 1, x.reference = DYN_REFERENCE_LOCAL_WORLD_ALIGNED;
    x.q = q.data(), x.v = v.data(), x.a = a.data(), x.tau = tau.data(), x.fext = fext.data(), x.b = b.data(), x.q1 = q1.data(),
    x.dt = 1e-4, x.integrator = DYN_INTEGRATOR_RK4, x.status = status.data();
    for (int k = 0; k < info.outputs; ++k) {
      out[k].assign(std::size_t(n) * row_size(info, k) + guard, pattern);
      x.out[k] = out[k].data();
    }
  }
  BatchCase(const BatchCase&) = delete;

  dynStatus operator()(dynBatch* batch) const { return dyn_batch_run(batch, algorithm, n, &x); }
  Numbers row(int output, std::int64_t k) const {
    const std::size_t size = row_size(info, output);
    const auto begin = out[output].begin() + std::ptrdiff_t(std::size_t(k) * size);
    return Numbers(begin, begin + std::ptrdiff_t(size));
  }
  bool untouched(int output, std::int64_t k) const {
    for (double e : row(output, k))
      if (e != pattern) return false;
    return true;
  }
  bool guarded() const {
    for (int k = 0; k < info.outputs; ++k)
      for (std::size_t e = out[k].size() - guard; e < out[k].size(); ++e)
        if (out[k][e] != pattern) return false;
    return true;
  }

  // Row k by single calls, on a new data.
  std::vector<Numbers> single(std::int64_t k) const {
    const Data d(m);
    auto at = [&](const Numbers& all) { return all.data() + std::size_t(k) * (all.size() / std::size_t(n)); };
    std::vector<Numbers> results;
    for (int o = 0; o < info.outputs; ++o) results.emplace_back(row_size(info, o), pattern);
    if (algorithm == DYN_ALGORITHM_INTEGRATE) {
      EXPECT_EQ(DYN_OK, dyn_integrate(m, at(q), at(v), results[0].data()));
      return results;
    }
    if (algorithm == DYN_ALGORITHM_DIFFERENCE) {
      EXPECT_EQ(DYN_OK, dyn_difference(m, at(q), at(q1), results[0].data()));
      return results;
    }
    if (algorithm == DYN_ALGORITHM_STEP) {
      EXPECT_EQ(DYN_OK, dyn_data_set_state(m, d, at(q), at(v), nullptr, at(tau)));
      EXPECT_EQ(DYN_OK, take_step(m, d, x.integrator, x.dt));
      return {field(m, d, "q"), field(m, d, "v")};
    }
    const CallRow& call = call_row("dyn_" + std::string(info.name));
    EXPECT_EQ(call.outputs, info.outputs) << info.name;
    Arguments y;
    y.q = at(q), y.v = at(v), y.a = at(a), y.tau = at(tau), y.fext = at(fext), y.b = y.lambda = at(b);
    y.frame = x.frame, y.joint = x.joint, y.reference = x.reference;
    for (int o = 0; o < info.outputs; ++o) {
      EXPECT_EQ(call.size(m, o), row_size(info, o)) << info.name;
      y.out[o] = results[std::size_t(o)].data();
    }
    if (call.needs == Needs::position || call.needs == Needs::velocity || call.needs == Needs::acceleration) {
      EXPECT_EQ(DYN_OK, dyn_forward_kinematics(m, d, y.q, reads(info, "v") ? y.v : nullptr, reads(info, "a") ? y.a : nullptr));
    }
    if (call.needs == Needs::com) {
      EXPECT_EQ(DYN_OK, dyn_com(m, d, y.q, nullptr, nullptr, nullptr, nullptr, nullptr));
    }
    if (call.needs == Needs::factor) {
      EXPECT_EQ(DYN_OK, dyn_crba(m, d, y.q, nullptr));
      EXPECT_EQ(DYN_OK, dyn_cholesky(m, d));
    }
    EXPECT_EQ(DYN_OK, call.call(m, d, y)) << info.name << ": " << dyn_last_error();
    return results;
  }
};

// A random tree of all joint types, some of them followers.
inline Model random_robot(std::uint64_t seed, int joints) {
  Random g{seed};
  Builder b("random");
  const auto types = every<dynJointType>("dynJointType");
  std::vector<std::string> names, leaders;
  for (int k = 0; k < joints; ++k) {
    const std::string name = "j" + std::to_string(k),
                      parent = names.empty() ? "" : names[std::size_t(g.below(int(names.size())))];
    const auto type = dynJointType(1 + g.below(int(types.size()) - 1));  // all but fixed ones
    const Numbers at = g.numbers(3), axis = g.numbers(3);
    Spec s(name.c_str(), type == DYN_JOINT_TYPE_FREE_FLYER && k ? DYN_JOINT_TYPE_SPHERICAL : type,
           parent.empty() ? nullptr : parent.c_str(), {at[0], at[1], at[2]});
    s.about(axis[0], axis[1], axis[2]);
    s.axis2[0] = 0, s.axis2[1] = axis[2], s.axis2[2] = -axis[1];  // of a universal joint: at right angles
    s.pitch = 0.1;
    Spec parts[] = {Spec(nullptr, DYN_JOINT_TYPE_PRISMATIC), Spec(nullptr, DYN_JOINT_TYPE_SPHERICAL),
                    Spec(nullptr, DYN_JOINT_TYPE_PRISMATIC).about(1, 0, 0)};
    if (s.type == DYN_JOINT_TYPE_COMPOSITE) s.parts = parts, s.parts_count = 3;
    const std::string leader = leaders.empty() ? "" : leaders[std::size_t(g.below(int(leaders.size())))];
    if (s.type == DYN_JOINT_TYPE_REVOLUTE || s.type == DYN_JOINT_TYPE_PRISMATIC) {
      if (!leader.empty() && g.below(3) == 0) s.mimic = leader.c_str(), s.mimic_ratio = axis[0], s.mimic_offset = axis[1];
      else leaders.push_back(name);
    }
    const std::string body = "b" + std::to_string(k);
    b.joint(s).body(body.c_str(), name.c_str(), g.uniform(0.5, 3));
    names.push_back(name);
  }
  return b.finish();
}

}  // namespace dyn_test
