#pragma once
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "store/provenance.h"

namespace palpate::store {

/// Version of the keys of summary.json, `schema_version`: 1 more wherever a key changes its name or meaning.
/// docs/files.md lists the keys.
constexpr int kSummarySchema = 1;

/// Value in a summary.  Numbers that are not finite are written as null: JSON has no NaN.
using SummaryValue = std::variant<bool, long long, double, std::string, std::vector<double>,
                                  std::vector<long long>, std::vector<std::string>>;
/// Keys and values in order.  Keys are snake_case, with the unit at the end: {{"total_s", 1.2}}.
using SummaryFields = std::vector<std::pair<std::string, SummaryValue>>;

/// Named group of figures: {"timings", {{"total_s", 1.2}}}.
struct SummarySection {
  std::string name;
  SummaryFields values;
};

/// Named list of rows, for example one row per contact.  A row omits figures that it does not have.
struct SummaryList {
  std::string name;
  std::vector<SummaryFields> rows;
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
  std::vector<SummaryList> lists;        ///< Hands, contacts, parts, ...

  /// Returns the section of that name, created on first use.
  SummarySection& section(const std::string& name);
  /// Returns the rows of the list of that name, created on first use.
  std::vector<SummaryFields>& list(const std::string& name);
};

/// Returns the summary as JSON.
std::string to_json(const Summary& summary);
void write_summary(const std::string& path, const Summary& summary);  ///< Writes atomically.
/// Reads summary.json.  @throws Error where the file is missing, is no summary or has another schema
Summary read_summary(const std::string& path);

}  // namespace palpate::store
