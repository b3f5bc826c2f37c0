#pragma once
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::scene {

/// Spacing of the values of a sweep: equal differences, or equal ratios.
enum class Spacing { kLinear, kLog };
/// Returns the names of the values.
constexpr std::array<std::string_view, 2> option_names(Spacing) { return {"linear", "log"}; }

/// Distribution of a parameter that is drawn at random.
enum class Distribution { kUniform, kLogUniform, kNormal };
/// Returns the names of the values.
constexpr std::array<std::string_view, 3> option_names(Distribution) {
  return {"uniform", "log-uniform", "normal"};
}

/// Parameter and the values that it takes: [[sweep]].
struct SweepSpec {
  std::string key;  ///< Dotted, as for `--set`.
  /// TOML, in the file's order; computed where from, to and count are given.
  std::vector<std::string> values;
  std::optional<double> from, to;
  int count = 0;
  Spacing spacing = Spacing::kLinear;  ///< Spacing of the values given by from, to and count.
  /// Varies together with the preceding sweep, value by value; else all combinations.
  bool together = false;
};

/// Parameter whose value is drawn at random per seed: [[random]].
struct RandomSpec {
  std::string key;
  Distribution distribution = Distribution::kUniform;
  std::optional<double> min, max;  ///< Bounds; for kNormal: truncation.
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

}  // namespace palpate::scene
