// What a control loop calls, called for long: 10^5 times each (10^6 with Slow), in a process whose allocations and locks are
// counted and that the kernel kills for any system call but read, write and exit (seccomp's strict mode). Inputs change from call
// to call.
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <linux/seccomp.h>

#include <ctime>
#include <functional>

#include "capi/batch.hpp"
#include "rt/interposed.hpp"
#include "soak/simulation.hpp"

namespace dyn_test {
namespace {

// An entry point, ready to be called for the k-th time; cost: of a call, in units of a small one.
struct RealtimeCall {
  std::string name;
  std::function<void(long k)> call;
  long cost = 1;
};

// What the child leaves behind.
struct Note {
  char name[80];
  long calls, allocations, locks;
};

class RealtimeCalls {
 public:
  RealtimeCalls() {
    rows();
    configurations();
    shapes();
    solvers();
    batches();
    steps();
  }
  std::vector<RealtimeCall> all;

 private:
  static constexpr int some = 8;  // inputs
  Model m = chain(7);
  Data d{m};
  std::vector<State> state;
  std::vector<std::unique_ptr<Prepared>> prepared;
  std::vector<std::unique_ptr<BatchCase>> cases;
  std::vector<std::unique_ptr<soak::Simulation>> plays;
  std::unique_ptr<Batch> batch;
  Numbers out = Numbers(200);
  std::vector<char> saved;
  dynBroadPhase* boxes = nullptr;
  dynContactSolver* solver = nullptr;
  Numbers G = Numbers(144), g = Numbers(12), friction = Numbers(4, 0.5);

  void add(std::string name, std::function<void(long)> f, long cost = 1) { all.push_back({std::move(name), std::move(f), cost}); }

  // functions of a model and a data
  void rows() {
    for (int k = 0; k < some; ++k) state.push_back(random_state(m, std::uint64_t(k)));
    for (const CallRow& row : call_rows) {
      if (std::string(row.name) == "dyn_data_warm_up") continue;  // called once
      const std::size_t first = prepared.size();
      for (const State& s : state) prepared.push_back(std::make_unique<Prepared>(row, m, s));
      add(row.name, [this, first](long k) { (*prepared[first + std::size_t(k % some)])(m, d); });
    }
    saved.resize(dyn_model_state_size(m));
    add("dyn_data_save_state, dyn_data_restore_state", [this](long) {
      dyn_data_save_state(m, d, saved.data(), saved.size()), dyn_data_restore_state(m, d, saved.data(), saved.size());
    });
  }
  void configurations() {
    add("functions of configurations", [this](long k) {
      const State &a = state[std::size_t(k % some)], &b = state[std::size_t((k + 1) % some)];
      double *x = out.data(), *J = x + 20;
      int answer;
      dyn_integrate(m, a.q.data(), a.v.data(), x), dyn_difference(m, a.q.data(), b.q.data(), x),
          dyn_interpolate(m, a.q.data(), b.q.data(), 0.3, x);
      dyn_configuration_distance(m, a.q.data(), b.q.data(), x),
          dyn_configuration_random(m, std::uint64_t(k), nullptr, nullptr, x), dyn_configuration_normalize(m, x);
      dyn_configuration_is_normalized(m, x, 1e-9, &answer), dyn_integrate_jacobians(m, a.q.data(), a.v.data(), J, J + 49);
      dyn_difference_jacobians(m, a.q.data(), b.q.data(), J, J + 49);
    });
  }
  void shapes() {
    for (const dynShapeType type :
         {DYN_SHAPE_TYPE_SPHERE, DYN_SHAPE_TYPE_CAPSULE, DYN_SHAPE_TYPE_BOX, DYN_SHAPE_TYPE_CYLINDER, DYN_SHAPE_TYPE_ELLIPSOID})
      add("shapes, type " + std::to_string(type), [type](long k) {
        dynGeometry a, b;
        dyn_geometry_init(&a), dyn_geometry_init(&b);
        a.type = DYN_SHAPE_TYPE_BOX, b.type = type;
        for (int i = 0; i < 3; ++i) a.size[i] = 0.5, b.size[i] = 0.3 + 0.1 * i;
        const double x = 0.001 * double(k % 1000), X[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0},
                     Y[12] = {0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1, x, 0.1, 0.2};
        dynDistance distance{};
        distance.struct_size = sizeof distance;
        dynContact contacts[DYN_MAX_CONTACTS_PER_PAIR];
        int count;
        dyn_geometry_distance(&a, X, &b, Y, nullptr, &distance),
            dyn_geometry_contacts(with<dynGeometryPair>({0, &a, &b, X, Y, nullptr, nullptr}), 0.01, 0, contacts, &count);
      });
    EXPECT_EQ(DYN_OK, dyn_broad_phase_new(40, 4000, 0.01, &boxes));
    for (int k = 0, id; k < 40; ++k) {
      const double lower[3] = {0.2 * k, 0, 0}, upper[3] = {lower[0] + 0.3, 1, 1};
      EXPECT_EQ(DYN_OK, dyn_broad_phase_insert(boxes, lower, upper, &id));
    }
    add("broad phase", [this](long k) {
      const double x = 0.001 * double(k % 7919), lower[3] = {x, 0, 0}, upper[3] = {x + 0.3, 1, 1};
      std::int64_t pairs;
      dyn_broad_phase_update(boxes, int(k % 40), lower, upper), dyn_broad_phase_pairs(boxes, nullptr, 0, &pairs);
    });
  }
  void solvers() {
    for (int j = 0; j < 12; ++j)
      for (int i = 0; i < 12; ++i) G[std::size_t(i + 12 * j)] = (i == j ? 1.0 : 0.0) + std::cos(i) * std::cos(j);
    EXPECT_EQ(DYN_OK, dyn_contact_solver_new(12, &solver));
    for (const dynContactSolverType type :
         {DYN_CONTACT_SOLVER_TYPE_PGS, DYN_CONTACT_SOLVER_TYPE_ADMM, DYN_CONTACT_SOLVER_TYPE_NEWTON})
      add("dyn_contact_solver_solve, solver " + std::to_string(type), [this, type](long k) {
        dynContactProblem p;
        dynContactOptions o;
        dynContactReport r{};
        dyn_contact_problem_init(&p), dyn_contact_options_init(&o);
        for (int i = 0; i < 12; ++i) g[std::size_t(i)] = std::sin(2.5 * i + double(k % 100)) - (i % 3 == 2);
        p.contacts = 4, p.G = G.data(), p.g = g.data(), p.friction = friction.data(), o.solver = type, r.struct_size = sizeof r;
        dyn_contact_solver_solve(solver, &p, &o, out.data(), nullptr, &r);
      }, 10);
  }
  // on one thread: waking others is a system call
  void batches() {
    batch = std::make_unique<Batch>(m, 1);
    for (int which = 0; which < batch_algorithms; ++which) {
      cases.push_back(std::make_unique<BatchCase>(m, which, 10));
      add(
          std::string("dyn_batch_run, ") + cases.back()->info.name, [this, which](long) { (*cases[std::size_t(which)])(*batch); },
          20);
    }
  }
  // with contacts, limits, constraints, actuators' torques, every solver and integrator of the scenes
  void steps() {
    for (const soak::Scene& scene : soak::scenes) {
      plays.push_back(std::make_unique<soak::Simulation>(scene));
      add(std::string("dyn_step, ") + scene.name, [play = plays.back().get()](long) {
        if (play->step() != DYN_OK) __builtin_trap();
      }, 20);
    }
  }

 public:
  RealtimeCalls(const RealtimeCalls&) = delete;
  ~RealtimeCalls() { dyn_broad_phase_free(boxes), dyn_contact_solver_free(solver); }
};

// Whether the monotonic clock is read without a system call, as by most kernels.
bool clock_needs_none() {
  const pid_t child = fork();
  if (child == 0) {
    timespec t;
    if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0) _exit(77);
    clock_gettime(CLOCK_MONOTONIC, &t);
    syscall(SYS_exit, 0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// Calls of each: `calls`, of those that cost more fewer in proportion.
void call_all(const std::vector<RealtimeCall>& all, long calls, bool sealed = true) {
  Note* const note = static_cast<Note*>(mmap(nullptr, sizeof(Note), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  ASSERT_NE(MAP_FAILED, static_cast<void*>(note));
  dyn_model_nq(nullptr);  // the thread's first error
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (sealed && prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0) _exit(77);
    for (const RealtimeCall& call : all) {
      std::snprintf(note->name, sizeof note->name, "%s", call.name.c_str());
      const long before = allocations, locked = locks;
      for (long k = 0; k < calls / call.cost; ++k) call.call(k), ++note->calls;
      note->allocations = allocations - before, note->locks = locks - locked;
      if (note->allocations || note->locks) syscall(SYS_exit, 1);
    }
    syscall(SYS_exit, 0);
  }
  int status = 0;
  ASSERT_EQ(child, waitpid(child, &status, 0));
  const Note found = *note;
  munmap(note, sizeof(Note));
  if (WIFEXITED(status) && WEXITSTATUS(status) == 77) GTEST_SKIP() << "no seccomp here";
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0)
      << found.name << ": " << found.allocations << " allocations, " << found.locks << " locks, "
      << (WIFSIGNALED(status) ? "a system call or crash" : "") << " (status " << status << ")";
  if (!testing::Test::HasFailure())
    std::printf("%zu entry points, %ld calls: 0 allocations and locks%s\n", all.size(), found.calls,
                sealed ? ", 0 system calls" : "");
}

TEST(HotCalls, NeitherAllocateNorLockNorCallTheSystem) {
  if (sanitized) GTEST_SKIP() << "sanitizers allocate and make system calls themselves";
  call_all(RealtimeCalls().all, 100000);
}

TEST(HotCalls, SlowAMillionOfEach) {
  if (sanitized) GTEST_SKIP() << "sanitizers allocate and make system calls themselves";
  RealtimeCalls every;
  for (RealtimeCall& h : every.all)
    h.cost = h.name.starts_with("dyn_batch_run") ? 10
             : h.name.starts_with("dyn_step, ")  ? 4
                                                 : 1;  // of ten states; of eight scenes
  call_all(every.all, 1000000);
}

// Steps that have a deadline read a clock: neither do they, where the kernel's clock is memory.
TEST(HotCalls, WithADeadline) {
  if (sanitized) GTEST_SKIP() << "sanitizers allocate and make system calls themselves";
  std::vector<std::unique_ptr<soak::Simulation>> plays;
  std::vector<RealtimeCall> all;
  for (const soak::Scene& scene : soak::scenes) {
    plays.push_back(std::make_unique<soak::Simulation>(scene));
    soak::Simulation* const play = plays.back().get();
    dynStepOptions o;
    dyn_step_options_init(&o);
    dyn_step_options_init(&o);
    ASSERT_EQ(DYN_OK, dyn_data_step_options(play->m, play->d, &o));
    o.time_budget = 1e-4;
    ASSERT_EQ(DYN_OK, dyn_data_set_step_options(play->m, play->d, &o));
    all.push_back({scene.name, [play](long) { play->step(); }, 1});
  }
  call_all(all, 2000, clock_needs_none());
}

}  // namespace
}  // namespace dyn_test
