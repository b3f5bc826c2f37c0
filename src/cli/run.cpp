#include "run.h"

#include "checkpoints.h"
#include "cli/missing_outputs.h"
#include "cli/scene_of.h"
#include "run_session.h"

namespace palpate::cli {

int run(const RunArguments& arguments) {
  MissingOutputs missing;
  return missing.close(run(arguments, missing));
}

int run(const RunArguments& arguments, MissingOutputs& missing) {
  scene::Description description = scene_of(arguments.scene);
  // the motion of a hand in real time cannot be repeated: it is recorded, so that it can be replayed
  if (arguments.real_time && description.tool && !description.record)
    description.record = RecordSpec{.states = false};
  return RunSession(arguments, description, missing, nullptr).run();
}

int resume_run(Resumption& resumption, const scene::Description& description, MissingOutputs& missing) {
  return RunSession(resumption.identity.arguments, description, missing, &resumption).run();
}

}  // namespace palpate::cli
