#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/study/plan.h"

/// A study as an array job of Slurm: every element runs the program itself on its tasks, on whichever node it
/// gets, and leaves a file a task in the study's folder, which all nodes see.
namespace palpate::study {

/// Shares tasks out over the elements of an array, each a list for `--task`.
/// @param chunk  tasks of an element; more where `most` elements would not hold them
/// @param most  elements that the site allows, at least 1
std::vector<std::string> elements_of(const std::vector<std::size_t>& tasks, std::size_t chunk,
                                     std::size_t most);

struct ArrayJob {
  std::string program;  ///< absolute path of palpate
  std::string folder;   ///< absolute
  std::string options;  ///< of sbatch, as a person gives them: "--partition=short --time=10"; may be empty
  int threads = 1;      ///< processors of an element
  std::vector<std::string> elements;
};

/// The text of FOLDER/study.sbatch.
std::string sbatch_script(const Plan& plan, const ArrayJob& job);

/// What a command of Slurm answered.
struct Answer {
  int status = 0;  ///< of its exit
  std::string out, err;
};

/// Runs a program with these words and waits for it.
/// @throws Error where there is no such program, naming the Debian package that has it
Answer ask(const std::vector<std::string>& words);

/// MaxArraySize of the site: an index is below it.  1001, Slurm's default, where it cannot be learned.
std::size_t max_array_size();

/// Submits a script.  @return the job's number  @throws Error with all that sbatch said
std::string submit(const std::string& script);

enum class JobState { kWaiting, kOver, kUnknown };  ///< queued or running; not; the controller did not answer
JobState job_state(const std::string& job);

}  // namespace palpate::study
