// Prints the torques that hold an arm.
#include <dyn.h>

#include "gravity.h"

void setup() {
  Serial.begin(115200);
  if (gravity_begin()) Serial.println(dyn_last_error());
}

void loop() {
  const double q[GRAVITY_JOINTS] = {0, 0.5, 0, -1.5, 0, 2, 0.8, 0.02};
  double tau[GRAVITY_JOINTS];
  if (gravity_torques(q, tau)) Serial.println(dyn_last_error());
  else Serial.println(tau[1], 6);
  delay(1000);
}
