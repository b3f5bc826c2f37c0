#pragma once
#include "palpate/loop/run.h"
#include "tool_side.h"

namespace palpate::loop {

/// The hand's side of an exchange, a tick at a time: device, virtual coupling, tool, limits, passivity.  It
/// knows no World: of the bodies it has the linearised contact alone, so that it may run in a thread of its
/// own.
class TickSide {
 public:
  /// @param side  the tool, the device and the limiter in it are this object's alone while a run lasts
  TickSide(const ToolSpec& spec, ToolSide& side);
  /// No wrench on the hand any more, however the run ended.
  ~TickSide();
  TickSide(const TickSide&) = delete;
  TickSide& operator=(const TickSide&) = delete;
  /// Takes the handle at the run's start.
  void start(double t);
  /// The tool goes on by h to t under coupling and contact; the wrench goes to the device.
  dynamics::StepResult tick(double t, double h, const dynamics::LinearisedContact& record, TickRecord& out);
  /// The wrench on the hand for `tick`'s time and tool, to the device.
  void feel(TickRecord& tick);
  /// No wrench on the hand any more.
  void end();

 private:
  /// With the handle as it is.
  void feel_at(TickRecord& tick);

  const ToolSpec& spec_;
  ToolSide& side_;
  device::HandleSample handle_;
  double time_ = 0.0;  ///< of the last tick [s]
  bool live_ = false;  ///< the hand may feel a wrench
};

}  // namespace palpate::loop
