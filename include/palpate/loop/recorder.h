#pragma once
#include <memory>
#include <string>

#include "palpate/loop/run.h"

namespace palpate::loop {

/// Keeps what the scene's [record] table asks for, in one folder: run.vtkhdf (VTKHDF time series of all
/// bodies, bones and the tool) and, once that is closed, run.xdmf (store/xdmf.h), bones.csv (pose of each
/// bone and wrench of the tissue on it, a line a bone and recorded instant), force.csv (a line a tick),
/// haptic.h5 (each tick and exchange to the last bit, for replays), both of a further hand force-NAME.csv and
/// haptic-NAME.h5, energy.csv (a line a period).  Every period on disk is complete: an interrupted run leaves
/// valid files.  A scene without [record] gets no file.
class Recorder : public Observer {
 public:
  /// Creates the folder and the files.  @throws Error when they cannot be written
  Recorder(const World& world, const std::string& folder);
  /// Of a run with checkpoints.
  /// @param world, folder  as above
  /// @param goes_on     the files are there, and are cut back to the checkpoint when archive() gives back
  /// @param duration_s  of the run; 0: the scene's
  Recorder(const World& world, const std::string& folder, bool goes_on, double duration_s);
  ~Recorder() override;
  /// Ends the file of states.  The destructor does it too, without a word where the disk refuses.
  /// @throws Error
  void close();
  void period(World& world, double t) override;
  void tick_of(std::size_t hand, const TickRecord& tick) override;
  void exchanged_of(std::size_t hand, const ContactRecord& record) override;
  bool wants_energy() const override;
  void energy(const EnergyBalance& balance) override;
  /// Where its files are; what it kept so far is on the disk then.  @pre made for a run with checkpoints
  void archive(Archive& a) override;

 private:
  Recorder(const World& world, const std::string& folder, bool goes_on, double duration_s, bool resumable);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::loop
