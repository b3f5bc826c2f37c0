#ifndef PALPATE_DEVICE_PLUGIN_H
#define PALPATE_DEVICE_PLUGIN_H
/**
 * C interface of a device driver in a shared object, `[device] type = "plugin"`. This header needs no other
 * header of palpate; a driver links nothing of palpate:
 *
 *     cc -shared -fPIC -I FOLDER/include driver.c -o driver.so
 *
 * All quantities are in SI units and in the scene's axes (right-handed). Functions that can fail return NULL,
 * or a text that says what failed; the text must stay valid until the next call. All calls of one device come
 * one after the other, but not from one thread: `specification` and `open` from the thread that loads the
 * scene, `sample` and `feedback` from the thread of the haptic ticks.
 */
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Version of this interface. A driver of another version is rejected. */
#define PALPATE_PLUGIN_VERSION 1u

/** Capabilities of the device. 0: not stated; the scene's keys take precedence. */
typedef struct PalpatePluginSpecification {
  char name[64];            /**< Name for display, ending in 0; required. */
  double max_force_n;       /**< Peak force [N]. */
  double max_torque_n_m;    /**< Peak torque [N m]; negative: the device drives no torque. */
  double max_stiffness_n_m; /**< Stiffest virtual wall that the device renders [N/m]. */
  double workspace_m[3];    /**< Extents of a box about `workspace_center_m` of the scene [m]. */
  uint32_t real_time;       /**< 1: a person moves it, the run must be in real time; 0: a simulated device. */
  uint32_t no_velocity;     /**< 1: `sample` writes no velocities, and palpate derives them from the poses. */
} PalpatePluginSpecification;

/** State of the handle. */
typedef struct PalpatePluginSample {
  double position_m[3];             /**< Position of the handle's origin [m]. */
  double rotation_wxyz[4];          /**< Unit quaternion, from the handle's axes to the scene's. */
  double linear_velocity_m_s[3];    /**< Velocity of the origin [m/s], unless `no_velocity` is set. */
  double angular_velocity_rad_s[3]; /**< Angular velocity [rad/s], unless `no_velocity` is set. */
  uint32_t switches;                /**< Bit i is 1 while switch i is pressed. */
  uint32_t valid;                   /**< 0: no new pose arrived; the force falls to zero within 20 ms. */
} PalpatePluginSample;

/** Wrench on the hand, within the limits of the device. */
typedef struct PalpatePluginWrench {
  double force_n[3];    /**< Force [N]. */
  double torque_n_m[3]; /**< Moment about the handle's origin [N m]. */
} PalpatePluginWrench;

/** Table of a driver: the one symbol that it exports, by the name `palpate_device_plugin`. */
typedef struct PalpatePlugin {
  uint32_t version;            /**< PALPATE_PLUGIN_VERSION. */
  uint32_t table_size;         /**< sizeof(PalpatePlugin). */
  uint32_t specification_size; /**< sizeof(PalpatePluginSpecification). */
  uint32_t sample_size;        /**< sizeof(PalpatePluginSample). */
  uint32_t wrench_size;        /**< sizeof(PalpatePluginWrench). */
  uint32_t reserved;           /**< 0. */
  /** Writes the capabilities; called before `open`, with `out` all zero. */
  const char* (*specification)(const char* options, PalpatePluginSpecification* out);
  /** Opens the device. `options` is the scene's `library_options`; `device` receives the driver's state. */
  const char* (*open)(const char* options, void** device);
  /** Writes the state of the handle at time t [s], without waiting. `out` has the last sample; a time may be
   * repeated, and is then answered by the same sample. */
  const char* (*sample)(void* device, double time_s, PalpatePluginSample* out);
  /** Sends a wrench to the motors, until the next call; the last call before `close` has zeros. NULL: the
   * device has no motors. */
  const char* (*feedback)(void* device, double time_s, const PalpatePluginWrench* on_hand);
  /** Switches the motors off and releases `device`. Called once per `open` that succeeded. */
  void (*close)(void* device);
} PalpatePlugin;

#ifdef __cplusplus
#define PALPATE_PLUGIN_EXPORT extern "C" __attribute__((visibility("default")))
#else
#define PALPATE_PLUGIN_EXPORT __attribute__((visibility("default")))
#endif

/** Defines the table of a driver from its five functions. */
#define PALPATE_DEVICE_PLUGIN(specification, open, sample, feedback, close)        \
  PALPATE_PLUGIN_EXPORT const PalpatePlugin palpate_device_plugin;                 \
  const PalpatePlugin palpate_device_plugin = {PALPATE_PLUGIN_VERSION,             \
                                               sizeof(PalpatePlugin),              \
                                               sizeof(PalpatePluginSpecification), \
                                               sizeof(PalpatePluginSample),        \
                                               sizeof(PalpatePluginWrench),        \
                                               0u,                                 \
                                               specification,                      \
                                               open,                               \
                                               sample,                             \
                                               feedback,                           \
                                               close}

#ifdef __cplusplus
}
#endif
#endif
