/* Prints the torque that holds an arm's second joint. */
#include <zephyr/kernel.h>
#include <zephyr/sys/printk.h>

#include "gravity.h"

int main(void) {
  const double q[GRAVITY_JOINTS] = {0, 0.5, 0, -1.5, 0, 2, 0.8, 0.02};
  double tau[GRAVITY_JOINTS];
  if (gravity_begin() || gravity_torques(q, tau)) printk("%s\n", dyn_last_error());
  else printk("tau[1] = %d mN m\n", (int)(1000 * tau[1]));
  return 0;
}
