#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "checkpoints.h"
#include "loop/haptic_memory.h"
#include "loop/penetration_warning.h"
#include "loop/trace.h"
#include "palpate/loop/recorder.h"
#include "run.h"
#include "run_pictures.h"
#include "run_summary.h"
#include "store/result_folder.h"

namespace palpate::cli {

/// One run: its World, its observers, and the files that it writes.
class RunSession {
 public:
  /// @param resumption  the checkpoint to resume from; null: the start
  RunSession(const RunArguments& arguments, const scene::Description& description, MissingOutputs& missing,
             Resumption* resumption);

  /// Runs the scene and keeps what it records.  @return the exit status
  int run();

 private:
  void assemble();
  void prepare_checkpoints();
  void open_folder();
  void attach_observers(const PictureOptions& options);
  void simulate();
  void close_records();
  void compare_with_monolithic();
  /// @return whether Ctrl-C ended the drawing of frames
  bool write_results();
  int exit_status(bool frames_stopped) const;

  bool is_complete() const { return ran_.result.status.ok() && !ran_.result.stopped; }
  std::string path(const char* file) const { return (std::filesystem::path(folder_) / file).string(); }

  const RunArguments& arguments_;
  const scene::Description& description_;
  MissingOutputs& missing_;
  Resumption* resumption_;
  bool has_checkpoints_;
  bool writes_files_ = false;
  std::string folder_;
  std::unique_ptr<loop::World> world_;
  RunOutput ran_;
  RunIdentity identity_;
  store::ResultFolder lock_;
  loop::PenetrationWarning penetration_warning_;
  std::optional<RunPictures> pictures_;
  std::optional<loop::Recorder> recorder_;
  std::optional<loop::TraceRecorder> trace_;
  loop::HapticMemory memory_;
  std::vector<loop::Observer*> observers_;
};

}  // namespace palpate::cli
