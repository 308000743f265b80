// Rollouts: many simulations of one model by the threads of a batch.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "batch.hpp"
#include "model/effects.hpp"
#include "sensors.hpp"

using namespace dyn;
using namespace dyn::capi;

namespace {

constexpr std::int64_t steps_between_looks = 64;  // at the clock, and at the caller's wish to end
constexpr std::chrono::milliseconds between_calls{10};
using Clock = std::chrono::steady_clock;

template <class T>
T* row(T* array, std::ptrdiff_t size, std::int64_t k) {
  return array ? array + k * size : nullptr;
}

dynStatus cancelled_at(std::int64_t made, std::int64_t of) {
  return fail(DYN_ERROR_CANCELLED, "dyn_batch_rollout: cancelled after %lld of %lld steps", static_cast<long long>(made),
              static_cast<long long>(of));
}

// What rows of a rollout follow from.
bool same_rows(const Model& a, const Model& b) {
  const auto rows = [](const Model& m) {
    return std::array{m.n.nq, m.n.nv, m.n.nu, m.n.na, m.n.joints, m.n.frames, m.n.shapes, m.n.mocaps, m.n.sensors,
                      m.n.sensor_values};
  };
  return rows(a) == rows(b);
}

}  // namespace

struct Batch::Rollout {
  // The data of a thread whose simulations have models of their own.
  struct OwnData {
    std::vector<char> memory;
    const dynModel* model = nullptr;
    dynData* data = nullptr;

    // New data of the model, with the effects and steps given.
    dynStatus begin(const dynModel* m, const Data<double>& like, const dynStepOptions& stepping) {
      if (const dynStatus s = dyn_data_init(m, like.parts, memory.data(), memory.size(), &data)) return s;
      model = m;
      std::copy_n(like.chosen_effects, m->m->n.joints, data->body->d.chosen_effects);
      switch_effects(*m->m, data->body->d, data->body->stepping);
      return dyn_data_set_step_options(m, data, &stepping);
    }
  };

  const Batch& batch;
  const dynRollout& x;
  const std::int64_t n, records, steps, share;
  const std::ptrdiff_t state, sensor_size;
  const dynStepOptions& stepping;
  const double dt;
  const bool imu;
  mutable std::vector<OwnData> own = {};    // of each thread
  std::vector<std::int64_t> lags = {};      // of each sensor of the model, in steps
  mutable std::vector<double> readings = {};  // of each thread
  Clock::time_point told{};
  alignas(64) std::atomic<std::int64_t> next{0};
  alignas(64) std::atomic<std::int64_t> made{0};
  std::atomic<bool> cancelled{false};

  Rollout(const Batch& b, std::int64_t count, const dynRollout& r, const dynStepOptions& options)
      : batch(b),
        x(r),
        n(count),
        records(r.steps / r.every),
        steps(count * r.steps),
        // simulations of few steps are given out several at a time
        share(std::clamp<std::int64_t>(std::min(n / (32 * b.threads), steps_between_looks / r.steps), 1, 64)),
        state(std::ptrdiff_t(dyn_model_state_size(b.handle))),
        sensor_size(size_of(sensors())),
        stepping(options),
        dt(options.dt),
        imu(reads_acceleration(sensors())),
        own(r.models ? std::size_t(b.threads) : 0) {
    std::size_t bytes = 0;
    for (std::int64_t k = 0; x.models && k < n; ++k)
      bytes = std::max(bytes, dyn_data_size(x.models[k], b.datas[0]->body->d.parts));
    for (OwnData& o : own) o.memory.resize(bytes);
    if (!x.model_sensors) return;
    const Model& m = *b.handle->m;
    for (Index k = 0; k < m.n.sensors; ++k)
      lags.push_back(x.sensor_delays ? std::llround(std::min(m.sensors()[k].spec.delay / dt, 1e15)) : 0);
    readings.resize(std::size_t(b.threads) * std::size_t(m.n.sensor_values));
  }

  Sensors sensors() const { return {x.sensor, x.sensor_frame, x.sensors}; }

  void work(int thread) {
    double* acceleration = batch.accelerations.get() + std::ptrdiff_t(thread) * batch.sizes.nv;
    for (std::int64_t begin; (begin = next.fetch_add(share, std::memory_order_relaxed)) < n;)
      for (std::int64_t k = begin; k < std::min(begin + share, n); ++k) {
        std::int64_t at = 0;  // steps
        const dynStatus s = simulate(k, thread, acceleration, at);
        if (x.status) x.status[k] = s;
        if (s != DYN_OK && s != DYN_ERROR_CANCELLED) batch.workers[std::size_t(thread)].failed(k, s);
        made.fetch_add(at % steps_between_looks, std::memory_order_relaxed);
        look(thread);
      }
  }

  // The caller's thread tells how far all are, at first and then when some time has passed: what it calls may take long.
  void look(int thread) {
    if (thread != 0 || !x.progress) return;
    if (const auto now = Clock::now(); now - told >= between_calls) told = now, tell();
  }
  void tell() {
    if (x.progress && x.progress(x.context, made.load(std::memory_order_relaxed), steps))
      cancelled.store(true, std::memory_order_relaxed);
  }

  // The data at the beginning of simulation k.
  dynStatus begin(std::int64_t k, int thread, const dynModel*& m, dynData*& data) {
    const void* from = row(static_cast<const char*>(x.states), state, k);
    data = batch.datas[std::size_t(thread)].get();
    if (!x.models) return dyn_data_restore_state(m = batch.handle, data, from ? from : batch.fresh.data(), std::size_t(state));
    OwnData& mine = own[std::size_t(thread)];
    m = x.models[k];
    if (mine.model != m || !from)
      if (const dynStatus s = mine.begin(m, data->body->d, stepping)) return s;
    data = mine.data;
    return from ? dyn_data_restore_state(m, data, from, std::size_t(state)) : DYN_OK;
  }

  dynStatus simulate(std::int64_t k, int thread, double* acceleration, std::int64_t& at) {
    const dynModel* m = nullptr;
    dynData* data = nullptr;
    const Sizes& sizes = batch.sizes;
    if (cancelled.load(std::memory_order_relaxed)) return DYN_ERROR_CANCELLED;
    if (const dynStatus s = begin(k, thread, m, data)) return s;
    if (x.q0 || x.v0)
      if (const dynStatus s = dyn_data_set_state(m, data, row(x.q0, sizes.nq, k), row(x.v0, sizes.nv, k), nullptr, nullptr))
        return s;
    if (x.model_sensors) {
      std::fill_n(acceleration, sizes.nv, 0.0);
      if (const dynStatus s = sense(m, data, k, 0, acceleration, thread)) return s;
    }
    for (std::int64_t r = k * records; r < (k + 1) * records; ++r) {
      if (x.mocap)
        if (const dynStatus s = place_mocaps_of(m, data, row(x.mocap, 12 * std::ptrdiff_t(m->m->n.mocaps), r))) return s;
      if (x.control)
        if (const dynStatus s = dyn_data_set_control(m, data, row(x.control, m->m->n.nu, r))) return s;
      if (x.tau)
        if (const dynStatus s = dyn_data_set_state(m, data, nullptr, nullptr, nullptr, row(x.tau, sizes.nv, r))) return s;
      for (int i = 0; i < x.every; ++i) {
        const bool senses = x.model_sensors && is_due(at + 1), last = i + 1 == x.every;
        if ((imu && last) || senses) std::copy_n(data->body->d.v, sizes.nv, acceleration);
        if (const dynStatus s = dyn_step(m, data)) return s;
        if ((imu && last) || senses)
          for (int j = 0; j < sizes.nv; ++j) acceleration[j] = (data->body->d.v[j] - acceleration[j]) / dt;
        if (senses)
          if (const dynStatus s = sense(m, data, k, at + 1, acceleration, thread)) return s;
        if (++at % steps_between_looks) continue;
        made.fetch_add(steps_between_looks, std::memory_order_relaxed);
        look(thread);
        if (cancelled.load(std::memory_order_relaxed)) return DYN_ERROR_CANCELLED;
      }
      if (const dynStatus s = record(m, data, r, acceleration)) return s;
    }
    return DYN_OK;
  }

  // Whether some record holds sensors of the model as they are after `step` steps.
  bool is_due(std::int64_t step) const {
    return std::any_of(lags.begin(), lags.end(), [&](std::int64_t lag) {
      return (step + lag) % x.every == 0 && step + lag <= x.steps;
    });
  }
  // Enters the model's sensors after `step` steps of simulation k in the records that hold them.
  dynStatus sense(const dynModel* m, dynData* data, std::int64_t k, std::int64_t step, const double* acceleration,
                  int thread) const {
    const Model& model = *m->m;
    const std::ptrdiff_t size = model.n.sensor_values;
    double* const reading = readings.data() + thread * size;
    if (const dynStatus s = dyn_sensors(m, data, nullptr, nullptr, acceleration, reading)) return s;
    const auto enter = [&](const dynSensor& s, std::int64_t record) {
      std::copy_n(reading + s.idx, s.size, row(x.model_sensors, size, k * records + record) + s.idx);
    };
    for (Index i = 0; i < model.n.sensors; ++i) {
      const dynSensor& s = model.sensors()[i].spec;
      const std::int64_t shown = step + lags[std::size_t(i)];
      if (step == 0)
        for (std::int64_t record = 0; record < std::min(records, shown / x.every); ++record) enter(s, record);
      else if (shown % x.every == 0 && shown <= x.steps) enter(s, shown / x.every - 1);
    }
    return DYN_OK;
  }

  dynStatus record(const dynModel* m, dynData* data, std::int64_t r, double* acceleration) const {
    const Sizes& sizes = batch.sizes;
    copy_out(data->body->d.q, sizes.nq, row(x.q, sizes.nq, r));
    copy_out(data->body->d.v, sizes.nv, row(x.v, sizes.nv, r));
    if (x.contact_count)
      if (const dynStatus s = dyn_data_step_contacts(m, data, row(x.contacts, x.contact_capacity, r),
                                                     x.contacts ? x.contact_capacity : 0, x.contact_count + r))
        return s;
    if (x.final_states && (r + 1) % records == 0)
      if (const dynStatus s =
              dyn_data_save_state(m, data, static_cast<char*>(x.final_states) + r / records * state, std::size_t(state)))
        return s;
    if (x.model_sensors && x.sensor_noise)
      if (const dynStatus s = dyn_sensor_noise(m, x.sensor_seed + std::uint64_t(r / records), std::uint64_t(r % records),
                                               row(x.model_sensors, m->m->n.sensor_values, r)))
        return s;
    if (!x.sensor_data) return DYN_OK;
    return read_sensors(m, data, sensors(), imu ? acceleration : nullptr, row(x.sensor_data, sensor_size, r));
  }
};

dynStatus Batch::rollout(std::int64_t n, const dynRollout& x) {
  const Turn turn(*this, "dyn_batch_rollout");
  if (turn.status != DYN_OK) return turn.status;
  if (const dynStatus s = check_sensors(*handle->m, {x.sensor, x.sensor_frame, x.sensors}, "dyn_batch_rollout")) return s;
  dynStepOptions of_model{};
  of_model.struct_size = sizeof of_model;
  if (const dynStatus s = dyn_model_step_options(handle, &of_model)) return s;
  const Given<dynStepOptions> stepping("dyn_batch_rollout", x.stepping ? x.stepping : &of_model);
  if (stepping.status != DYN_OK) return stepping.status;
  for (const auto& data : datas)
    if (const dynStatus s = dyn_data_set_step_options(handle, data.get(), &*stepping)) return s;  // the first one, if any
  for (std::int64_t k = 0; x.models && k < n; ++k) {
    if (const dynStatus s = check(x.models[k])) return s;
    if (!same_rows(*handle->m, *x.models[k]->m) || dyn_model_state_size(x.models[k]) != dyn_model_state_size(handle))
      return fail(DYN_ERROR_MODEL,
                  "dyn_batch_rollout: models[%lld] has other joints, frames, shapes, actuators or sensors than the batch's model",
                  static_cast<long long>(k));
  }
  Rollout job(*this, n, x, *stepping);
  const dynStatus status = work(job, n, "dyn_batch_rollout: ", "simulation");
  if (job.cancelled) return cancelled_at(job.made, job.steps);
  job.tell();
  return status;
}

template <>
dynRollout capi::defaults() {
  dynRollout r{};
  r.steps = r.every = 1;
  return r;
}

extern "C" {

int dyn_sensor_size(dynSensorType sensor) { return sensor_size(sensor); }

dynStatus dyn_batch_rollout(dynBatch* batch, int64_t n, const dynRollout* rollout) {
  const DefaultFloatingPoint settings;
  constexpr const char* function = "dyn_batch_rollout";
  if (const dynStatus s = check(batch)) return s;
  if (!rollout) return fail(DYN_ERROR_ARGUMENT, "%s: rollout is NULL: it is required", function);
  const Given<dynRollout> given(function, rollout);
  if (given.status != DYN_OK) return given.status;
  const dynRollout& x = *given;
  if (x.steps < 1 || x.every < 1 || x.steps % x.every)
    return fail(DYN_ERROR_ARGUMENT, "%s: steps is %d and every is %d: give at least 1, and an every that divides steps", function,
                x.steps, x.every);
  const std::int64_t most = max_records / x.steps;
  if (n < 0 || n > most)
    return fail(DYN_ERROR_ARGUMENT, "%s: n is %lld: give a number of simulations from 0 to %lld", function,
                static_cast<long long>(n), static_cast<long long>(most));
  if (x.contact_capacity < 0)
    return fail(DYN_ERROR_ARGUMENT, "%s: contact_capacity is %d: give 0 or more", function, x.contact_capacity);
  if (x.contacts && !x.contact_count) return fail(DYN_ERROR_ARGUMENT, "%s: contact_count is NULL: contacts need it", function);
  return n ? batch->b->rollout(n, x) : DYN_OK;
}

}  // extern "C"
