#include "checkpoints.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "core/instructions.h"
#include "loop/haptic_record.h"
#include "palpate/core/error.h"
#include "store/provenance.h"
#include "store/table_file.h"

namespace palpate::cli {

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

void check_checkpoints(const RunArguments& arguments, const scene::Description& description) {
  const auto refuse = [](const char* option, const char* why) {
    fail("--checkpoint-every cannot be combined with {}: {}", option, why);
  };
  if (arguments.real_time)
    refuse("--realtime", "a resumed run cannot reproduce the clock and the motion of the hand");
  if (arguments.picture || arguments.contact_picture || arguments.frames || !arguments.movie.empty())
    refuse("--picture, --contact-picture, --frames and --movie",
           "checkpoints do not contain recorded frames; use `palpate movie` after the run");
  if (arguments.trace) refuse("--trace", "checkpoints do not contain the trace");
  if (arguments.against_monolithic)
    refuse("--against-monolithic",
           "checkpoints do not contain the motion that it repeats; use `palpate replay` after the run");
  loop::check_checkpoints(description, arguments.checkpoint_every_s, arguments.duration_s);
}

void RunIdentity::archive(Archive& a) {
  a("scene", arguments.scene.scene);
  a.list("override", arguments.scene.overrides, [&](std::string& change) { a("is", change); });
  a("integrator", arguments.scene.integrator);
  a("folder", arguments.folder);
  a("duration_s", arguments.duration_s);
  a("report", arguments.report);
  a("passivity", arguments.passivity);
  a("checkpoint_every_s", arguments.checkpoint_every_s);
  a("scene_path", scene_path);
  a("bodies", bodies);
  a("cpu", cpu);
  a("instructions", instructions);
}

RunIdentity identity_of(const RunArguments& arguments, const loop::World& world) {
  return {arguments, std::filesystem::absolute(world.description.path).lexically_normal().string(),
          loop::fingerprint(world), store::provenance().cpu, instructions_in_use()};
}

std::string instructions_in_use() {
  const char* blas = std::getenv("OPENBLAS_CORETYPE");
  return fmt::format("{}, OpenBLAS {}", name_of(best_instructions()), blas ? blas : "default kernels");
}

loop::CheckpointPlan checkpoint_plan(RunIdentity identity, const scene::Description& description,
                                     const std::string& folder) {
  loop::CheckpointPlan plan;
  plan.every_s = identity.arguments.checkpoint_every_s;
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

void print_checkpoints(const loop::CheckpointCost& cost, double every_s) {
  fmt::print(
      "checkpoints: {}, one per {:g} s of simulated time; {:.3g} s to write them and {:.3g} s to reassemble "
      "the scene, with integrator, factors and initial guesses, after each\n",
      cost.written, every_s, cost.keep_s, cost.assemble_s);
}

}  // namespace palpate::cli
