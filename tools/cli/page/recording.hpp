// What a simulation did, at about 60 moments a second, thinned to what a page can hold.
#pragma once

#include "../ledger.hpp"
#include "page.hpp"

namespace cli::page {

class Recording {
 public:
  Recording(const Robot& robot, std::uint32_t effects);

  struct Moment {
    double time, kinetic, potential;
    const double *q, *v, *tau;
  };
  bool due(double time) const { return time >= next_ - 1e-9; }
  void add(const Data& simulated, const Moment& moment, const Ledger* ledger, double step_s);
  json packed(Pack& pack, json& notes) const;
  // Placements of the joints but the universe's: 3 and a quaternion (x, y, z, w) each; the centre of mass.
  void poses(const double* q, Vector& positions, Vector& turns, Vector& com) const;
  // Straight pieces of the paths of tendons: both ends, and the activation of a muscle that pulls, else -1: 7 numbers each.
  Vector tendons(const Data& simulated, const double* q) const;

 private:
  struct Contact {
    double position[3], force[3], distance;
    std::uint32_t a, b;
  };
  struct Sample {
    double time;
    Vector positions, turns, com, q, v, tau, actuators, energy, solver, ledger;
    Vector tendons;
    std::vector<Contact> contacts;
  };
  Sample sample_of(const Data& simulated, const Moment& moment) const;
  void thin();
  std::size_t numbers() const;

  const Robot& robot_;
  Data mind_;                     // where placements are computed: the simulated data stays as it is
  std::vector<int> frame_of_;     // a frame of each joint
  std::vector<int> muscle_of_;    // index of the activation of a tendon's muscle; -1: none
  std::vector<Sample> samples_;
  std::size_t contacts_ = 0, pieces_ = 0;
  double every_, next_ = 0;
};

// The head of a page: what was recorded of the robot. More keys may come to it.
json head(const char* kind, const RobotOptions& options, const Robot& robot, const Recording& recording, Pack& pack, json notes);
// The robot where it begins, in a page without time.
json still(const char* kind, const RobotOptions& options, const Robot& robot, const State& state, std::uint32_t effects,
           Pack& pack, const json& notes);

// Names of the coordinates of q (or v): the joint's, with a number behind it where it has several.
std::vector<std::string> coordinate_names(const Robot& robot, bool of_q);

}  // namespace cli::page
