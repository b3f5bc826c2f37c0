#pragma once
#include <array>
#include <optional>

#include "palpate/loop/contact_record.h"
#include "palpate/loop/run.h"
#include "tool_side.h"

namespace palpate::loop {

/// A hand's side of an exchange, a tick at a time: device, virtual coupling, tool, limits, passivity.  It
/// knows no World: of the bodies it has the linearised contact alone, so that it may run in a thread of its
/// own.
class TickSide {
 public:
  /// @param side  the tool, the device and the limiter in it are this object's alone while a run lasts
  /// @param laws  of contact points; null: no record has any
  TickSide(const ToolSpec& spec, ToolSide& side, const std::vector<ContactSpec>* laws = nullptr);
  /// The same for a scene.
  TickSide(const scene::Description& description, ToolSide& side);
  /// No wrench on the hand any more, however the run ended.
  ~TickSide();
  TickSide(const TickSide&) = delete;
  TickSide& operator=(const TickSide&) = delete;
  /// Takes the handle at the run's start.
  void start(double t);
  /// Begins the tick of length h to t: samples the handle, and takes the contact with bodies, the record's
  /// own or what its points come to then.
  void begin_tick(double t, double h, const ContactRecord& record);
  const dynamics::LinearisedContact& contact_with_bodies() const { return of_bodies_; }
  /// Whether that has friction of the tick's end (contact/friction.h), found by repeated solves.
  bool rubs() const;
  /// The tool's step in the tick under way, under coupling and that contact.
  tool::StepEquation equation(double h, const dynamics::LinearisedContact& contact) const;
  /// Takes the end to which that step leads for the next guess of friction.  False: friction is not the law's
  /// at that end.
  bool improve(double h, const Vec6& change);
  /// The contact with bodies, about that guess.
  void again();
  const ToolSide& side() const { return side_; }
  /// No wrench went out for too long: that of the next tick ramps in from zero.
  void ramp_in() { ramps_in_ = true; }
  /// The tool goes on by h to t under coupling and that contact; the wrench goes to the device.
  dynamics::StepResult tick(double t, double h, const dynamics::LinearisedContact& contact, TickRecord& out);
  /// The wrench on the hand for `tick`'s time and tool, to the device; a hand that is a part of the State
  /// stands in `tick`.
  void feel(TickRecord& tick);
  /// No wrench on the hand any more.
  void end();
  /// Between two ticks; the ToolSide stands in the archive by itself.  What gives back takes the place of
  /// start().
  void archive(Archive& a);

 private:
  tool::HandleMotion handle_motion() const;
  /// With the handle as it is.
  void feel_at(TickRecord& tick);

  /// Where the tool was at the end of a tick.
  struct Past {
    double time = -1.0, length = 0.0;
    dynamics::RigidMotion tool;
  };
  /// A record is of an instant that is over: its bodies follow the tool from there on.
  void take_up(const ContactRecord& record);

  const ToolSpec& spec_;
  ToolSide& side_;
  device::HandleSample handle_;
  std::optional<device::HandleSample> next_;  ///< of the tick under way
  dynamics::LinearisedContact of_bodies_;     ///< in it
  double time_ = 0.0;                         ///< of the last tick [s]
  bool live_ = false;                         ///< the hand may feel a wrench
  bool ramps_in_ = false;                     ///< from the next tick on
  std::optional<contact::TouchTicks> touch_;  ///< where records have points
  std::uint64_t taken_up_ = 0;                ///< version of the record in `touch_`
  std::array<Past, 256> past_{};              ///< a ring: ticks that a record may be late by
  std::size_t ticks_ = 0;
};

}  // namespace palpate::loop
