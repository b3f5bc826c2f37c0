#pragma once
#include <string>
#include <vector>

#include "study/run.h"

namespace palpate::cli {

/// Arguments of `palpate study`.
struct StudyArguments {
  std::string study;          ///< STUDY.toml
  std::string folder;         ///< empty: out/study-NAME
  int jobs = 0;               ///< tasks side by side; 0: as many as there are cores for their threads
  bool dry_run = false;       ///< print the tasks alone
  bool merge = false;         ///< make the table of the results that there are, run nothing
  bool fresh = false;         ///< forget the results that an earlier call left in the folder
  std::string tasks;          ///< only these, and no table: "0-3,7"; empty: all
  std::string plan;           ///< key that the list of tasks must have; empty: any
  bool slurm = false;         ///< as an array job
  std::string slurm_options;  ///< of sbatch
  int chunk = 1;              ///< tasks of an element of the array, at least
  bool no_wait = false;       ///< submit alone
};

/// Runs the tasks of a study and tabulates their results.  @return the exit status
int study(const StudyArguments& arguments);

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
