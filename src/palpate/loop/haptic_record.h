#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/loop/contact_record.h"
#include "palpate/loop/run.h"
#include "palpate/store/table_file.h"

namespace palpate::loop {

/// What a hand did and felt, to the last bit: each tick, and each contact record that the ticks used.
struct HapticRecord {
  TickRecord start;  ///< of its fields the handle's alone, at the run's start
  std::vector<TickRecord> ticks;
  std::vector<dynamics::LinearisedContact> exchanges;
  std::vector<contact::TouchModel> models;  ///< of each exchange, where they have points; else empty
  device::PassivityController::Mode passivity = device::PassivityController::Mode::kOff;
};

/// Keeps one hand's HapticRecord in an HDF5 file (haptic.h5: tables "start" with the passivity mode, "ticks",
/// "exchanges", and where these have points "models" and "points"; one row each, columns by name).
class HapticRecorder : public Observer {
 public:
  /// @param hand  whose start it keeps; its ticks and exchanges are those that it is given
  /// @throws Error when the file cannot be made
  explicit HapticRecorder(const std::string& path, std::size_t hand = 0);
  /// With a journal beside it (store/table_file.h), from where that is.
  HapticRecorder(const std::string& path, std::size_t hand, const store::TableFile::Journal& from);
  store::TableFile::Journal place();
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

/// How a run's folder calls the records of a scene's hands: haptic.h5 the first's, haptic-NAME.h5 a further
/// one's.
std::vector<std::string> haptic_files(const scene::Description& description);
/// Of a run's folder, one for each hand of its scene.  @throws Error as read_haptic_record()
std::vector<HapticRecord> read_haptic_records(const std::string& folder,
                                              const scene::Description& description);

}  // namespace palpate::loop
