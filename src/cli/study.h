#pragma once
#include <string>
#include <vector>

#include "study/run.h"

namespace palpate::cli {

/// Arguments of `palpate study`.
struct StudyArguments {
  std::string study;          ///< STUDY.toml
  std::string folder;         ///< Output folder; empty: out/study-NAME
  int jobs = 0;               ///< Tasks in parallel; 0: as many as the cores allow for their threads
  bool dry_run = false;       ///< Only prints the tasks
  bool merge = false;         ///< Tabulates the existing results and runs nothing
  bool fresh = false;         ///< Discards the results that an earlier call left in the folder
  std::string tasks;          ///< Tasks to run, without a table: "0-3,7"; empty: all
  std::string plan;           ///< Required key of the list of tasks; empty: any
  bool slurm = false;         ///< Runs the tasks as an array job
  std::string slurm_options;  ///< Options of sbatch
  int chunk = 1;              ///< Least number of tasks per element of the array
  bool no_wait = false;       ///< Submits the job and returns
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
