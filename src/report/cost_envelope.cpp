#include "report/cost_envelope.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"

// Cost of an error on a refinement sequence, and the sequence that reaches an error at the least cost.
//
// The error of a method falls as its setting is refined, and its cost rises: cost is a decreasing function of
// error, about which the measurements scatter. A level whose error passes through zero by chance shows a
// smaller error than the method achieves; the finer levels reveal this. For the levels i = 0, 1, ... from
// coarse to fine, with errors e_i:
//     best_i = min(e_0 ... e_i)     lower bound of any monotone course that some level supports,
//     worst_i = max(e_i ... e_n)    upper bound: each finer level must be as accurate,
//     fit_i = the non-increasing sequence nearest to log e_i in the sum of squares (isotonic regression:
//             neighbours that increase are pooled; Barlow and Brunk 1972), between the two by construction.
// Costs need no fit. The error of level i is also reached by any finer level: the cost of level i is the
// least of c_i ... c_n, for medians, for the fastest repeats, and for the slowest repeats. The cost at a
// target error is the point at which log cost, linear in log error between neighbouring levels, crosses the
// target:
//     value on (fit, medians), low on (best, fastest), high on (worst, slowest).
// Therefore [low, high] contains both the noise of the machine and the chance of single levels. A level that
// ran once takes the spread of the other points of the scene; if no point was repeated the spread is unknown,
// and no winner is declared.
//
// Unresolved errors do not affect a decision. A level within kResolved times the error of the reference has
// that product as its error, an upper bound; a target below it has no cost. If the error of the reference is
// unknown, no target has a cost. Costs are not interpolated across failed levels or beyond the ends: the
// first usable level gives an upper bound of the cost, and so does the first level after a gap.

namespace palpate::report {
namespace {

/// Error and cost of each level, both monotone.
struct Course {
  std::vector<double> error, cost;
};

/// Returns the non-increasing sequence nearest to the logarithms of `values`; pooled neighbours take their
/// mean.
std::vector<double> isotonic(const std::vector<double>& values) {
  struct Pool {
    double sum;
    std::size_t count;
    double value;  ///< Exact value of a pool with a single entry
    double mean() const { return sum / static_cast<double>(count); }
  };
  std::vector<Pool> pools;
  for (const double value : values) {
    pools.push_back({std::log(value), 1, value});
    while (pools.size() > 1 && pools[pools.size() - 2].mean() < pools.back().mean()) {
      const Pool last = pools.back();
      pools.pop_back();
      pools.back().sum += last.sum;
      pools.back().count += last.count;
    }
  }
  std::vector<double> out;
  for (const Pool& pool : pools)
    out.insert(out.end(), pool.count, pool.count == 1 ? pool.value : std::exp(pool.mean()));
  return out;
}

std::vector<double> least_from_the_start(std::vector<double> values) {
  for (std::size_t i = 1; i < values.size(); ++i) values[i] = std::min(values[i], values[i - 1]);
  return values;
}
template <class Choice>
std::vector<double> from_the_end(std::vector<double> values, Choice choice) {
  for (std::size_t i = values.size(); i-- > 1;) values[i - 1] = choice(values[i - 1], values[i]);
  return values;
}

struct Crossing {
  double cost = kUnknown;
  std::size_t level = 0;
  bool at_most = false;
};

Crossing crossing_of(const Course& course, const std::vector<LadderPoint>& points, double target) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double fine = course.error[i];
    if (!(fine <= target)) continue;
    if (i == 0 || points[i].behind_failure) return {course.cost[i], i, fine < target};
    const double coarse = course.error[i - 1], cheap = course.cost[i - 1], dear = course.cost[i];
    if (!(cheap > 0.0)) return {dear, i, true};
    const double share = std::log(coarse / target) / std::log(coarse / fine);
    return {std::exp((1.0 - share) * std::log(cheap) + share * std::log(dear)), i, false};
  }
  return {};
}

}  // namespace

Cost cost_at(const Ladder& ladder, double target, double reference_error) {
  const std::vector<LadderPoint>& points = ladder.points;
  const double resolved = kResolved * reference_error;
  if (points.empty() || !(target >= resolved)) return {};  // NaN: unknown
  std::vector<double> error, cost, fastest, slowest;
  for (const LadderPoint& p : points) {
    error.push_back(std::max({p.error, resolved, std::numeric_limits<double>::min()}));
    cost.push_back(p.cost);
    fastest.push_back(p.cost_low);
    slowest.push_back(p.cost_high);
  }
  const auto least = [](double a, double b) { return std::min(a, b); };
  const auto largest = [](double a, double b) { return std::max(a, b); };
  const Crossing value = crossing_of({isotonic(error), from_the_end(cost, least)}, points, target);
  const Crossing low =
      crossing_of({least_from_the_start(error), from_the_end(fastest, least)}, points, target);
  const Crossing high =
      crossing_of({from_the_end(error, largest), from_the_end(slowest, least)}, points, target);
  Cost out{value.cost, low.cost, high.cost, value.at_most};
  // A coarser level that was not tried, or a level between the last failed and the first successful one,
  // might be cheaper.
  if (low.at_most && low.level == 0 && !points[0].behind_failure && !ladder.coarsest_tried) out.low = 0.0;
  if (low.at_most && points[low.level].behind_failure && ladder.setting_name != "rtol")
    out.low *= points[low.level].setting / points[low.level].failed_before;
  return out;
}

std::string cost_text(const Cost& cost) { return (cost.at_most ? "<= " : "") + short_number(cost.value); }

std::string spread_text(const Cost& cost) {
  if (std::isnan(cost.value)) return "-";
  if (cost.low == cost.high) return short_number(cost.low);
  if (!(cost.low > 0.0) && std::isnan(cost.high)) return "-";
  return fmt::format("{} to {}", cost.low > 0.0 ? short_number(cost.low) : "?",
                     std::isnan(cost.high) ? "?" : short_number(cost.high));
}

std::vector<Winner> winners(const Table& compare, const std::string& error_column,
                            const std::string& cost_column, const std::vector<double>& targets,
                            double reference_error) {
  const std::vector<Ladder> all = ladders(compare, error_column, cost_column);
  std::vector<Winner> out;
  for (const double target : targets) {
    Winner win;
    win.target = target;
    win.resolved = target >= kResolved * reference_error;
    std::vector<std::pair<Cost, const Ladder*>> reached;
    for (const Ladder& ladder : all)
      if (const Cost cost = cost_at(ladder, target, reference_error); !std::isnan(cost.value))
        reached.emplace_back(cost, &ladder);
    std::stable_sort(reached.begin(), reached.end(),
                     [](const auto& a, const auto& b) { return a.first.value < b.first.value; });
    const auto ratio_to = [&](const Cost& cost) {
      const Cost& best = reached.front().first;
      return CostRatio{cost.value / best.value, cost.low / best.high, cost.high / best.low};
    };
    if (!reached.empty()) {
      win.found = true;
      win.label = reached.front().second->label;
      win.cost = reached.front().first;
      for (std::size_t i = 1; i < reached.size(); ++i) {
        if (i == 1) {
          win.runner_up = reached[i].second->label;
          win.runner_up_ratio = ratio_to(reached[i].first);
        }
        if (!(reached[i].first.low > win.cost.high)) win.rivals.push_back(reached[i].second->label);
      }
      for (const auto& [cost, ladder] : reached)
        if (ladder->integrator == kBaseline && !(cost.value >= win.baseline_ratio.value * win.cost.value))
          win.baseline_ratio = ratio_to(cost);
    }
    out.push_back(win);
  }
  return out;
}

std::vector<std::string> winner_row(const Winner& win, double shown, const std::string& ranked) {
  const std::string none = win.resolved ? "not reached" : "not resolved by the reference";
  return {fmt::format("{:g}", shown),
          win.found ? ranked : none,
          cost_text(win.cost),
          spread_text(win.cost),
          win.runner_up.empty() ? "-" : win.runner_up,
          ratio_text(win.runner_up_ratio),
          ratio_text(win.baseline_ratio)};
}

std::string ratio_text(const CostRatio& ratio) {
  if (!std::isfinite(ratio.value)) return "-";
  const auto number = [](double value) {
    return value < 9.95 ? fmt::format("{:.2f}", value) : fmt::format("{:.0f}", value);
  };
  if (ratio.low == ratio.high || !std::isfinite(ratio.low)) return number(ratio.value);
  return fmt::format("{} ({} to {})", number(ratio.value), number(ratio.low),
                     std::isfinite(ratio.high) ? number(ratio.high) : "?");
}

}  // namespace palpate::report
