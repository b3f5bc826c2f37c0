#pragma once
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "palpate/store/provenance.h"

namespace palpate::store {

/// A number that is not finite is written as null: JSON has no NaN.
using SummaryValue = std::variant<bool, long long, double, std::string, std::vector<double>>;

/// A named group of figures; names carry units: {"timings", {{"total_s", 1.2}}}.
struct SummarySection {
  std::string name;
  std::vector<std::pair<std::string, SummaryValue>> values;
};

/// summary.json: the command, scene, provenance and results of a run.
struct Summary {
  std::string command;  ///< as a person would type it again
  std::string scene;
  std::string scene_source;
  std::vector<std::string> overrides;
  std::string outcome = "finished";  ///< "finished", "interrupted", "failed"
  std::string message;               ///< why not finished
  std::vector<std::string> remarks;  ///< warnings and verdicts, as standard output had them
  Provenance provenance;
  std::vector<SummarySection> sections;  ///< options, counts, timings, errors, ...

  SummarySection& section(const std::string& name);  ///< made on first use
};

std::string to_json(const Summary& summary);
void write_summary(const std::string& path, const Summary& summary);  ///< atomically
Summary read_summary(const std::string& path);

}  // namespace palpate::store
