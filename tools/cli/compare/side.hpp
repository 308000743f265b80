// One side of a comparison: a model, how it is stepped and where it starts. Sides with some of the other's numbers are run, too.
#pragma once

#include <map>
#include <memory>

#include "../stepping.hpp"

namespace cli::compare {

// A quantity of one object of a model, by names: dynParameter.
struct Quantity {
  int index;  // in the builder's list
  std::string group, object, name, quantity;
  Vector values;
  std::string key() const { return object + '\n' + name + '\n' + quantity; }
  std::string text() const { return name.empty() ? quantity : object + " '" + name + "': " + quantity; }
};

// What does not stand in the model.
struct Stepping {
  double dt;
  dynIntegrator integrator;
  std::uint32_t effects;
  ContactSolver solver;
};

using Changes = std::vector<std::pair<int, Vector>>;  // quantities by their index, and their new numbers

class Side {
 public:
  Side(const RobotOptions& options, bool ground);
  const Robot& robot() const { return robot_; }
  const std::vector<Quantity>& quantities() const { return quantities_; }
  const Quantity* find(const std::string& key) const;
  // The model with changes; fails where numbers are refused.
  std::unique_ptr<Robot> with(const Changes& changes) const;

  Stepping stepping{};
  State start{};

 private:
  Robot robot_;
  std::unique_ptr<dynBuilder, Deleter<dyn_builder_free>> builder_;
  std::vector<Quantity> quantities_;
  std::map<std::string, std::size_t> by_key_;
};

// The state of one model in another: by names of joints and actuators. Joints that it does not have: neutral.
State moved(const Robot& from, const Robot& to, const State& state);

// Frames that two models share, by name and type.
struct Shared {
  std::vector<std::pair<int, int>> frames;
  std::vector<std::string> names;
};
Shared shared_frames(const Robot& a, const Robot& b);

// Placements of all frames at equally distant moments, the start among them; fewer where the run ended early.
struct Path {
  std::vector<Vector> places;
  std::string error;
};
Path run(const Robot& robot, const Stepping& stepping, const State& start, double every, int moments);
Vector places_of(const Robot& robot, const Data& data, const double* q);

// Largest distance of any shared frame, m, or angle, rad; frame: which.
double distance(const Shared& shared, const Vector& a, const Vector& b, int* frame = nullptr);
// The same over moments; infinite where a path ended before.
Vector distances(const Shared& shared, const Path& a, const Path& b, int moments);

}  // namespace cli::compare
