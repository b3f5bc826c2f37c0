#pragma once
#include <string>
#include <vector>

#include "commands.h"
#include "study/run.h"

namespace palpate::cli {

/// Outcome of the tasks of a study.
struct StudyEnd {
  bool stopped = false;    ///< Stopped by Ctrl-C
  bool submitted = false;  ///< Submitted without waiting: there is no table yet
  std::string lost;        ///< Why results are missing, for a message; empty: none are missing
};

/// Runs the tasks without a result as a Slurm array job: submits the job, or finds the job that an earlier
/// call submitted, and waits for it.
/// @pre every task is settled
StudyEnd study_by_slurm(study::Plan& plan, const StudyArguments& arguments, const std::string& folder);

}  // namespace palpate::cli
