/* Driver for tests: sound where no FAULT_ is defined, with the behaviour that its options name. */
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "palpate/device/plugin.h"

static char behaviour[32];
static double last_force[3];
static int open_count;

static const char* specification(const char* options, PalpatePluginSpecification* out) {
  strncpy(behaviour, options, sizeof behaviour - 1);
  if (strcmp(behaviour, "nameless") != 0) strcpy(out->name, "test driver");
  if (strcmp(behaviour, "long name") == 0) memset(out->name, 'x', sizeof out->name);
  if (strcmp(behaviour, "stated") == 0) {
    out->max_force_n = 8.0;
    out->max_torque_n_m = -1.0;
    out->max_stiffness_n_m = 4000.0;
    for (int i = 0; i < 3; ++i) out->workspace_m[i] = 0.1 * (i + 1);
  }
  if (strcmp(behaviour, "bad figure") == 0) out->max_force_n = -2.0;
  if (strcmp(behaviour, "no specification") == 0) return "firmware 1.2 is too old";
  out->real_time = strcmp(behaviour, "live") == 0;
  out->no_velocity = strcmp(behaviour, "no velocity") == 0;
  return NULL;
}

static void* fault_in_thread(void* unused) {
  (void)unused;
  *(volatile int*)8 = 1;
  return NULL;
}

static const char* open_device(const char* options, void** device) {
  if (strcmp(options, "no device") == 0) return "no device on port 7\n(\033[1mcable?)";
  if (strcmp(options, "crash thread") == 0) {
    pthread_t thread;
    pthread_create(&thread, NULL, fault_in_thread, NULL);
    pthread_join(thread, NULL);
  }
  ++open_count;
  *device = &open_count;
  return NULL;
}

/* x(t) = t/10; y, z: the last force's x and the number of open devices. */
static const char* sample(void* device, double t, PalpatePluginSample* out) {
  if (strcmp(behaviour, "crash") == 0 && t > 0.0) *(volatile int*)8 = 1;
  if (strcmp(behaviour, "abort") == 0) abort();
  if (strcmp(behaviour, "unplugged") == 0 && t > 0.0) return "unplugged";
  out->position_m[0] = 0.1 * t;
  out->position_m[1] = last_force[0];
  out->position_m[2] = *(int*)device;
  out->rotation_wxyz[0] = 1.0;
  out->linear_velocity_m_s[0] = 0.1;
  out->angular_velocity_rad_s[2] = 0.2;
  out->switches = 5;
  out->valid = strcmp(behaviour, "silent") != 0;
  if (strcmp(behaviour, "nan") == 0 && t > 0.0) out->position_m[1] = NAN;
  if (strcmp(behaviour, "no rotation") == 0) out->rotation_wxyz[0] = 0.0;
  return NULL;
}

static const char* feedback(void* device, double t, const PalpatePluginWrench* on_hand) {
  (void)device, (void)t;
  memcpy(last_force, on_hand->force_n, sizeof last_force);
  return NULL;
}

static void close_device(void* device) { --*(int*)device; }

#if defined(FAULT_SYMBOL)
int unrelated_symbol = 0;
int use_all(void) {
  return specification(0, 0) || open_device(0, 0) || sample(0, 0, 0) || feedback(0, 0, 0) ||
         (close_device(0), 0);
}
#elif defined(FAULT_VERSION)
#undef PALPATE_PLUGIN_VERSION
#define PALPATE_PLUGIN_VERSION 7u
PALPATE_DEVICE_PLUGIN(specification, open_device, sample, feedback, close_device);
#elif defined(FAULT_SIZE)
PALPATE_PLUGIN_EXPORT const PalpatePlugin palpate_device_plugin;
const PalpatePlugin palpate_device_plugin = {
    PALPATE_PLUGIN_VERSION, sizeof(PalpatePlugin), sizeof(PalpatePluginSpecification), 100u,
    sizeof(PalpatePluginWrench), 0u, specification, open_device, sample, feedback, close_device};
#elif defined(FAULT_FUNCTION)
PALPATE_DEVICE_PLUGIN(specification, open_device, NULL, feedback, close_device);
const void* use_sample(void) { return (const void*)sample; }
#else
PALPATE_DEVICE_PLUGIN(specification, open_device, sample, feedback, close_device);
#endif
