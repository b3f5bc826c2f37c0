#pragma once
#include <string>
#include <vector>

#include "commands.h"
#include "study/run.h"

namespace palpate::cli {

/// What became of the tasks that were to be run.
struct StudyEnd {
  bool stopped = false;    ///< by Ctrl-C
  bool submitted = false;  ///< and not waited for: there is no table yet
  std::string lost;        ///< why results are missing, for a message
};

/// Runs the tasks that have no result yet as an array job: submits it, or finds the one that an earlier call
/// has submitted, and waits for it.
/// @pre every task is settled
StudyEnd study_by_slurm(study::Plan& plan, const StudyArguments& arguments, const std::string& folder);

}  // namespace palpate::cli
