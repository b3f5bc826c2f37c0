#include "against_monolithic.h"

#include <fmt/format.h>

#include "cli/progress.h"
#include "cli/stop.h"

namespace palpate::cli {
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
  out.push_back(whose +
                line_of("torque error", e.torque_rms_n_m, e.torque_max_n_m, felt.peak_torque_n_m, "N m"));
}

}  // namespace

compare::AgainstMonolithic against_monolithic(const loop::World& world,
                                              const std::vector<loop::HapticRecord>& records,
                                              bool real_time) {
  compare::AgainstMonolithic out;
  {
    Progress progress("computing the monolithic solution");
    out = compare::against_monolithic(
        world, records, real_time, [&progress](double fraction) { progress(fraction); }, &stop_flag());
  }
  for (const std::string& line : against_monolithic_remarks(world.description, out)) fmt::print("{}\n", line);
  return out;
}

std::vector<std::string> against_monolithic_remarks(const scene::Description& description,
                                                    const compare::AgainstMonolithic& against) {
  std::vector<std::string> out;
  if (!against.trouble.empty() || against.stopped) return out;
  const std::string what = fmt::format("against {}{}: ", against.made_by,
                                       against.recorded_hand ? ", with the recorded motion of the hand" : "");
  add_lines(what, against, out);
  for (std::size_t i = 0; i < against.more_hands.size(); ++i)
    add_lines(fmt::format("{}hand {}: ", what, description.hands[i].name), against.more_hands[i], out);
  return out;
}

}  // namespace palpate::cli
