#include "session/reference_remarks.h"

#include <fmt/format.h>

namespace palpate::session {
namespace {

using compare::share_of_peak;

std::string line_of(const char* what, double rms, double max, double peak, const char* unit) {
  if (!(peak > compare::kLeastPeak))
    return fmt::format("{} {:.3g} {} RMS (the reference has none)", what, rms, unit);
  return fmt::format("{} {:.3g} {} RMS ({:.3g} % of the peak of {:.4g}), at most {:.3g} ({:.3g} %)", what,
                     rms, unit, 100.0 * share_of_peak(rms, peak), peak, max,
                     100.0 * share_of_peak(max, peak));
}

void add_lines(const std::string& whose, const compare::HandError& felt, std::vector<std::string>& out) {
  const compare::TrajectoryError& e = felt.error;
  out.push_back(whose + line_of("force error", e.force_rms_n, e.force_max_n, felt.peak_force_n, "N"));
  if (felt.peak_torque_n_m == 0.0 && e.torque_max_n_m <= felt.torque_rounding_n_m)
    out.push_back(whose + "no torque, in either");
  else
    out.push_back(whose +
                  line_of("torque error", e.torque_rms_n_m, e.torque_max_n_m, felt.peak_torque_n_m, "N m"));
}

}  // namespace

std::vector<std::string> reference_remarks(const scene::Description& description,
                                           const compare::AgainstReference& against) {
  std::vector<std::string> out;
  if (!against.trouble.empty() || against.stopped) return out;
  const std::string what = fmt::format("against {}{}: ", against.made_by,
                                       against.recorded_hand ? ", with the recorded motion of the hand" : "");
  add_lines(what, against, out);
  for (std::size_t i = 0; i < against.more_hands.size(); ++i)
    add_lines(fmt::format("{}hand {}: ", what, description.hands[i].name), against.more_hands[i], out);
  return out;
}

}  // namespace palpate::session
