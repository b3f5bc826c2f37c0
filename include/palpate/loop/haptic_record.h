#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/loop/run.h"

namespace palpate::loop {

/// What a hand did and felt, to the last bit: each tick, and each contact record that the ticks used.
struct HapticRecord {
  TickRecord start;  ///< of its fields the handle's alone, at the run's start
  std::vector<TickRecord> ticks;
  std::vector<dynamics::LinearisedContact> exchanges;
  std::vector<contact::TouchModel> models;  ///< of each exchange, where they have points; else empty
  device::PassivityController::Mode passivity = device::PassivityController::Mode::kOff;
};

/// Keeps a HapticRecord in an HDF5 file (haptic.h5: tables "start" with the passivity mode, "ticks",
/// "exchanges", and where these have points "models" and "points"; one row each, columns by name).
class HapticRecorder : public Observer {
 public:
  /// @throws Error when the file cannot be made
  explicit HapticRecorder(const std::string& path);
  ~HapticRecorder() override;
  void period(World& world, double t) override;
  void tick(const TickRecord& tick) override;
  void exchanged(const ContactRecord& record) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// @throws Error for a file that is none of HapticRecorder's
HapticRecord read_haptic_record(const std::string& path);

}  // namespace palpate::loop
