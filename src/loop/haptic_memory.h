#pragma once
#include "loop/haptic_record.h"

namespace palpate::loop {

/// Observer that keeps the ticks of all hands in memory, as HapticRecorder does in files; without exchanges.
class HapticMemory : public Observer {
 public:
  void period(World& world, double t) override;
  void tick_of(std::size_t hand, const TickRecord& tick) override { records_[hand].ticks.push_back(tick); }
  const std::vector<HapticRecord>& records() const { return records_; }

 private:
  std::vector<HapticRecord> records_;
};

}  // namespace palpate::loop
