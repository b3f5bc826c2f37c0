#pragma once
#include <string>

#include "cli/array_job.h"

namespace palpate::cli {

/// Arguments of `palpate study`.
struct StudyArguments {
  std::string study;     ///< STUDY.toml
  std::string folder;    ///< Output folder; empty: out/study-NAME
  int jobs = 0;          ///< Tasks in parallel; 0: as many as the cores allow for their threads
  bool dry_run = false;  ///< Only prints the tasks
  bool merge = false;    ///< Tabulates the existing results and runs nothing
  bool fresh = false;    ///< Discards the results that an earlier call left in the folder
  ArrayArguments array;
};

/// Runs the tasks of a study and tabulates their results.  @return the exit status
int study(const StudyArguments& arguments);

}  // namespace palpate::cli
