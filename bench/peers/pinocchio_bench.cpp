// pinocchio_bench - times Pinocchio's algorithms on one model, for comparison with libdyn.
//
// Usage:  pinocchio_bench MODEL.txt [--seconds S] [--rounds R] [--only a,b,c]
//                         [--states FILE] [--write-states FILE] [--results]
//
//   MODEL.txt            model dump written by dump_model.py (see there for the format)
//   --seconds S          approximate time spent per row, over all rounds (default 0.25)
//   --rounds R           number of passes over all rows (default 5)
//   --only a,b,c         time only these rows
//   --states FILE        read the 64 states from FILE: 64 lines of nq + 3 nv numbers (q v a tau)
//                        instead of generating them
//   --write-states FILE  write the states used, in the same format
//   --results            instead of timing, print the results for state 0 (to check that the model
//                        read here is the model dumped)
//
// Output: JSON on stdout,
//   {"library","version","compiler","flags","model","nq","nv",
//    "rows":[{"name","ns_median","ns_min"}, ...]}
// ns_median is the median over the rounds of the median over the batches of one round; ns_min is
// the fastest batch.  Rows that Pinocchio does not support for the model have null values: ABA,
// the inverse of M, Cholesky, the Coriolis matrix, the energies and computeAllTerms in models with
// mimic joints (release builds drop Pinocchio's own check and would return wrong numbers).
//
// Built by build_pinocchio.py, which compiles this file once per BENCH_PART = 0..5 and links the
// objects, to keep the time and memory of each compilation low; without BENCH_PART the file is a
// whole program.  All of Pinocchio is compiled here from its headers
// (PINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION must not be defined) and nothing of the wheel is linked:
// with -march=native, Eigen's alignment here differs from that of the wheel's shared libraries,
// so objects must not cross that border.  For the same reason the model comes as a text dump.
//
// What the rows are: every call uses the next of 64 random states.  crba and aba are timed in both
// of Pinocchio's conventions, com and jcom with and without the subtrees' quantities (Pinocchio's
// default is with); the fastest variant counts in compare.py.  crba and minv fill the upper
// triangle only, as Pinocchio does.  "cholesky" factors the same M(q_0) at each call (its cost
// does not depend on the values), "solve" solves with that factor for the right-hand side tau_i,
// one copy of the right-hand side included, since Pinocchio solves in place.

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

#ifdef BENCH_PART
  #define BENCH_HAS(part) (BENCH_PART == part)
#else
  #define BENCH_HAS(part) 1
#endif

#include <pinocchio/algorithm/joint-configuration.hpp>
#if BENCH_HAS(1)
  #include <pinocchio/algorithm/jacobian.hpp>
  #include <pinocchio/algorithm/kinematics.hpp>
  #include <pinocchio/algorithm/rnea.hpp>
#endif
#if BENCH_HAS(2)
  #include <pinocchio/algorithm/aba.hpp>
#endif
#if BENCH_HAS(3)
  #include <pinocchio/algorithm/center-of-mass.hpp>
  #include <pinocchio/algorithm/cholesky.hpp>
  #include <pinocchio/algorithm/crba.hpp>
#endif
#if BENCH_HAS(4)
  #include <pinocchio/algorithm/compute-all-terms.hpp>
  #include <pinocchio/algorithm/energy.hpp>
  #include <pinocchio/algorithm/jacobian.hpp>
  #include <pinocchio/algorithm/rnea.hpp>
#endif
#if BENCH_HAS(5)
  #include <pinocchio/algorithm/centroidal-derivatives.hpp>
  #include <pinocchio/algorithm/centroidal.hpp>
  #include <pinocchio/algorithm/regressor.hpp>
#endif

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#ifndef BENCH_FLAGS
  #define BENCH_FLAGS "unknown"
#endif

using pinocchio::Convention;
using pinocchio::Data;
using pinocchio::JointIndex;
using pinocchio::JointModel;
using pinocchio::Model;
using Eigen::VectorXd;

// ---------------------------------------------------------------------------------- shared
const int kStates = 64;

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
    row.run = [&st, f](long calls, int & next) {
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

void addKinematicsRows(Bench &);
void addAbaRows(Bench &);
void addInertiaRows(Bench &);
void addOtherRows(Bench &);
void addCentroidalRows(Bench &);

namespace pin = pinocchio;
using S = const State &;

#if BENCH_HAS(1)
void addKinematicsRows(Bench & b)
{
  const Model & model = b.model;
  Data & data = b.data;
  b.add("fk", true, [&](S s, S) { pin::forwardKinematics(model, data, s.q); keep(data); });
  b.add("fk_qva", true, [&](S s, S) {
    pin::forwardKinematics(model, data, s.q, s.v, s.a);
    keep(data);
  });
  b.add("jacobians", true, [&](S s, S) {
    pin::computeJointJacobians(model, data, s.q);
    keep(data);
  });
  b.add("rnea", true, [&](S s, S) { pin::rnea(model, data, s.q, s.v, s.a); keep(data); });
  b.add("nle", true, [&](S s, S) { pin::nonLinearEffects(model, data, s.q, s.v); keep(data); });
  b.add("gravity", true, [&](S s, S) {
    pin::computeGeneralizedGravity(model, data, s.q);
    keep(data);
  });
}
#endif // part 1

#if BENCH_HAS(2)
void addAbaRows(Bench & b)
{
  const Model & model = b.model;
  Data & data = b.data;
  b.add("aba_local", b.noMimic, [&](S s, S) {
    pin::aba(model, data, s.q, s.v, s.tau, Convention::LOCAL);
    keep(data);
  });
  b.add("aba_world", b.noMimic, [&](S s, S) {
    pin::aba(model, data, s.q, s.v, s.tau, Convention::WORLD);
    keep(data);
  });
  b.add("minv", b.noMimic, [&](S s, S) { pin::computeMinverse(model, data, s.q); keep(data); });
}
#endif // part 2

#if BENCH_HAS(3)
void addInertiaRows(Bench & b)
{
  const Model & model = b.model;
  Data & data = b.data;
  b.add("crba_local", true, [&](S s, S) {
    pin::crba(model, data, s.q, Convention::LOCAL);
    keep(data);
  });
  b.add("crba_world", true, [&](S s, S) {
    pin::crba(model, data, s.q, Convention::WORLD);
    keep(data);
  });
  b.add("cholesky", b.noMimic, [&](S, S) { pin::cholesky::decompose(model, data); keep(data); })
    .prepare = [&] { pin::crba(model, data, b.states[0].q, Convention::WORLD); };
  b.add("solve", b.noMimic, [&](S s, S) {
    b.x = s.tau;
    pin::cholesky::solve(model, data, b.x);
    keep(b.x);
  }).prepare = [&] {
    pin::crba(model, data, b.states[0].q, Convention::WORLD);
    pin::cholesky::decompose(model, data);
  };
  b.add("com", true, [&](S s, S) { pin::centerOfMass(model, data, s.q, false); keep(data); });
  b.add("com_subtrees", true, [&](S s, S) {
    pin::centerOfMass(model, data, s.q, true);
    keep(data);
  });
  b.add("jcom", true, [&](S s, S) {
    pin::jacobianCenterOfMass(model, data, s.q, false);
    keep(data);
  });
  b.add("jcom_subtrees", true, [&](S s, S) {
    pin::jacobianCenterOfMass(model, data, s.q, true);
    keep(data);
  });
}
#endif // part 3

#if BENCH_HAS(4)
void addOtherRows(Bench & b)
{
  const Model & model = b.model;
  Data & data = b.data;
  b.add("all_terms", b.noMimic, [&](S s, S) {
    pin::computeAllTerms(model, data, s.q, s.v);
    keep(data);
  });
  b.add("integrate", true, [&](S s, S) {
    pin::integrate(model, s.q, s.v, b.qOut);
    keep(b.qOut);
  });
  b.add("difference", true, [&](S s, S t) {
    pin::difference(model, s.q, t.q, b.vOut);
    keep(b.vOut);
  });
  b.add("coriolis", b.noMimic, [&](S s, S) {
    pin::computeCoriolisMatrix(model, data, s.q, s.v);
    keep(data);
  });
  b.add("djacobians", true, [&](S s, S) {
    pin::computeJointJacobiansTimeVariation(model, data, s.q, s.v);
    keep(data);
  });
  b.add("kinetic_energy", b.noMimic, [&](S s, S) {
    const double e = pin::computeKineticEnergy(model, data, s.q, s.v);
    keep(e);
  });
  b.add("potential_energy", b.noMimic, [&](S s, S) {
    const double e = pin::computePotentialEnergy(model, data, s.q);
    keep(e);
  });
}
#endif // part 4

#if BENCH_HAS(5)
void addCentroidalRows(Bench & b)
{
  const Model & model = b.model;
  Data & data = b.data;
  b.add("centroidal_map", true, [&](S s, S) {
    pin::ccrba(model, data, s.q, s.v);
    keep(data);
  });
  b.add("centroidal_map_rate", b.noMimic, [&](S s, S) {
    pin::dccrba(model, data, s.q, s.v);
    keep(data);
  });
  b.add("centroidal_momentum", true, [&](S s, S) {
    pin::computeCentroidalMomentum(model, data, s.q, s.v);
    keep(data);
  });
  b.add("centroidal_momentum_rate", true, [&](S s, S) {
    pin::computeCentroidalMomentumTimeVariation(model, data, s.q, s.v, s.a);
    keep(data);
  });
  Data::Matrix6x dh_dq(6, model.nv), dhdot_dq(dh_dq), dhdot_dv(dh_dq), dhdot_da(dh_dq);
  b.add("centroidal_derivatives", b.noMimic, [&, dh_dq, dhdot_dq, dhdot_dv, dhdot_da](S s, S) {
    pin::computeCentroidalDynamicsDerivatives(
      model, data, s.q, s.v, s.a, dh_dq, dhdot_dq, dhdot_dv, dhdot_da);
    keep(data);
  });
  b.add("torque_regressor", b.noMimic, [&](S s, S) {
    pin::computeJointTorqueRegressor(model, data, s.q, s.v, s.a);
    keep(data);
  });
  b.add("static_regressor", b.noMimic, [&](S s, S) {
    pin::computeStaticRegressor(model, data, s.q);
    keep(data);
  });
  b.add("kinetic_energy_regressor", b.noMimic, [&](S s, S) {
    pin::computeKineticEnergyRegressor(model, data, s.q, s.v);
    keep(data);
  });
  b.add("potential_energy_regressor", b.noMimic, [&](S s, S) {
    pin::computePotentialEnergyRegressor(model, data, s.q);
    keep(data);
  });
}
#endif // part 5

#if BENCH_HAS(0)
namespace
{

// ---------------------------------------------------------------------------------- model
JointModel makeJoint(const std::string & type, const Eigen::Vector3d & axis)
{
  using namespace pinocchio;
  if (type == "RX") return JointModelRX();
  if (type == "RY") return JointModelRY();
  if (type == "RZ") return JointModelRZ();
  if (type == "RU") return JointModelRevoluteUnaligned(axis);
  if (type == "PX") return JointModelPX();
  if (type == "PY") return JointModelPY();
  if (type == "PZ") return JointModelPZ();
  if (type == "PU") return JointModelPrismaticUnaligned(axis);
  if (type == "RUBX") return JointModelRUBX();
  if (type == "RUBY") return JointModelRUBY();
  if (type == "RUBZ") return JointModelRUBZ();
  if (type == "RUBU") return JointModelRevoluteUnboundedUnaligned(axis);
  if (type == "SPHERICAL") return JointModelSpherical();
  if (type == "PLANAR") return JointModelPlanar();
  if (type == "FREE") return JointModelFreeFlyer();
  throw std::runtime_error("unknown joint type '" + type + "'");
}

// Kinds of configuration coordinates, to draw valid random configurations.
enum class Kind { Vector, Circle, Quaternion, Planar, Free };

struct JointKind
{
  Kind kind;
  int q;
};

Kind kindOf(const std::string & type)
{
  if (type.rfind("RUB", 0) == 0) return Kind::Circle;
  if (type == "SPHERICAL") return Kind::Quaternion;
  if (type == "PLANAR") return Kind::Planar;
  if (type == "FREE") return Kind::Free;
  return Kind::Vector;
}

struct Loaded
{
  std::string name;
  Model model;
  std::vector<JointKind> kinds;
};

Loaded loadModel(const std::string & path)
{
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot open " + path);
  Loaded out;
  Model & model = out.model;
  std::string line;
  bool header = false;
  int lineno = 0;
  std::vector<std::pair<std::string, Eigen::Vector3d>> types(1); // per joint, universe first
  while (std::getline(in, line))
  {
    ++lineno;
    std::istringstream s(line);
    std::string key;
    if (!(s >> key) || key[0] == '#') continue;
    const auto fail = [&](const std::string & what) {
      throw std::runtime_error(path + ":" + std::to_string(lineno) + ": " + what);
    };
    if (key == "dyn-bench-model")
    {
      int version = 0;
      s >> version;
      if (version != 1) fail("unsupported version");
      header = true;
    }
    else if (!header)
      fail("not a model dump");
    else if (key == "name")
      s >> out.name;
    else if (key == "gravity")
    {
      Eigen::Vector3d g;
      if (!(s >> g[0] >> g[1] >> g[2])) fail("three numbers expected");
      model.gravity.linear(g);
    }
    else if (key == "universe" || key == "joint")
    {
      JointIndex id = 0;
      if (key == "joint")
      {
        std::string name, type;
        std::size_t parent = 0;
        Eigen::Vector3d axis, p;
        Eigen::Matrix3d R;
        double armature = 0;
        if (!(s >> name >> parent >> type >> axis[0] >> axis[1] >> axis[2])) fail("bad joint");
        for (int r = 0; r < 3; ++r)
          for (int c = 0; c < 3; ++c)
            s >> R(r, c);
        if (!(s >> p[0] >> p[1] >> p[2] >> armature)) fail("bad placement");
        if (parent >= (std::size_t)model.njoints) fail("parent comes after its child");
        const pinocchio::SE3 placement(R, p);
        if (type == "MIMIC")
        {
          // the underlying type, the mimicked joint, scaling and offset
          std::string base;
          std::size_t primary = 0;
          double scaling = 1, offset = 0;
          if (!(s >> base >> primary >> scaling >> offset)) fail("bad mimic joint");
          if (primary == 0 || primary >= (std::size_t)model.njoints) fail("bad mimicked joint");
          const JointModel mimicking = makeJoint(base, axis);
          id = model.addJoint(
            parent,
            pinocchio::JointModelMimic(mimicking, model.joints[primary], scaling, offset),
            placement, name);
        }
        else
        {
          try
          {
            id = model.addJoint(parent, makeJoint(type, axis), placement, name);
          }
          catch (const std::exception & e)
          {
            fail(e.what());
          }
          out.kinds.push_back({kindOf(type), model.idx_qs[id]});
          if (armature != 0)
            model.armature.segment(model.idx_vs[id], model.nvs[id]).setConstant(armature);
        }
      }
      double mass, c[3], i[6];
      if (!(s >> mass >> c[0] >> c[1] >> c[2])) fail("bad inertia");
      for (double & x : i)
        if (!(s >> x)) fail("bad inertia");
      Eigen::Matrix3d I;
      I << i[0], i[1], i[2], i[1], i[3], i[4], i[2], i[4], i[5];
      const pinocchio::Inertia Y(
        mass, Eigen::Vector3d(c[0], c[1], c[2]), pinocchio::Symmetric3(I));
      if (id == 0)
        model.inertias[0] = Y;
      else
        model.appendBodyToJoint(id, Y, pinocchio::SE3::Identity());
    }
    else
      fail("unknown key '" + key + "'");
  }
  if (!header) throw std::runtime_error(path + ": empty or not a model dump");
  if (model.njoints < 2) throw std::runtime_error(path + ": no joint");
  return out;
}

// ---------------------------------------------------------------------------------- states
struct Random // splitmix64: the same numbers with every compiler and library
{
  std::uint64_t s = 42;
  double operator()(double lo, double hi)
  {
    std::uint64_t z = (s += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    z ^= z >> 31;
    return lo + (hi - lo) * double(z >> 11) * 0x1.0p-53;
  }
};

std::vector<State> makeStates(const Loaded & m)
{
  const double pi = 3.14159265358979323846;
  Random rnd;
  std::vector<State> states(kStates);
  for (State & s : states)
  {
    s.q.resize(m.model.nq);
    s.v.resize(m.model.nv);
    s.a.resize(m.model.nv);
    s.tau.resize(m.model.nv);
    for (const JointKind & k : m.kinds)
    {
      int q = k.q;
      if (k.kind == Kind::Vector)
        s.q[q] = rnd(-pi, pi);
      else if (k.kind == Kind::Circle || k.kind == Kind::Planar)
      {
        if (k.kind == Kind::Planar)
        {
          s.q[q++] = rnd(-1, 1);
          s.q[q++] = rnd(-1, 1);
        }
        const double t = rnd(-pi, pi);
        s.q[q] = std::cos(t);
        s.q[q + 1] = std::sin(t);
      }
      else
      {
        if (k.kind == Kind::Free)
          for (int i = 0; i < 3; ++i)
            s.q[q++] = rnd(-1, 1);
        double n;
        do
        {
          for (int i = 0; i < 4; ++i)
            s.q[q + i] = rnd(-1, 1);
          n = s.q.segment<4>(q).norm();
        } while (n < 0.1 || n > 1);
        s.q.segment<4>(q) /= n;
      }
    }
    for (int i = 0; i < m.model.nv; ++i)
      s.v[i] = rnd(-1, 1);
    for (int i = 0; i < m.model.nv; ++i)
      s.a[i] = rnd(-1, 1);
    for (int i = 0; i < m.model.nv; ++i)
      s.tau[i] = rnd(-1, 1);
  }
  return states;
}

std::vector<State> readStates(const std::string & path, const Loaded & m)
{
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot open " + path);
  std::vector<State> states = makeStates(m);
  for (State & s : states)
  {
    for (VectorXd * x : {&s.q, &s.v, &s.a, &s.tau})
      for (Eigen::Index i = 0; i < x->size(); ++i)
        if (!(in >> (*x)[i])) throw std::runtime_error(path + ": too few numbers");
    pinocchio::normalize(m.model, s.q);
  }
  return states;
}

void writeStates(const std::string & path, const std::vector<State> & states)
{
  std::FILE * f = std::fopen(path.c_str(), "w");
  if (!f) throw std::runtime_error("cannot write " + path);
  for (const State & s : states)
  {
    const char * sep = "";
    for (const VectorXd * x : {&s.q, &s.v, &s.a, &s.tau})
      for (Eigen::Index i = 0; i < x->size(); ++i, sep = " ")
        std::fprintf(f, "%s%.17g", sep, (*x)[i]);
    std::fprintf(f, "\n");
  }
  std::fclose(f);
}

// ---------------------------------------------------------------------------------- timing
double median(std::vector<double> x)
{
  if (x.empty()) return std::numeric_limits<double>::quiet_NaN();
  const std::size_t n = x.size();
  std::sort(x.begin(), x.end());
  return n % 2 ? x[n / 2] : 0.5 * (x[n / 2 - 1] + x[n / 2]);
}

void timeRound(Row & row, double budget)
{
  if (row.prepare) row.prepare();
  const double shortest = 100e-6; // of a batch: 3 to 4 orders above the clock's resolution
  if (row.batch == 0)
  {
    row.run(1, row.next); // first touch
    row.batch = 1;
    for (;;)
    {
      const double t = row.run(row.batch, row.next);
      if (t >= shortest) break;
      row.batch = t > 0 ? std::max(row.batch + 1, long(1.2 * shortest / t * double(row.batch)))
                        : row.batch * 10;
    }
  }
  const double warm = now() + 0.15 * budget;
  do
    row.run(row.batch, row.next);
  while (now() < warm);
  std::vector<double> times;
  const double end = now() + 0.85 * budget;
  do
    times.push_back(row.run(row.batch, row.next) / double(row.batch) * 1e9);
  while (now() < end || times.size() < 3);
  row.best = std::min(row.best, *std::min_element(times.begin(), times.end()));
  row.medians.push_back(median(times));
}

// ---------------------------------------------------------------------------------- output
std::string quoted(const std::string & s)
{
  std::string out = "\"";
  for (const char c : s)
  {
    if (c == '"' || c == '\\') out += '\\';
    if ((unsigned char)c >= 32) out += c;
  }
  return out + "\"";
}

std::string compiler()
{
#if defined(__clang__)
  return "clang++ " + std::to_string(__clang_major__) + "." + std::to_string(__clang_minor__) + "."
         + std::to_string(__clang_patchlevel__);
#elif defined(__GNUC__)
  return std::string("g++ ") + __VERSION__;
#else
  return "unknown";
#endif
}

void printHead(const Loaded & m)
{
  std::printf(
    "{\"library\": \"pinocchio\", \"version\": \"%s\", \"eigen\": \"%d.%d.%d\",\n"
    " \"compiler\": %s, \"flags\": %s, \"model\": %s, \"nq\": %d, \"nv\": %d,\n",
    PINOCCHIO_VERSION, EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION,
    quoted(compiler()).c_str(), quoted(BENCH_FLAGS).c_str(), quoted(m.name).c_str(), m.model.nq,
    m.model.nv);
}

template<class Vec>
void printVector(const char * name, const Vec & x, const char * end = ",\n")
{
  std::printf(" \"%s\": [", name);
  for (Eigen::Index i = 0; i < x.size(); ++i)
    std::printf("%s%.17g", i ? ", " : "", double(x[i]));
  std::printf("]%s", end);
}

void printResults(const Loaded & m, Bench & b)
{
  const auto call = [&](const char * name) {
    for (Row & r : b.rows)
      if (r.name == name)
      {
        int state = 0;
        if (r.prepare) r.prepare();
        if (r.supported) r.run(1, state);
        return r.supported;
      }
    throw std::logic_error(name);
  };
  const State & s = b.states[0];
  Data & d = b.data;
  printHead(m);
  printVector("q", s.q);
  printVector("v", s.v);
  printVector("a", s.a);
  printVector("tau", s.tau);
  call("rnea");
  printVector("rnea", d.tau);
  call("nle");
  printVector("nle", d.nle);
  call("gravity");
  printVector("gravity", d.g);
  for (const char * name : {"aba_local", "aba_world"})
    if (call(name)) printVector(name, d.ddq);
  for (const char * name : {"crba_local", "crba_world"})
  {
    call(name);
    d.M.triangularView<Eigen::StrictlyLower>() =
      d.M.transpose().triangularView<Eigen::StrictlyLower>();
    printVector((std::string(name) + "_times_v").c_str(), VectorXd(d.M * s.v));
  }
  if (call("cholesky") && call("solve")) printVector("solve_tau", b.x);
  if (call("minv"))
    printVector(
      "minv_times_tau",
      VectorXd(Eigen::MatrixXd(d.Minv.selfadjointView<Eigen::Upper>()) * s.tau));
  call("jcom");
  printVector("jcom_times_v", Eigen::Vector3d(d.Jcom * s.v));
  if (call("coriolis")) printVector("coriolis_times_v", VectorXd(d.C * s.v));
  call("djacobians");
  printVector("djacobians_times_v", Eigen::Matrix<double, 6, 1>(d.dJ.leftCols(b.model.nv) * s.v));
  call("fk");
  printVector("last_position", d.oMi.back().translation());
  call("integrate");
  printVector("integrate", b.qOut);
  call("difference");
  printVector("difference", b.vOut);
  call("com");
  printVector("com", d.com[0], "}\n");
}

[[noreturn]] void usage()
{
  std::fprintf(
    stderr, "usage: pinocchio_bench MODEL.txt [--seconds S] [--rounds R] [--only a,b,c]\n"
            "                       [--states FILE] [--write-states FILE] [--results]\n");
  std::exit(2);
}

int run(int argc, char ** argv)
{
  std::string path, statesIn, statesOut, only;
  double seconds = 0.25;
  int rounds = 5;
  bool results = false;
  for (int i = 1; i < argc; ++i)
  {
    const std::string a = argv[i];
    const auto value = [&]() -> std::string {
      if (++i >= argc) usage();
      return argv[i];
    };
    if (a == "--seconds")
      seconds = std::atof(value().c_str());
    else if (a == "--rounds")
      rounds = std::atoi(value().c_str());
    else if (a == "--only")
      only = "," + value() + ",";
    else if (a == "--states")
      statesIn = value();
    else if (a == "--write-states")
      statesOut = value();
    else if (a == "--results")
      results = true;
    else if (a.rfind("--", 0) == 0 || !path.empty())
      usage();
    else
      path = a;
  }
  if (path.empty() || !(seconds > 0) || rounds < 1) usage();

  const Loaded loaded = loadModel(path);
  const Model & model = loaded.model;
  const std::vector<State> states =
    statesIn.empty() ? makeStates(loaded) : readStates(statesIn, loaded);
  if (!statesOut.empty()) writeStates(statesOut, states);

  Data data(model);
  Bench bench{model, data, states, model.mimicking_joints.empty(), VectorXd(model.nq),
              VectorXd(model.nv), VectorXd(model.nv), {}};
  keep(data);
  keep(bench);
  addKinematicsRows(bench);
  addAbaRows(bench);
  addInertiaRows(bench);
  addOtherRows(bench);
  addCentroidalRows(bench);
  std::vector<Row> & rows = bench.rows;
  if (results)
  {
    printResults(loaded, bench);
    return 0;
  }

  if (!only.empty())
  {
    rows.erase(
      std::remove_if(
        rows.begin(), rows.end(),
        [&](const Row & r) { return only.find("," + r.name + ",") == std::string::npos; }),
      rows.end());
    if (rows.empty()) throw std::runtime_error("--only names no known row");
  }

  for (int r = 0; r < rounds; ++r)
    for (Row & row : rows)
      if (row.supported) timeRound(row, seconds / rounds);

  printHead(loaded);
  std::printf(" \"rows\": [\n");
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    const Row & r = rows[i];
    const char * end = i + 1 < rows.size() ? "," : "";
    if (r.supported)
      std::printf(
        "  {\"name\": \"%s\", \"ns_median\": %.2f, \"ns_min\": %.2f}%s\n", r.name.c_str(),
        median(r.medians), r.best, end);
    else
      std::printf(
        "  {\"name\": \"%s\", \"ns_median\": null, \"ns_min\": null}%s\n", r.name.c_str(), end);
  }
  std::printf(" ]}\n");
  return 0;
}

} // namespace

int main(int argc, char ** argv)
{
  try
  {
    return run(argc, argv);
  }
  catch (const std::exception & e)
  {
    std::fprintf(stderr, "pinocchio_bench: %s\n", e.what());
    return 1;
  }
}
#endif // part 0
