// Handlers of JAX's foreign function interface: many states a call. Buffers are read and written in place. C++17.
#include <dyn.h>

#include <algorithm>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "xla/ffi/api/ffi.h"

namespace ffi = xla::ffi;

template <class Buffers>
static std::vector<double*> addresses(const Buffers& buffers) {
  std::vector<double*> out;
  for (size_t k = 0; k < buffers.size(); ++k) {
    auto buffer = buffers.template get<ffi::AnyBuffer>(k);
    if constexpr (std::is_same_v<Buffers, ffi::RemainingRets>) out.push_back(static_cast<double*>((*buffer)->untyped_data()));
    else out.push_back(static_cast<double*>(buffer->untyped_data()));
  }
  return out;
}

// All axes but the last one count states. JAX may run calls side by side, but a batch has one caller at a time.
static int64_t count(const ffi::RemainingArgs& args) {
  const auto shape = args.get<ffi::AnyBuffer>(0)->dimensions();
  int64_t n = 1;
  for (size_t k = 0; k + 1 < shape.size(); ++k) n *= shape[k];
  return n;
}
static std::mutex one_caller;

static ffi::Error run(int64_t batch, int64_t algorithm, int64_t frame, ffi::RemainingArgs args, ffi::RemainingRets rets) {
  const std::vector<double*> in = addresses(args), out = addresses(rets);
  dynBatchArrays arrays;
  dyn_batch_arrays_init(&arrays);
  arrays.q = in[0];
  if (in.size() > 2) arrays.v = in[1], arrays.a = arrays.tau = in[2];  // an algorithm reads one of them
  arrays.frame = static_cast<int32_t>(frame);
  arrays.reference = DYN_REFERENCE_LOCAL_WORLD_ALIGNED;
  for (size_t k = 0; k < out.size(); ++k) arrays.out[k] = out[k];
  const std::lock_guard<std::mutex> lock(one_caller);
  auto* runner = reinterpret_cast<dynBatch*>(batch);
  const dynStatus status = dyn_batch_run(runner, static_cast<dynAlgorithm>(algorithm), count(args), &arrays);
  return status ? ffi::Error::Internal(dyn_last_error()) : ffi::Error::Success();
}

// Steps, each with its derivatives if there are outputs for them. data: one for each thread.
static ffi::Error step(int64_t model_address, ffi::Span<const int64_t> data, ffi::RemainingArgs args, ffi::RemainingRets rets) {
  const auto* model = reinterpret_cast<const dynModel*>(model_address);
  const std::vector<double*> in = addresses(args), out = addresses(rets);
  const int64_t n = count(args), nq = dyn_model_nq(model), nv = dyn_model_nv(model), nu = dyn_model_nu(model);
  const int64_t parts = std::min<int64_t>(n, data.size());
  std::vector<std::string> messages(parts);
  const auto part = [&](int64_t thread) {
    auto* d = reinterpret_cast<dynData*>(data[thread]);
    for (int64_t k = n * thread / parts; k < n * (thread + 1) / parts; ++k) {
      dynStepDerivatives x;
      dyn_step_derivatives_init(&x);
      x.q = out[0] + k * nq, x.v = out[1] + k * nv;
      if (out.size() > 2) x.A = out[2] + k * 4 * nv * nv, x.B = out[3] + k * 2 * nv * nv;
      if (out.size() > 4) x.B_control = out[4] + k * 2 * nv * nu;
      if (dyn_data_set_state(model, d, in[0] + k * nq, in[1] + k * nv, nullptr, in[2] + k * nv) ||
          (in.size() > 3 && dyn_data_set_control(model, d, in[3] + k * nu)) || dyn_step_derivatives(model, d, nullptr, &x)) {
        messages[thread] = "state " + std::to_string(k) + ": " + dyn_last_error();
        return;
      }
    }
  };
  const std::lock_guard<std::mutex> lock(one_caller);
  std::vector<std::thread> threads;
  for (int64_t k = 1; k < parts; ++k) threads.emplace_back(part, k);
  if (parts) part(0);
  for (std::thread& t : threads) t.join();
  for (const std::string& message : messages)
    if (!message.empty()) return ffi::Error::Internal(message);
  return ffi::Error::Success();
}

XLA_FFI_DEFINE_HANDLER_SYMBOL(
    libdyn_run, run,
    ffi::Ffi::Bind().Attr<int64_t>("batch").Attr<int64_t>("algorithm").Attr<int64_t>("frame").RemainingArgs().RemainingRets());
XLA_FFI_DEFINE_HANDLER_SYMBOL(
    libdyn_step, step,
    ffi::Ffi::Bind().Attr<int64_t>("model").Attr<ffi::Span<const int64_t>>("data").RemainingArgs().RemainingRets());
