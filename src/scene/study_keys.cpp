#include "scene/study_keys.h"

#include <algorithm>

namespace palpate::scene {
namespace {

constexpr int kMostSeeds = 1000000;

/// Returns a TOML value as text that parses to the same value, as `--set` takes it after `=`.
std::string value_text(const toml::node& node) {
  if (const auto* number = node.as_floating_point()) return to_toml(number->get());
  std::ostringstream out;
  node.visit([&](const auto& typed) {
    if constexpr (toml::is_array<decltype(typed)>) {
      std::string items;
      for (const toml::node& one : typed) items += (items.empty() ? "" : ", ") + value_text(one);
      out << '[' << items << ']';
    } else {
      out << toml::toml_formatter(
          typed, toml::toml_formatter::default_flags & ~toml::format_flags::allow_literal_strings);
    }
  });
  return out.str();
}

void read_values(const Value& value, SweepSpec& spec) {
  const toml::array* array = value.node.as_array();
  if (!array || array->empty())
    refuse(location(value.node.source()), value.where, "values must be a list with at least one value");
  for (const toml::node& one : *array) spec.values.push_back(value_text(one));
}

/// Reads seeds: `seeds = 5` means `seeds = [1, 2, 3, 4, 5]`.
void read_seeds(const Value& value, StudySpec& spec) {
  if (value.node.is_array()) {
    for (const toml::node& one : *value.node.as_array())
      spec.seeds.push_back(read_integer(Value{one, value.where, value.key}, at_least(0)));
    return;
  }
  const int count = read_integer(value, closed(1, kMostSeeds));
  for (int seed = 1; seed <= count; ++seed) spec.seeds.push_back(seed);
}

const KeyTable<StudySpec>& study_keys() {
  static const KeyTable<StudySpec> keys = {
      unless("the file's name", text("name", &StudySpec::name, {}, "name of the study in reports")),
      required(texts("scenes", &StudySpec::scenes,
                     "files, relative to the study's folder, or names of `palpate list scenes`")),
      unless("each scene's own",
             texts("integrators", &StudySpec::integrators, "methods: palpate list integrators")),
      unless("each scene's own",
             numbers("rtol", &StudySpec::rtol, positive(), "tolerances, for each method with error control")),
      unless("each scene's own",
             numbers("step_s", &StudySpec::step_s, positive(), "steps, for each method with fixed steps")),
      own_key<StudySpec>(
          "seeds", read_seeds, "whole number or list", "none",
          "number of seeds, counted from 1, or a list of seeds: each draws a value for every [[random]] key"),
      unless("nothing", texts("set", &StudySpec::set, "changes to every scene: KEY=VALUE, as for --set")),
      number("duration_s", &StudySpec::duration_s, at_least(0.0, "0 is each scene's own"),
             "simulated time; 0: each scene's own"),
      number("limit_s", &StudySpec::limit_s, positive(),
             "limit on the CPU time of a task, all repeats together"),
      integer("repeats", &StudySpec::repeats, closed(1, 1000),
              "runs of each task; its times are medians over them"),
  };
  return keys;
}

const KeyTable<SweepSpec>& sweep_keys() {
  static const KeyTable<SweepSpec> keys = {
      required(text("key", &SweepSpec::key, {}, "dotted path of a scene key; tables count from 0")),
      own_key<SweepSpec>("values", read_values, "list", "by from, to and count",
                         "values of the key, in order"),
      unless("none", number("from", &SweepSpec::from, any(), "first of `count` values")),
      unless("none", number("to", &SweepSpec::to, any(), "last of `count` values")),
      unless("none", integer("count", &SweepSpec::count, closed(2, 100000), "number of values")),
      option("spacing", &SweepSpec::spacing, "equal differences, or equal ratios"),
      boolean("together", &SweepSpec::together,
              "vary together with the previous sweep, value by value, instead of in all combinations"),
  };
  return keys;
}

const KeyTable<RandomSpec>& random_keys() {
  static const KeyTable<RandomSpec> keys = {
      required(text("key", &RandomSpec::key, {}, "dotted path of a scene key; tables count from 0")),
      option("distribution", &RandomSpec::distribution, "distribution of the values"),
      unless("none", number("min", &RandomSpec::min, any(), "smallest value; for normal: lower truncation")),
      unless("none", number("max", &RandomSpec::max, any(), "largest value; for normal: upper truncation")),
      unless("none", number("mean", &RandomSpec::mean, any(), "mean of the normal distribution")),
      unless("none", number("standard_deviation", &RandomSpec::standard_deviation, positive(),
                            "standard deviation of the normal distribution")),
  };
  return keys;
}

}  // namespace

const KeyTable<StudySpec>& study_file_keys() {
  static const KeyTable<StudySpec> keys = {
      required(group("study", study_keys(), "scenes, methods and limits of the study")),
      tables("sweep", &StudySpec::sweeps, sweep_keys(), "a parameter that takes several values"),
      tables("random", &StudySpec::randoms, random_keys(), "a parameter drawn at random for each seed"),
  };
  return keys;
}

}  // namespace palpate::scene
