#include "experiments/compare/summary.h"

#include <algorithm>

#include "palpate/scene/hands.h"

namespace palpate::compare {
namespace {

store::SummaryFields error_row(const std::string& hand, const HandError& felt) {
  const TrajectoryError& e = felt.error;
  return {{"hand", hand},
          {"force_error_rms_n", e.force_rms_n},
          {"force_error_max_n", e.force_max_n},
          {"force_error_rms_of_peak", share_of_peak(e.force_rms_n, felt.peak_force_n)},
          {"reference_peak_force_n", felt.peak_force_n},
          {"torque_error_rms_n_m", e.torque_rms_n_m},
          {"torque_error_max_n_m", e.torque_max_n_m},
          {"torque_error_rms_of_peak", share_of_peak(e.torque_rms_n_m, felt.peak_torque_n_m)},
          {"reference_peak_torque_n_m", felt.peak_torque_n_m}};
}

}  // namespace

void add_to_summary(store::Summary& summary, const scene::Description& description,
                    const AgainstReference& against, const std::string& name) {
  store::SummaryFields& reference = summary.section(name + "_reference").values;
  reference = {{"made_by", against.made_by}, {"cpu_s", against.cpu_s}};
  if (!against.trouble.empty()) {
    reference.emplace_back("trouble", against.trouble);
    return;
  }
  const std::vector<scene::Hand> hands = scene::hands_of(description);
  std::vector<store::SummaryFields>& rows = summary.list("against_" + name);
  rows.push_back(error_row(hands[0].name, against));
  for (std::size_t i = 0; i < against.more_hands.size(); ++i)
    rows.push_back(error_row(hands[i + 1].name, against.more_hands[i]));
}

void add_to_summary(store::Summary& summary, const scene::Description& description,
                    const HapticComparison& c) {
  const TrajectoryError& error = c.reference.own_error;
  store::SummaryFields& reference = summary.section("monolithic_reference").values;
  reference = {{"made_by", c.reference.description},     {"cpu_s", c.reference.cpu_s},
               {"peak_force_n", c.peak_force_n},         {"peak_torque_n_m", c.peak_torque_n_m},
               {"force_error_rms_n", error.force_rms_n}, {"torque_error_rms_n_m", error.torque_rms_n_m}};
  if (!c.reference.trouble.empty()) reference.emplace_back("trouble", c.reference.trouble);
  for (const HapticOrder& order : c.orders)
    summary.list("observed_orders")
        .push_back({{"variable", order.variable},
                    {"force_order", order.force},
                    {"force_points", static_cast<long long>(order.force_points)},
                    {"torque_order", order.torque},
                    {"torque_points", static_cast<long long>(order.torque_points)}});
  const auto own = std::find_if(c.points.begin(), c.points.end(),
                                [](const HapticPoint& p) { return p.own && p.status == Status::kOk; });
  if (own == c.points.end()) return;
  store::SummaryFields row =
      error_row(scene::hands_of(description).front().name, {own->error, c.peak_force_n, c.peak_torque_n_m});
  row.emplace_back("cpu_s", own->cpu_median_s);
  summary.list("against_monolithic").push_back(std::move(row));
}

}  // namespace palpate::compare
