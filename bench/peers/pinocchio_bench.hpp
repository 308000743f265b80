// What the parts of pinocchio_bench share: Pinocchio's model and data, states, and rows.
//
// All of Pinocchio is compiled here from its headers (PINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION must
// not be defined) and nothing of the wheel is linked: with -march=native, Eigen's alignment here
// differs from that of the wheel's shared libraries, so objects must not cross that border. For the
// same reason the model comes as a text dump.
#pragma once

#ifdef PINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION
  #error "header-only build expected: do not define PINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION"
#endif

// pinocchio::Data allocates, and sets to zero, four nv^3 tensors (d2tau_*), used by
// ComputeRNEASecondOrderDerivatives only: 4 x 8 GB at nv = 1000.  In the headers, these names are
// followed by '(' only in the initialiser list of Data's constructor, so that the macros below give
// the tensors size 0 there and change nothing else.  No algorithm timed here touches them.
#define d2tau_dqdq(...) d2tau_dqdq(0, 0, 0)
#define d2tau_dvdv(...) d2tau_dvdv(0, 0, 0)
#define d2tau_dqdv(...) d2tau_dqdv(0, 0, 0)
#define d2tau_dadq(...) d2tau_dadq(0, 0, 0)
#include <pinocchio/multibody.hpp>
#undef d2tau_dqdq
#undef d2tau_dvdv
#undef d2tau_dqdv
#undef d2tau_dadq

#include <chrono>
#include <functional>
#include <limits>
#include <string>
#include <vector>

using pinocchio::Convention;
using pinocchio::Data;
using pinocchio::Model;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const int kStates = 64;
const int kTensorColumns = 150; // rows with n^3 numbers are for models up to this size

struct State
{
  VectorXd q, v, a, tau;
};

template<class T>
inline void keep(const T & x)
{
  asm volatile("" : : "g"(&x) : "memory");
}

inline double now()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
    .count();
}

struct Row
{
  std::string name;
  bool supported = true;
  std::function<void()> prepare = nullptr;                     // before each round
  std::function<double(long calls, int & next)> run = nullptr; // seconds for that many calls
  long batch = 0;
  int next = 0;
  double best = std::numeric_limits<double>::infinity();
  std::vector<double> medians = {};
};

struct Bench
{
  const Model & model;
  Data & data;
  const std::vector<State> & states;
  bool noMimic;
  pinocchio::JointIndex last; // joint of the rows about one frame
  VectorXd qOut, vOut, x;
  std::vector<Row> rows;

  // The loop over the calls is compiled once per row, with the algorithm's call direct in it.
  template<class F>
  Row & add(const char * name, bool supported, F f)
  {
    const std::vector<State> & st = states;
    Row row;
    row.name = name;
    row.supported = supported;
    row.run = [&st, f](long calls, int & next) mutable {
      int i = next;
      const double t0 = now();
      for (long k = 0; k < calls; ++k)
      {
        f(st[(std::size_t)i], st[(std::size_t)((i + 1) & (kStates - 1))]);
        i = (i + 1) & (kStates - 1);
      }
      const double t = now() - t0;
      next = i;
      return t;
    };
    rows.push_back(row);
    return rows.back();
  }
};

// Each in a file of its own (pinocchio_kinematics.cpp, ...), to keep the time and memory of a
// compilation low.
void addKinematicsRows(Bench &);
void addDynamicsRows(Bench &);
void addForwardRows(Bench &);
void addDerivativeRows(Bench &);
void addCentroidalRows(Bench &);
void addRegressorRows(Bench &);
void addConfigurationRows(Bench &);
void addFrameRows(Bench &);
void addSecondOrderRows(Bench &);

namespace pin = pinocchio;
using S = const State &;
