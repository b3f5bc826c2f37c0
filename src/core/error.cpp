#include "palpate/core/error.h"

#include <fmt/ranges.h>

#include <algorithm>

#include <numeric>

namespace palpate {

namespace detail {
void check_failed(const char* file, int line, const char* condition, const std::string& message) {
  throw InternalError(fmt::format("{}:{}: broken invariant `{}`: {}", file, line, condition, message));
}
}  // namespace detail

namespace {
char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Optimal string alignment distance: insertions, deletions, substitutions and swaps of neighbours cost one
/// each; letter case is ignored.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  const auto same = [&](std::size_t i, std::size_t j) { return lower(a[i - 1]) == lower(b[j - 1]); };
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before.swap(above);
    above.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (same(i, j) ? 0 : 1)});
      if (i > 1 && j > 1 && same(i, j - 1) && same(i - 1, j)) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

/// Whether `longer` is `name` followed by further words: "stiffness" and "stiffness_pa_m".
bool adds_words(std::string_view longer, std::string_view name) {
  return !name.empty() && longer.size() > name.size() && longer.starts_with(name) &&
         (longer[name.size()] == '_' || longer[name.size()] == '-' || longer[name.size()] == ' ');
}
}  // namespace

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(1, name.size() / 2) + 1;
  for (const auto& candidate : candidates) {
    const bool words = adds_words(candidate, name) || adds_words(name, candidate);
    // A missing unit counts as one edit.
    const std::size_t full = edit_distance(name, candidate),
                      distance = words ? std::min<std::size_t>(full, 1) : full;
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  // No close candidate: accept an abbreviation, the beginning of a candidate.
  for (const auto& candidate : candidates)
    if (best.empty() && !name.empty() && candidate.starts_with(name)) best = candidate;
  return best;
}

std::string suggestion(std::string_view name, const std::vector<std::string>& candidates) {
  if (const std::string near = nearest_name(name, candidates); !near.empty())
    return fmt::format(" (did you mean \"{}\"?)", near);
  if (candidates.empty()) return "";
  return fmt::format(" (known: {})", fmt::join(candidates, ", "));
}

}  // namespace palpate
