#pragma once
#include <string>
#include <vector>

/// Experiment as an array job of Slurm: every element runs the program on its tasks, on any node, and writes
/// its results into a file of the experiment's folder, which all nodes share.
namespace palpate::experiments {

/// Distributes groups of tasks over the elements of an array; each element is a list for `--task`.
/// @param chunk  groups per element; increased where more than `most` elements would be needed
/// @param most  number of elements that the site allows, at least 1
std::vector<std::string> elements_of(const std::vector<std::vector<std::size_t>>& groups, std::size_t chunk,
                                     std::size_t most);

/// Array job for sbatch.
struct ArrayJob {
  std::string program;             ///< Absolute path of palpate.
  std::string command;             ///< "study", "compare".
  std::vector<std::string> words;  ///< Arguments of the command, without folder and tasks.
  std::string name, subject;       ///< Name of the job; what is run, for a comment.
  std::string key;                 ///< Key of the list of tasks.
  std::string folder;              ///< Absolute path.
  /// Options of sbatch as given by the user: "--partition=short --time=10"; may be empty.
  std::string options;
  int threads = 1;  ///< Processors per element.
  std::vector<std::string> elements;
};

/// Returns the content of FOLDER/COMMAND.sbatch.
std::string sbatch_script(const ArrayJob& job);

/// Quotes a word for a shell.
std::string quoted(const std::string& word);

/// Result of a command of Slurm.
struct Answer {
  int status = 0;  ///< Exit status.
  std::string out, err;
};

/// Runs a program with these arguments and waits for it.
/// @throws Error where the program does not exist, with the Debian package that contains it
Answer ask(const std::vector<std::string>& words);

/// Returns MaxArraySize of the site, an upper bound of indices.  1001, Slurm's default, where it cannot be
/// determined.
std::size_t max_array_size();

/// Submits a script.  @return the job's number  @throws Error with the whole output of sbatch
std::string submit(const std::string& script);

/// Queued or running; ended; the controller did not answer.
enum class JobState { kWaiting, kOver, kUnknown };
/// Returns the state of a job.
JobState job_state(const std::string& job);

}  // namespace palpate::experiments
