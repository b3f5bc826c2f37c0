#pragma once
#include <optional>
#include <string>
#include <vector>

#include "palpate/scene/kinds.h"

/// Study as specified by its file: scenes x integrators x tolerances x swept parameters x seeds.  Plain data;
/// study/plan.h makes tasks of it.
namespace palpate::scene {

/// Parameter and the values that it takes: [[sweep]].
struct SweepSpec {
  std::string key;  ///< Dotted, as for `--set`.
  /// TOML, in the file's order; computed where from, to and count are given.
  std::vector<std::string> values;
  std::optional<double> from, to;
  int count = 0;
  std::string spacing = "linear";  ///< Or "log".
  /// Varies together with the preceding sweep, value by value; else all combinations.
  bool together = false;
};

/// Parameter whose value is drawn at random per seed: [[random]].
struct RandomSpec {
  std::string key;
  std::string distribution = "uniform";  ///< Or "log-uniform", "normal".
  std::optional<double> min, max;        ///< Bounds; for "normal": truncation.
  std::optional<double> mean, standard_deviation;
};

/// Content of STUDY.toml.
struct StudySpec {
  std::string path, text;           ///< Path and content of the file.
  std::string name;                 ///< Empty: the file's name.
  std::vector<std::string> scenes;  ///< Files, relative to the study's folder, or names of shipped scenes.
  std::vector<std::string> integrators;  ///< Empty: the integrator of each scene.
  std::vector<double> rtol;              ///< For methods under error control; empty: the scene's.
  std::vector<double> step_s;            ///< For methods with fixed steps [s]; empty: the scene's.
  std::vector<int> seeds;                ///< Seeds of the [[random]] keys; empty where there are none.
  std::vector<std::string> set;          ///< KEY=VALUE, in every scene.
  double duration_s = 0.0;               ///< Simulated time [s]; 0: the scene's.
  double limit_s = 600.0;                ///< Limit of CPU time per task, including repeats [s].
  int repeats = 1;                       ///< Runs per task, for the spread of its times.
  std::vector<SweepSpec> sweeps;
  std::vector<RandomSpec> randoms;
};

/// Reads and checks a study given as text.  Whether the swept keys exist is checked with the scenes.
/// @throws Error as for scenes: `FILE:LINE:COLUMN: where: what`, with the nearest known key
StudySpec parse_study(const std::string& text, const std::string& path);
/// Reads and checks a study file.  @throws Error as parse_study(), or where the file cannot be read
StudySpec load_study(const std::string& path);

/// Returns every key that a study may contain, table by table: `palpate list study-keys`.
std::vector<KeyRow> study_key_rows();

/// Returns the value that a seed draws for a key, as TOML with six significant digits.  It depends only on
/// seed, key and distribution, not on the scene, the integrator or other drawn values, so that compared runs
/// have the same bodies.  std::mt19937_64 seeded by std::seed_seq of the seed and the key's bytes; both give
/// the same sequence on every machine (C++20, [rand.eng.mers], [rand.util.seedseq]).
/// @throws Error for a normal distribution that hardly ever falls between its min and max
std::string drawn_value(const RandomSpec& random, int seed);

}  // namespace palpate::scene
