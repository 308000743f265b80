// A quadruped's stance, a cycle each millisecond, by the timer's interrupt, with the plant of ground.c. The run is a test: it ends
// with 0 when the trunk followed a squat, went on through a push and a short fault, with forces that ground can give, and stopped at
// a lasting fault.
#include <cmath>
#include <cstdint>

#include "board.hpp"
#include "cycle_timer.hpp"
#include "ground.h"

extern "C" const unsigned char quadruped[];  // quadruped.c, by `dyn convert`
extern "C" const size_t quadruped_size;
extern "C" void SysTick_Handler();

namespace {

constexpr double h = 1e-3;
// cycles: standing, then a squat, again and again; a push; readings are no numbers for a while, and later for good
constexpr int motion = 300, push_begins = 800, push_ends = 900, fault = 1300, fault_cycles = 5, lasting_fault = 1500, last = 1550;
constexpr double push[3] = {10, 30, 0}, no_push[3] = {};  // N
constexpr double friction = 0.6;                           // that the ground gives

alignas(64) char control_memory[256 * 1024], ground_memory[256 * 1024];
Stance stance;
Ground ground;
volatile int cycle = 0;
int stopped_at = 0;
CycleTimer timer;  // of stance_cycle
double error = 0, pushed = 0, least_weight = HUGE_VAL, most_slope = 0;  // m; N; tangential over normal force
dynStatus ground_status = DYN_OK;

// Thighs at an angle of first + size (1 - cos(w t)), calves at minus twice that: feet stay below the hips, and the trunk is
// 2 length cos(angle) above them. cos and sin of w t by turns of a phase.
struct Squat {
  static constexpr double length = 0.213, foot = 0.022, first = 0.75, size = 0.1, w = 5;
  double c = 1, s = 0;
  void advance() {
    constexpr double cos_wh = 0.99998750002604164, sin_wh = 0.0049999791666927084;
    const double next = c * cos_wh - s * sin_wh;
    s = s * cos_wh + c * sin_wh, c = next;
  }
  StanceTarget target() const {
    const double angle = first + size * (1 - c), rate = size * w * s, growth = size * w * w * c;
    const double cosine = std::cos(angle), sine = std::sin(angle);
    StanceTarget x = {};
    x.q[2] = foot + 2 * length * cosine, x.q[6] = 1;
    x.v[2] = -2 * length * sine * rate, x.a[2] = -2 * length * (cosine * rate * rate + sine * growth);
    for (int leg = 0; leg < STANCE_FEET; ++leg) {
      double *const q = x.q + 7 + 3 * leg, *const v = x.v + 6 + 3 * leg, *const a = x.a + 6 + 3 * leg;
      q[1] = angle, v[1] = rate, a[1] = growth;
      q[2] = -2 * angle, v[2] = -2 * rate, a[2] = -2 * growth;
    }
    return x;
  }
} squat;

double distance(const double* a, const double* b) {
  return std::sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

}  // namespace

void SysTick_Handler() {
  const int n = cycle;
  if (n >= last) return;
  timer.enter();
  double q[STANCE_NQ], v[STANCE_NV], tau[STANCE_MOTORS];
  for (int k = 0; k < STANCE_NQ; ++k) q[k] = ground.q[k];
  for (int k = 0; k < STANCE_NV; ++k) v[k] = ground.v[k];
  const StanceTarget target = squat.target();
  const double off = distance(target.q, q);
  if (n >= push_begins && n < fault) pushed = std::fmax(pushed, off);
  else if (n < push_begins) error = std::fmax(error, off);
  if ((n >= fault && n < fault + fault_cycles) || n >= lasting_fault) q[8] = __builtin_nan("");
  timer.begin();
  stance_cycle(&stance, q, v, &target, tau);
  timer.end();
  if (timer.late) stance_failed(&stance, tau);
  if (stance.watchdog.stopped && !stopped_at) stopped_at = n;

  if (!stance.watchdog.stopped && !ground_status) {  // drives; stopped: brakes
    ground_status = ground_step(&ground, tau, n >= push_begins && n < push_ends ? push : no_push, h);
    for (int foot = 0; foot < STANCE_FEET; ++foot) {
      const double* const f = ground.forces + 3 * foot;
      least_weight = std::fmin(least_weight, f[2]), most_slope = std::fmax(most_slope, std::sqrt(f[0] * f[0] + f[1] * f[1]) / f[2]);
    }
  }
  if (n >= motion) squat.advance();
  cycle = n + 1;
}

int board::program() {
  const dynModel* model = nullptr;
  const StanceTarget begin = squat.target();
  if (dyn_model_from_buffer(quadruped, quadruped_size, &model) ||
      stance_begin(&stance, model, begin.q, control_memory, sizeof control_memory) ||
      ground_begin(&ground, model, begin.q, ground_memory, sizeof ground_memory))
    return print(dyn_last_error()), print("\n"), 1;
  timer.start();
  while (cycle < last) __asm volatile("wfi");  // a product feeds its hardware watchdog here, when cycle has grown
  print("  stance: largest error of the trunk "), print(std::uint64_t(error * 1e6)), print("e-6 m, pushed ");
  print(std::uint64_t(pushed * 1e6)), print("e-6 m\n  feet: at least "), print(std::uint64_t(least_weight)), print(" N each, at most ");
  print(std::uint64_t(most_slope * 1e3)), print("e-3 of it along the ground\n  stopped after ");
  print(std::uint64_t(stopped_at - lasting_fault + 1)), print(" failed cycles: "), print(dyn_last_error());
  print("\n  worst cycle "), print(timer.worst_instructions()), print(" instructions, stack "), print(std::uint64_t(stack_used()));
  print(" bytes, data "), print(std::uint64_t(dyn_data_size(model, DYN_PART_CONSTRAINTS | DYN_PART_INVERSE))), print(" bytes\n");
  const bool stopped = stopped_at == lasting_fault + WATCHDOG_MAX_FAILURES, held = least_weight > 0 && most_slope < friction;
  const bool good = !ground_status && error < 2e-3 && pushed < 1e-2 && held && stopped;
  print(good ? "  passed\n" : "  failed\n");
  return good ? 0 : 1;
}
