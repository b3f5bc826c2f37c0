#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "loop/haptic_memory.h"
#include "loop/penetration_warning.h"
#include "loop/trace.h"
#include "palpate/device/device.h"
#include "palpate/loop/recorder.h"
#include "session/callbacks.h"
#include "session/checkpoint_files.h"
#include "session/options.h"
#include "session/resumption.h"
#include "session/run_output.h"
#include "session/run_pictures.h"
#include "store/folder_lock.h"
#include "store/summary.h"

namespace palpate::session {

/// Parts of a run that its caller owns, in addition to those of the scene.
struct RunAttachments {
  /// Devices in place of the scene's, as for loop::assemble(); not for a run with checkpoints.
  std::vector<std::unique_ptr<device::Device>> hands;
  std::vector<loop::Observer*> observers;    ///< Called after those of the session; they outlive it.
  const std::atomic<bool>* pause = nullptr;  ///< As loop::RunOptions::pause
};

/// One run of a scene: its World, its observers, and the files that it writes. It prints nothing. The steps
/// of a run are separate functions, so that a caller can report after each; run() calls all of them. Counters
/// of constructions and kept warnings are those of the process: a process has one session at a time.
class RunSession {
 public:
  /// Prepares the run: checks the options, assembles the scene, locks the folder, removes the files of an
  /// earlier run and writes the summary that remains if the process is killed. A scene that records nothing
  /// writes no file unless an option requests one.
  /// @param resumption  checkpoint to resume from, which must outlive the session; null: the start
  /// @throws Error for options that do not suit the scene or each other, for a scene that cannot be
  /// assembled, and for a folder that cannot be written, is locked by another process or contains an input of
  /// the run
  /// @param attachments  devices and observers of the caller
  RunSession(const Options& options, const scene::Description& description, Resumption* resumption = nullptr,
             RunAttachments attachments = {});
  RunSession(const RunSession&) = delete;
  RunSession& operator=(const RunSession&) = delete;

  /// Simulates the scene to its end, or until it is stopped, and closes the recorded files. A failure of the
  /// integrator is a result, see failure().
  /// @throws Error if data cannot be written; the summary then has its message
  void simulate(const Callbacks& callbacks = {});
  /// Computes the error of a complete run: against the monolithic solution, if requested, and against the
  /// same scene in virtual time, if a run in real time skipped ticks.
  void compare_with_references(const Callbacks& callbacks = {});
  /// Writes summary, pictures and page, and removes the checkpoint of a complete run.
  void write_results();
  /// Draws frames and movie, if requested. The frames of a stopped run are drawn, too.
  void draw_frames(const Callbacks& callbacks = {});
  /// Calls all steps in this order.
  void run(const Callbacks& callbacks = {});

  const loop::World& world() const { return *world_; }
  loop::World& world() { return *world_; }
  const RunOutput& output() const { return ran_; }
  /// Returns the summary of the run so far, the content of summary.json.
  store::Summary summary() const;
  /// Returns why the run failed, and what to do; empty for a run that did not fail.
  std::string failure() const;

 private:
  scene::Description chosen(const scene::Description& description);
  void compare_with_monolithic(const Callbacks& callbacks);
  void compare_with_every_tick(const Callbacks& callbacks);
  void assemble();
  void prepare_checkpoints();
  void open_folder();
  void attach_observers(const PictureOptions& pictures);
  void close_records();
  std::string path(const char* file) const { return (std::filesystem::path(ran_.folder) / file).string(); }

  std::string scheme_remark_;  ///< Reason of the choice for scheme = "auto".
  const Options options_;
  const scene::Description description_;
  Resumption* resumption_;
  RunAttachments attachments_;
  bool has_checkpoints_;
  device::PassivityController::Mode passivity_;
  std::unique_ptr<loop::World> world_;
  RunOutput ran_;
  RunIdentity identity_;
  store::FolderLock lock_;
  loop::PenetrationWarning penetration_warning_;
  std::optional<RunPictures> pictures_;
  std::optional<loop::Recorder> recorder_;
  std::optional<loop::TraceRecorder> trace_;
  loop::HapticMemory memory_;
  std::vector<loop::Observer*> observers_;
};

}  // namespace palpate::session
