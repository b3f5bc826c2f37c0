#pragma once
#include "palpate/loop/haptic_record.h"

namespace palpate::loop {

/// Keeps the ticks of a run in memory, as HapticRecorder keeps them in a file; no exchanges.
class HapticMemory : public Observer {
 public:
  void period(World& world, double t) override;
  void tick(const TickRecord& tick) override { record_.ticks.push_back(tick); }
  const HapticRecord& record() const { return record_; }

 private:
  HapticRecord record_;
};

}  // namespace palpate::loop
