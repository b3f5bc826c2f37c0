#pragma once
#include <memory>
#include <string>

#include "palpate/loop/run.h"

namespace palpate::loop {

/// Records the data that the scene's [record] table specifies, in one folder:
/// - run.vtkhdf (VTKHDF time series of all bodies, bones and the tool) and, once it is closed, run.xdmf
/// (store/xdmf.h),
/// - bones.csv (pose of each bone and wrench of the tissue on it, one line per bone and recorded time),
/// - force.csv (one line per tick),
/// - haptic.h5 (each tick and exchange, bitwise, for replays),
/// - for each further hand, force-NAME.csv and haptic-NAME.h5,
/// - energy.csv (one line per period).
///
/// All periods on disk are complete: an interrupted run leaves valid files. A scene without [record] creates
/// no file.
class Recorder : public Observer {
 public:
  /// Creates the folder and the files.
  /// @param world  assembled scene  @param folder  folder of the results
  /// @throws Error if they cannot be written
  Recorder(const World& world, const std::string& folder);
  /// Recorder of a run with checkpoints.
  /// @param world  assembled scene  @param folder  folder of the results
  /// @param goes_on     whether the run is resumed: the files exist, and archive() truncates them to the
  /// checkpoint
  /// @param duration_s  duration of the run; 0: the scene's
  /// @throws Error if the folder or the files cannot be written
  Recorder(const World& world, const std::string& folder, bool goes_on, double duration_s);
  ~Recorder() override;
  /// Closes the state file. The destructor closes it too, but reports no disk error.
  /// @throws Error
  void close();
  void period(World& world, double t) override;
  void tick_of(std::size_t hand, const TickRecord& tick) override;
  void exchanged_of(std::size_t hand, const ContactRecord& record) override;
  bool wants_energy() const override;
  void energy(const EnergyBalance& balance) override;
  /// Writes or restores the positions in the files; all data recorded so far are on disk afterwards. @pre
  /// constructed for a run with checkpoints
  void archive(Archive& a) override;

 private:
  Recorder(const World& world, const std::string& folder, bool goes_on, double duration_s, bool resumable);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::loop
