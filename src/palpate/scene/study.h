#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/scene/kinds.h"

/// A study as a file says it: scenes x integrators x tolerances x swept parameters x seeds.  Plain data;
/// palpate/study/plan.h makes tasks of it.
namespace palpate::scene {

/// One parameter and the values that it takes: [[sweep]].
struct SweepSpec {
  std::string key;                  ///< dotted, as for `--set`
  std::vector<std::string> values;  ///< as TOML, in the file's order; of from, to and count: their values
  std::optional<double> from, to;
  int count = 0;
  std::string spacing = "linear";  ///< or "log"
  bool together = false;           ///< moves with the sweep before it, value by value; else all combinations
};

/// One parameter whose value a seed draws: [[random]].
struct RandomSpec {
  std::string key;
  std::string distribution = "uniform";  ///< or "log-uniform", "normal"
  std::optional<double> min, max;        ///< of "normal": where it is cut off
  std::optional<double> mean, standard_deviation;
};

/// STUDY.toml.
struct StudySpec {
  std::string path, text;                ///< the file and what stands in it
  std::string name;                      ///< empty: the file's
  std::vector<std::string> scenes;       ///< files, relative to the study's, or names of shipped ones
  std::vector<std::string> integrators;  ///< empty: each scene's own
  std::vector<double> rtol;              ///< of methods under error control; empty: the scene's
  std::vector<double> step_s;            ///< of methods with fixed steps; empty: the scene's
  std::vector<int> seeds;                ///< of the [[random]] keys; empty where there are none
  std::vector<std::string> set;          ///< KEY=VALUE, in every scene
  double duration_s = 0.0;               ///< simulated time; 0: the scene's
  double limit_s = 600.0;                ///< CPU time of a task, its repeats together
  int repeats = 1;                       ///< runs of a task, for the spread of its times
  std::vector<SweepSpec> sweeps;
  std::vector<RandomSpec> randoms;
};

/// Reads and checks a study's text.  Messages are those of scenes: `FILE:LINE:COLUMN: where: what`, with the
/// nearest known key.  Whether the swept keys exist only the scenes can say.
/// @throws Error
StudySpec parse_study(const std::string& text, const std::string& path);
StudySpec load_study(const std::string& path);

/// Every key that a study may contain, table by table: `palpate list study-keys`.
std::vector<KeyRow> study_key_rows();

/// The value that a seed draws for a key, as TOML with six significant digits.  It depends on the seed, the
/// key and the distribution alone: not on the scene, the integrator, nor on what else is drawn, so that what
/// is compared with what meets the same bodies.  std::mt19937_64 seeded by std::seed_seq of the seed and the
/// key's bytes; both are the same on every machine (C++20, [rand.eng.mers], [rand.util.seedseq]).
/// @throws Error for a normal distribution that hardly ever falls between its min and max
std::string drawn_value(const RandomSpec& random, int seed);

}  // namespace palpate::scene
