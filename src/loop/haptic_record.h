#pragma once
#include <memory>
#include <string>
#include <vector>

#include "loop/contact_record.h"
#include "palpate/loop/run.h"
#include "store/table_file.h"

namespace palpate::loop {

/// Bitwise record of one hand: each tick, and each contact record that the ticks used.
struct HapticRecord {
  TickRecord start;               ///< State of the handle at the start of the run; other fields are unset.
  std::vector<TickRecord> ticks;  ///< Ticks in order of time.
  std::vector<dynamics::LinearisedContact> exchanges;  ///< Contact records, versions 1, 2, ...
  /// Reduced model per exchange, if exchanges have points; else empty.
  std::vector<contact::ReducedContactModel> models;
  /// Mode of the run.
  device::PassivityController::Mode passivity = device::PassivityController::Mode::kOff;
};

/// Observer that writes the HapticRecord of one hand to an HDF5 file (haptic.h5: tables "start" with the
/// passivity mode, "ticks", "exchanges", and, if exchanges have points, "models" and "points"; one row per
/// entry, columns by name).
class HapticRecorder : public Observer {
 public:
  /// @param hand  hand whose initial state is recorded; the caller passes only the ticks and exchanges of
  /// this hand
  /// @throws Error if the file cannot be created
  explicit HapticRecorder(const std::string& path, std::size_t hand = 0);
  /// Recorder with a journal next to the file (store/table_file.h), continued from `from`.
  HapticRecorder(const std::string& path, std::size_t hand, const store::TableFile::Journal& from);
  /// Returns the current position in the journal.
  store::TableFile::Journal place();
  ~HapticRecorder() override;
  void period(World& world, double t) override;
  void tick(const TickRecord& tick) override;
  void exchanged(const ContactRecord& record) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads one record.  @throws Error for a file that was not written by HapticRecorder
HapticRecord read_haptic_record(const std::string& path);

/// Returns the file names of the hands' records in a results folder: haptic.h5 for the first, haptic-NAME.h5
/// for a further one.
std::vector<std::string> haptic_files(const scene::Description& description);
/// Reads the records of a results folder, one per hand of its scene.  @throws Error as read_haptic_record()
std::vector<HapticRecord> read_haptic_records(const std::string& folder,
                                              const scene::Description& description);

}  // namespace palpate::loop
