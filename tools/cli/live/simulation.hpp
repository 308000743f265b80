// A simulation that goes on while it is looked at.
#pragma once

#include <optional>

#include "../page/recording.hpp"
#include "../stepping.hpp"

namespace cli::live {

class Simulation {
 public:
  Simulation(const SteppingOptions& options);

  // Steps until it is `wall` seconds further (by the speed asked for), or has taken so long.
  void go_on(double wall);
  // What a page sends: {"do": pause | reset | push | effects | speed, ...}. The sentence of a refusal, or none.
  std::string obey(const json& command);
  // Little-endian floats: see tools/viewer/src/live.js.
  std::vector<float> state() const;

  json head(page::Pack& pack) const;  // of the page
  const std::string& failure() const { return failure_; }  // of the last step: it is paused then

 private:
  void begin(const State& state);
  void push(const json& command);

  SteppingOptions options_;
  json notes_ = json::array();
  Robot robot_;
  State start_;
  std::uint32_t effects_;
  page::Recording poses_;
  std::optional<Data> data_;
  double time_ = 0, before_ = 0;  // s; before_: until effects were last switched
  double speed_ = 1, owed_ = 0, step_s_ = 0, rate_ = 0;
  bool paused_ = false;
  std::string failure_;
};

}  // namespace cli::live
