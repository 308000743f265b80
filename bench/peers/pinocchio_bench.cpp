// pinocchio_bench - times Pinocchio's algorithms on one model, for comparison with libdyn.
//
// Usage:  pinocchio_bench MODEL.txt [--seconds S] [--rounds R] [--only a,b,c]
//                         [--states FILE] [--write-states FILE] [--results] [--count]
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
//   --count              instead of times, "instructions" of a call
//
// Output: JSON on stdout,
//   {"library","version","compiler","flags","model","nq","nv",
//    "rows":[{"name","ns_median","ns_min"}, ...]}
// ns_median is the median over the rounds of the median over the batches of one round; ns_min is
// the fastest batch.  Rows that Pinocchio does not support for the model have null values: ABA,
// its derivatives and those of RNEA, the inverse of M, Cholesky, the Coriolis matrix, the energies,
// computeAllTerms and most centroidal ones and regressors in models with mimic joints (release
// builds drop Pinocchio's own check and would return wrong numbers).
//
// Built by build_pinocchio.py from the files pinocchio_*.cpp; see pinocchio_bench.hpp.
//
// What the rows are: every call uses the next of 64 random states.  crba and aba are timed in both
// of Pinocchio's conventions, com and jcom with and without the subtrees' quantities (Pinocchio's
// default is with); the fastest variant counts in compare.py.  crba and minv fill the upper
// triangle only, as Pinocchio does.  "cholesky" factors the same M(q_0) at each call (its cost
// does not depend on the values), "cholesky_solve" solves with that factor for the right-hand side tau_i,
// one copy of the right-hand side included, since Pinocchio solves in place. Rows about one frame are
// about that of the last joint of the dump, kinematics included; rows with n^3 numbers are left out
// beyond 150 velocities. Rows with constraints need contacts in the dump.
#include "pinocchio_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "../count.hpp"

#ifndef BENCH_FLAGS
  #define BENCH_FLAGS "unknown"
#endif

namespace
{

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

// Of the call with state 0: two calls less one, without the loop's clock.
long countCall(Row & row)
{
  if (row.prepare) row.prepare();
  const auto calls = [&](long n) {
    const long count = bench::instructions([&] {
      int next = (1 - int(n)) & (kStates - 1);
      row.run(n, next);
    });
    if (count < 0) throw std::runtime_error("--count: this system does not let a process trace its child");
    return count;
  };
  int next = 0;
  row.run(kStates, next);
  return calls(2) - calls(1);
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
  call("gravity_torque");
  printVector("gravity_torque", d.g);
  for (const char * name : {"aba_local", "aba_world"})
    if (call(name)) printVector(name, d.ddq);
  for (const char * name : {"crba_local", "crba_world"})
  {
    call(name);
    d.M.triangularView<Eigen::StrictlyLower>() =
      d.M.transpose().triangularView<Eigen::StrictlyLower>();
    printVector((std::string(name) + "_times_v").c_str(), VectorXd(d.M * s.v));
  }
  if (call("cholesky") && call("cholesky_solve")) printVector("solve_tau", b.x);
  if (call("minv"))
    printVector(
      "minv_times_tau",
      VectorXd(Eigen::MatrixXd(d.Minv.selfadjointView<Eigen::Upper>()) * s.tau));
  if (call("rnea_derivatives"))
  {
    printVector("dtau_dq_times_v", VectorXd(d.dtau_dq * s.v));
    printVector("dtau_dv_times_v", VectorXd(d.dtau_dv * s.v));
  }
  if (call("aba_derivatives"))
  {
    printVector("ddq_dq_times_v", VectorXd(d.ddq_dq * s.v));
    printVector("ddq_dv_times_v", VectorXd(d.ddq_dv * s.v));
  }
  call("jcom");
  printVector("jcom_times_v", Eigen::Vector3d(d.Jcom * s.v));
  if (call("coriolis_matrix")) printVector("coriolis_times_v", VectorXd(d.C * s.v));
  call("joint_jacobians_time_variation");
  printVector("djacobians_times_v", Eigen::Matrix<double, 6, 1>(d.dJ.leftCols(b.model.nv) * s.v));
  call("forward_kinematics");
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
            "                       [--states FILE] [--write-states FILE] [--results] [--count]\n");
  std::exit(2);
}

int run(int argc, char ** argv)
{
  std::string path, statesIn, statesOut, only;
  double seconds = 0.25;
  int rounds = 5;
  bool results = false, counting = false;
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
    else if (a == "--count")
      counting = true;
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
  Bench bench{model, data, states, model.mimicking_joints.empty(), pin::JointIndex(model.njoints - 1),
              VectorXd(model.nq), VectorXd(model.nv), VectorXd(model.nv), {}};
  keep(data);
  keep(bench);
  addKinematicsRows(bench);
  addDynamicsRows(bench);
  addForwardRows(bench);
  addDerivativeRows(bench);
  addCentroidalRows(bench);
  addRegressorRows(bench);
  addConfigurationRows(bench);
  addFrameRows(bench);
  addSecondOrderRows(bench);
  addConstraintRows(bench, loaded.contacts);
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

  for (int r = 0; r < rounds && !counting; ++r)
    for (Row & row : rows)
      if (row.supported) timeRound(row, seconds / rounds);

  printHead(loaded);
  std::printf(" \"rows\": [\n");
  for (std::size_t i = 0; i < rows.size(); ++i)
  {
    const Row & r = rows[i];
    const char * end = i + 1 < rows.size() ? "," : "";
    if (counting && r.supported)
      std::printf("  {\"name\": \"%s\", \"instructions\": %ld}%s\n", r.name.c_str(), countCall(rows[i]), end);
    else if (r.supported)
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
