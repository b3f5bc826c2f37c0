#include <fstream>
#include <limits>

#include <nlohmann/json.hpp>

#include "palpate/core/error.h"
#include "product/fem.h"

namespace palpate::bench {
namespace {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// Checks that the source of a figure is described in the file.
void check_source(const nlohmann::json& figure, const nlohmann::json& sources) {
  if (const std::string source = figure.at("source"); !sources.contains(source))
    fail("\"{}\" quotes the source \"{}\", which \"sources\" does not describe",
         figure.at("program").get<std::string>(), source);
}

PublishedTimings read(const nlohmann::json& file) {
  PublishedTimings out;
  const nlohmann::json& sources = file.at("sources");
  for (const auto& bandwidth : file.at("reference_machine").at("copy_gb_s"))
    out.reference_copy_gb_s.emplace_back(bandwidth.at("threads").get<int>(),
                                         bandwidth.at("value").get<double>());
  for (const auto& figure : file.at("step_times").at("figures")) {
    check_source(figure, sources);
    out.step_times.push_back({.program = figure.at("program"),
                              .size = figure.at("size"),
                              .ten_ms = figure.at("ms_of_10_ms_step"),
                              .one_ms = figure.value("ms_of_1_ms_step", kNotMeasured),
                              .tolerance = figure.at("tolerance")});
  }
  for (const auto& figure : file.at("accuracy").at("figures")) {
    check_source(figure, sources);
    out.accuracy.emplace_back(figure.at("size").get<std::string>(),
                              AccuracyPoint{.program = figure.at("program"),
                                            .step_s = figure.at("step_s"),
                                            .tolerance = figure.value("tolerance", 0.0),
                                            .ms_of_ten_ms = figure.at("ms_of_10_ms"),
                                            .error = figure.at("error"),
                                            .quoted = true});
  }
  return out;
}

}  // namespace

PublishedTimings read_published_timings(const std::string& path) {
  std::ifstream in(path);
  if (!in)
    fail(
        "{}: cannot be read; `palpate bench fem` requires this file of published timings, which is part of "
        "palpate",
        path);
  try {
    return read(nlohmann::json::parse(in));
  } catch (const std::exception& e) {
    fail("{}: is not a valid file of published timings: {}", path, e.what());
  }
}

double PublishedTimings::reference_bandwidth_gb_s(int threads) const {
  double at_most = kNotMeasured;
  for (const auto& [count, value] : reference_copy_gb_s)
    if (count <= threads) at_most = value;
  return at_most;
}

}  // namespace palpate::bench
