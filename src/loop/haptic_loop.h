#pragma once
#include <array>
#include <optional>

#include "loop/contact_record.h"
#include "palpate/loop/observer.h"
#include "palpate/scene/description.h"
#include "tool_instance.h"

namespace palpate::loop {

/// Hand's side of an exchange, advanced tick by tick: device, virtual coupling, tool, limiter, passivity
/// controller. It does not access the World: its only information about the bodies is the contact record, so
/// that it may run in a separate thread.
class HapticLoop {
 public:
  /// @param tool  its PartitionedTool::tool, device and limiter are used by this object alone during a run
  /// @param laws  contact laws for contact points; null: records have no points
  explicit HapticLoop(ToolInstance& tool, const std::vector<ContactSpec>* laws = nullptr);
  /// Builds the tick side of a scene's tool.
  HapticLoop(const scene::Description& description, ToolInstance& tool);
  /// Sets the wrench on the hand to zero, however the run ended.
  ~HapticLoop();
  HapticLoop(const HapticLoop&) = delete;
  HapticLoop& operator=(const HapticLoop&) = delete;
  /// Samples the handle at the start of the run.
  void start(double t);
  /// Begins the tick of length h that ends at t: samples the handle, and takes the contact with bodies from
  /// the record, or computes it from the record's points.
  void begin_tick(double t, double h, const ContactRecord& record);
  const dynamics::LinearisedContact& contact_with_bodies() const { return of_bodies_; }
  /// Returns whether that contact has friction evaluated at the end of the tick (contact/friction.h), by
  /// repeated solves.
  bool has_friction() const;
  /// Returns the equation of the tool's step in the current tick, under coupling and that contact.
  tool::StepEquation equation(double h, const dynamics::LinearisedContact& contact) const;
  /// Updates friction from the end of the step with that change of the twist. Returns false if friction does
  /// not yet satisfy its law there.
  bool update_friction(double h, const Vec6& change);
  /// Linearises contact with bodies with the updated friction.
  void relinearise();
  /// Returns the tool. @pre the scheme is partitioned
  const PartitionedTool& partitioned_tool() const { return *partitioned_; }
  /// Makes the wrench of the next tick ramp in from zero, after too long a gap without a wrench.
  void ramp_in() { ramps_in_ = true; }
  /// Advances the tool by h to t under coupling and that contact, and sends the wrench to the device.
  dynamics::StepResult tick(double t, double h, const dynamics::LinearisedContact& contact, TickRecord& out);
  /// Begins a step of tools and bodies as one system, from t0 to t1: samples the handle at t1, and passes its
  /// motion to the coupling in the State. @pre the scheme is single-rate
  void begin_step(double t0, double t1);
  /// Computes the wrench on the hand at the time and tool of `tick` and sends it to the device; a hand in the
  /// State is read from `tick`, a device sampled unless begin_step() did so.
  void render_force(TickRecord& tick);
  /// Sets the wrench on the hand to zero.
  void end();
  /// Writes or restores the state between two ticks; the ToolInstance is archived separately. Restoring
  /// replaces start().
  void archive(Archive& a);

 private:
  tool::HandleMotion handle_motion() const;
  bool hand_in_state() const;
  void hold_handle();
  /// Computes and sends the wrench for the current handle sample.
  void send_wrench(TickRecord& tick);

  /// Motion of the tool at the end of a past tick.
  struct Past {
    double time = -1.0, length = 0.0;
    dynamics::RigidMotion tool;
  };
  /// Adopts the reduced model of a new record. Its time has passed, so the bodies are advanced along the
  /// tool's path since then.
  void adopt_model(const ContactRecord& record);

  ToolInstance& tool_;
  PartitionedTool* const partitioned_;  ///< Null for the monolithic scheme.
  device::HandleSample handle_;
  std::optional<device::HandleSample> next_;             ///< Sample of the current tick.
  dynamics::LinearisedContact of_bodies_;                ///< In the current tick.
  double time_ = 0.0;                                    ///< Time of the last tick [s].
  bool live_ = false;                                    ///< The hand may be under a wrench.
  bool ramps_in_ = false;                                ///< From the next tick on.
  std::optional<contact::ReducedContactStepper> touch_;  ///< Only if records have points.
  std::uint64_t active_version_ = 0;                     ///< Version of the record in `touch_`
  std::array<Past, 256> past_{};  ///< Ring buffer; bounds the latency of a record in ticks.
  std::size_t count_ = 0;         ///< Number of ticks.
};

}  // namespace palpate::loop
