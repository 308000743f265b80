// Energy guard: no step may add kinetic energy that nothing explains. Between the states at its ends
//   K1 - K0 - W <= share (K0 + W)
// with K the kinetic energy, W the positive work of gravity, springs, actuators, tau, wrenches, forces on links, soft rows and
// belts: the drop of a potential, or its positive power at each body or actuator where that is more. Corrections of overlaps,
// which lift bodies and stretch springs, then hide no work. The share is the error of an integrator of order 1. Nor may many
// steps together: their gains and losses, each over K0 + W, are summed.
// Energies are evaluated only where something moves far within the step, or where rows did positive work.
#pragma once

#include <algorithm>
#include <span>

#include "simulation/step.hpp"

namespace dyn::simulation {

struct StepEnergy {
  double kinetic, gravity, springs, actuators;  // J
  double falling, driving;  // W, power of gravity, positive power of actuators one by one
  double power;             // W, of wrenches and forces on links
  Index fastest;            // joint with the largest kinetic energy
  double potential() const { return gravity + springs + actuators; }
};

// Numbers that step_energy needs: two vectors a body, aligned.
inline std::ptrdiff_t energy_numbers(const Model& m) { return 8 * std::ptrdiff_t(m.n.bodies) + 8; }
// By which joints may turn, rad, or slide, over the length scale, in a step that the cheap test lets pass: less where light links
// move heavy ones, as M then changes by many times itself in a small motion.
// subtree: memory of a number a body.
double guarded_motion(const Model& m, double* subtree);
// Returns whether a step of h from d.backup to the state in d may have gained energy: the cheap test.
bool may_gain_energy(const Model& m, Data<double>& d, double h);
// Returns whether anything moves by more than rounding in a step of h: work of rows at rest has any sign.
bool moves(const Model& m, const Data<double>& d, double h);
// Energies of the state in d. The memory of the integrator's stages, from `memory` on, is overwritten.
StepEnergy step_energy(const Model& m, Data<double>& d, double* memory);
// Sum over the parts of a step.
struct EnergyGain {
  double gain, base;       // unexplained; K0 and what was given
  double springs, taken;   // their energy at the beginning, and what they and gravity took, but where a correction stretched them
  // share: of the base
  bool exceeds(double share) const { return !(gain <= share * base); }
  // of the kinetic energy, after `so_far`
  double growth(double so_far) const {
    const double kept = (so_far > tuning::guard::growth ? tuning::guard::fading : 1) * so_far;
    return std::max(0.0, kept + (base > 0 ? (gain + taken) / (base + springs) : 0));
  }
};
// Adds a part of h that ended at the state in d. v0: its velocity at the beginning. stored: what V rises by counts, too; not
// where corrections of overlaps stretch springs.
void add_gain(const Model& m, const Data<double>& d, const StepEnergy& before, const StepEnergy& after, const double* v0,
              double h, bool stored, EnergyGain& sum);
// Sets the forces of all contacts to zero: a step that is repeated begins without a guess.
void forget_forces(Workspace& w);

// An explicit method whose amplification factor is R multiplies oscillations of springs, damping and gains by |R(h s)| in each
// step, with s^2 + (c / D) s + k / D = 0 and D the joint's inertia with the joints beyond it free: at least its effective
// inertia. Returns the joint at which |R| is too large, or 0. length: step below which it would not be.
Index unstable_joint(const Model& m, const Data<double>& d, double h, std::span<const double> R, double& length);

}  // namespace dyn::simulation
