// Part of pinocchio_bench: the model dump (see dump_model.py for its format) and the states.
#include "pinocchio_model.hpp"

#include <pinocchio/algorithm/joint-configuration.hpp>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

using pinocchio::JointIndex;
using pinocchio::JointModel;

namespace
{

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

Kind kindOf(const std::string & type)
{
  if (type.rfind("RUB", 0) == 0) return Kind::Circle;
  if (type == "SPHERICAL") return Kind::Quaternion;
  if (type == "PLANAR") return Kind::Planar;
  if (type == "FREE") return Kind::Free;
  return Kind::Vector;
}

} // namespace

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
    else if (key == "contact")
    {
      std::string name, kind;
      std::size_t joint = 0;
      Eigen::Matrix3d R;
      Eigen::Vector3d p;
      if (!(s >> name >> kind >> joint)) fail("bad contact");
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          s >> R(r, c);
      if (!(s >> p[0] >> p[1] >> p[2])) fail("bad placement");
      if (joint >= (std::size_t)model.njoints) fail("no such joint");
      out.contacts.push_back({joint, pinocchio::SE3(R, p), kind == "point"});
    }
    else
      fail("unknown key '" + key + "'");
  }
  if (!header) throw std::runtime_error(path + ": empty or not a model dump");
  if (model.njoints < 2) throw std::runtime_error(path + ": no joint");
  return out;
}

// ---------------------------------------------------------------------------------- states
namespace
{

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

} // namespace

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
