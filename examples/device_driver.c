/* Driver of a haptic device in a shared object: a simulated device with one axis. Its handle, a mass on a
 * spring about a target that goes up and down at 1 Hz, yields to the force on it. A driver of real hardware
 * reads encoders in `sample` and writes motor currents in `feedback`. */
#include <math.h>
#include <stdlib.h>

#include "palpate/device/plugin.h"

typedef struct {
  double center, amplitude; /* of the target along z [m] */
  double time, z, v, force; /* of the handle [s, m, m/s], and on it [N] */
} Handle;

static const char* specification(const char* options, PalpatePluginSpecification* out) {
  (void)options;
  const char name[] = "one-axis device";
  for (unsigned i = 0; i < sizeof name; ++i) out->name[i] = name[i];
  out->max_force_n = 5.0;
  out->max_torque_n_m = -1.0; /* none */
  out->real_time = 0;         /* simulated: runs in virtual time, too */
  return 0;
}

static const char* open_device(const char* options, void** device) {
  Handle* handle = calloc(1, sizeof *handle);
  if (!handle) return "no memory";
  char* end = 0;
  handle->z = handle->center = strtod(options, &end);
  handle->amplitude = 0.01;
  if (end == options) return free(handle), "options must be the height of the handle [m]";
  *device = handle;
  return 0;
}

static const char* sample(void* device, double t, PalpatePluginSample* out) {
  Handle* h = device;
  const double mass = 0.1, stiffness = 500.0, damping = 5.0, step = 1e-4;
  for (; h->time < t - 0.5 * step; h->time += step) { /* semi-implicit Euler */
    const double target = h->center - h->amplitude * sin(2.0 * 3.14159265358979 * h->time);
    h->v += step * (stiffness * (target - h->z) - damping * h->v + h->force) / mass;
    h->z += step * h->v;
  }
  out->position_m[2] = h->z;
  out->linear_velocity_m_s[2] = h->v;
  out->rotation_wxyz[0] = 1.0;
  out->valid = 1;
  return 0;
}

static const char* feedback(void* device, double t, const PalpatePluginWrench* on_hand) {
  (void)t;
  ((Handle*)device)->force = on_hand->force_n[2];
  return 0;
}

static void close_device(void* device) { free(device); }

PALPATE_DEVICE_PLUGIN(specification, open_device, sample, feedback, close_device);
