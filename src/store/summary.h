#pragma once
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "store/provenance.h"

namespace palpate::store {

/// Value in a summary.  Numbers that are not finite are written as null: JSON has no NaN.
using SummaryValue = std::variant<bool, long long, double, std::string, std::vector<double>>;

/// Named group of figures; names carry units: {"timings", {{"total_s", 1.2}}}.
struct SummarySection {
  std::string name;
  std::vector<std::pair<std::string, SummaryValue>> values;
};

/// Content of summary.json: command, scene, provenance and results of a run.
struct Summary {
  std::string command;  ///< Command line that repeats the run.
  std::string scene;
  std::string scene_source;
  std::vector<std::string> overrides;
  std::string outcome = "finished";  ///< "finished", "interrupted", "failed"
  std::string message;               ///< Reason, where not finished.
  std::vector<std::string> remarks;  ///< Warnings and verdicts, as on standard output.
  Provenance provenance;
  std::vector<SummarySection> sections;  ///< Options, counts, timings, errors, ...

  /// Returns the section of that name, created on first use.
  SummarySection& section(const std::string& name);
};

/// Returns the summary as JSON.
std::string to_json(const Summary& summary);
void write_summary(const std::string& path, const Summary& summary);  ///< Writes atomically.
/// Reads summary.json.  @throws Error where the file is missing or is no summary
Summary read_summary(const std::string& path);

}  // namespace palpate::store
