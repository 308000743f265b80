// The board's part: a cycle each millisecond, by the timer's interrupt. Here QEMU's mps2-an500 (a Cortex-M7 of 25 MHz), with the
// plant of plant.c. The run is a test: it ends with 0 when the arm followed, held through a short fault, and stopped at a lasting
// one.
#include <cmath>
#include <cstdint>

#include "board.hpp"
#include "cycle_timer.hpp"
#include "plant.h"

extern "C" const unsigned char arm[];  // arm.c, by `dyn convert`
extern "C" const size_t arm_size;
extern "C" void SysTick_Handler();

namespace {

constexpr double h = 1e-3;
constexpr int joints = CONTROL_JOINTS;
// cycles: gravity compensation, then a motion; readings are no numbers for a while, and later for good
constexpr int motion = 500, fault = 2000, fault_cycles = 5, lasting_fault = 2500, last = 2600;

alignas(64) char control_memory[8192], plant_memory[16384];
Control control;
Plant plant;
volatile int cycle = 0;
int stopped_at = 0;
CycleTimer timer;  // of control_cycle
double drift = 0, error = 0, held = 0;  // rad/s, rad; N m
dynStatus plant_status = DYN_OK;

// The motion: 0.4 (1 - cos(w t)) rad on each joint, a fortieth of it on the finger. cos and sin by turns of a phase.
struct Phase {
  double c = 1, s = 0;
  void advance() {
    constexpr double cos_wh = 0.9999980000006667, sin_wh = 0.0019999986666669333;
    const double next = c * cos_wh - s * sin_wh;
    s = s * cos_wh + c * sin_wh, c = next;
  }
  Target target() const {
    constexpr double w = 2;
    Target x;
    for (int k = 0; k < joints; ++k) {
      const double size = k < 7 ? 0.4 : 0.01;
      x.q[k] = size * (1 - c), x.v[k] = size * w * s, x.a[k] = size * w * w * c;
    }
    return x;
  }
} phase;

double largest(const double* x) {
  double m = 0;
  for (int k = 0; k < joints; ++k) m = std::fmax(m, std::fabs(x[k]));
  return m;
}

}  // namespace

void SysTick_Handler() {
  const int n = cycle;
  if (n >= last) return;
  timer.enter();
  double q[joints], v[joints], tau[joints];
  for (int k = 0; k < joints; ++k) q[k] = plant.q[k], v[k] = plant.v[k];  // encoders
  const Target target = phase.target();
  if (n >= motion + 500 && n < fault)
    for (int k = 0; k < joints; ++k) error = std::fmax(error, std::fabs(target.q[k] - q[k]));
  if ((n >= fault && n < fault + fault_cycles) || n >= lasting_fault) q[3] = __builtin_nan("");
  timer.begin();
  control_cycle(&control, q, v, n < motion ? nullptr : &target, tau);
  timer.end();
  if (timer.late) control_failed(&control, tau);
  if (control.watchdog.stopped && !stopped_at) stopped_at = n;

  if (!control.watchdog.stopped && !plant_status) plant_status = plant_step(&plant, tau, h);  // drives; stopped: brakes
  if (n < motion) drift = std::fmax(drift, largest(plant.v)), held = largest(tau);
  else phase.advance();
  cycle = n + 1;
}

int board::program() {
  if (control_begin(&control, arm, arm_size, control_memory, sizeof control_memory) ||
      plant_begin(&plant, control.model, plant_memory, sizeof plant_memory))
    return print(dyn_last_error()), print("\n"), 1;
  timer.start();
  while (cycle < last) __asm volatile("wfi");  // a product feeds its hardware watchdog here, when cycle has grown
  print("  gravity compensation: "), print(std::uint64_t(held * 1e3)), print(" mN m, largest velocity ");
  print(std::uint64_t(drift * 1e18)), print("e-18 rad/s\n");
  print("  computed torque: largest error "), print(std::uint64_t(error * 1e9)), print("e-9 rad\n");
  print("  stopped after "), print(std::uint64_t(stopped_at - lasting_fault + 1)), print(" failed cycles: ");
  print(dyn_last_error()), print("\n  worst cycle "), print(timer.worst_instructions()), print(" instructions, stack ");
  print(std::uint64_t(stack_used())), print(" bytes\n");
  const bool stopped = stopped_at == lasting_fault + WATCHDOG_MAX_FAILURES;
  const bool good = !plant_status && drift < 1e-9 && held > 1 && error < 2e-3 && stopped;
  print(good ? "  passed\n" : "  failed\n");
  return good ? 0 : 1;
}
