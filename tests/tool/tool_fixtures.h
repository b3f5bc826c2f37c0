#pragma once
#include <cmath>
#include <limits>
#include <vector>

#include "palpate/tool/tool.h"
#include "validation/e_oscillator.h"

/// Shared by the tool's tests: the oscillator and the tool of the cases in validation/, and helper functions.
namespace palpate::tool::testing {

using validation::Oscillator;

inline ToolSpec spec_for(const std::string& integrator) { return validation::desktop_tool(integrator); }

inline HandleMotion held(const Pose& pose) { return {pose, pose, {}, {}}; }

/// A contact that pushes along z with K times the depth below z = 0.
inline dynamics::LinearisedContact wall(double K) {
  dynamics::LinearisedContact record;
  record.version = 1;
  record.source = dynamics::LinearisedContact::Source::kFrozen;
  record.J[6 * 5 + 5] = -K;
  return record;
}

/// Least-squares slope of log(error) against log(h).
inline double slope(const std::vector<double>& h, const std::vector<double>& e) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const double n = static_cast<double>(h.size());
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double a = std::log(h[i]), b = std::log(e[i]);
    x += a, y += b, xx += a * a, xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace palpate::tool::testing
