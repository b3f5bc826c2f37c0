#include "session/checkpoint_files.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "core/instructions.h"
#include "loop/haptic_record.h"
#include "palpate/core/error.h"
#include "store/checkpoint_file.h"
#include "store/provenance.h"
#include "store/table_file.h"

namespace palpate::session {

std::string checkpoint_path(const std::string& folder) {
  return (std::filesystem::path(folder) / "checkpoint.h5").string();
}

void remove_checkpoint(const std::string& folder) {
  std::error_code ignored;
  std::filesystem::remove(checkpoint_path(folder), ignored);
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    if (entry.path().filename().string().ends_with(store::TableFile::journal_path(".h5")))
      std::filesystem::remove(entry.path(), ignored);
}

void check_checkpoints(const Options& options, const scene::Description& description) {
  const auto refuse = [](const char* option, const char* why) {
    fail("--checkpoint-every cannot be combined with {}: {}", option, why);
  };
  if (options.real_time)
    refuse("--realtime", "a resumed run cannot reproduce the clock and the motion of the hand");
  if (options.picture || options.contact_picture || options.draws_frames())
    refuse("--picture, --contact-picture, --frames and --movie",
           "checkpoints do not contain recorded frames; use `palpate movie` after the run");
  if (options.trace) refuse("--trace", "checkpoints do not contain the trace");
  if (options.against_monolithic)
    refuse("--against-monolithic",
           "checkpoints do not contain the motion that it repeats; use `palpate replay` after the run");
  loop::check_checkpoints(description, options.checkpoint_every_s, options.duration_s);
}

void RunIdentity::archive(Archive& a) {
  a("scene", options.scene.scene);
  a.list("override", options.scene.overrides, [&](std::string& change) { a("is", change); });
  a("integrator", options.scene.integrator);
  a("folder", options.folder);
  a("duration_s", options.duration_s);
  a("report", options.report);
  a("passivity", options.passivity);
  a("checkpoint_every_s", options.checkpoint_every_s);
  a("scene_path", scene_path);
  a("bodies", bodies);
  a("cpu", cpu);
  a("instructions", instructions);
}

RunIdentity identity_of(const Options& options, const loop::World& world) {
  return {options, std::filesystem::absolute(world.description.path).lexically_normal().string(),
          loop::fingerprint(world), store::provenance().cpu, instructions_in_use()};
}

std::string instructions_in_use() {
  const char* blas = std::getenv("OPENBLAS_CORETYPE");
  return fmt::format("{}, OpenBLAS {}", name_of(best_instructions()), blas ? blas : "default kernels");
}

loop::CheckpointPlan checkpoint_plan(RunIdentity identity, const scene::Description& description,
                                     const std::string& folder) {
  loop::CheckpointPlan plan;
  plan.every_s = identity.options.checkpoint_every_s;
  plan.assemble = [description] { return loop::assemble(description); };
  plan.keep = [identity, source = description.source, path = checkpoint_path(folder)](
                  double time_s, const Archive& state) mutable {
    Archive all;
    all("command", identity);
    store::Checkpoint checkpoint{store::full_version(), time_s, source, all.values()};
    checkpoint.values.insert(state.values().begin(), state.values().end());
    store::write_checkpoint(path, checkpoint);
  };
  return plan;
}

}  // namespace palpate::session
