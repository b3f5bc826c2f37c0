// Cost of a contact query between two deforming skins, compared with alternative libraries in one run on one
// thread: palpate from positions of nodes to forces on nodes, the others from positions of nodes to contacts
// or depths. The motion of a scene is recorded first; then all contenders are queried at the same states, one
// after the other, in rounds. For each library the fastest way is compared.
//
//   contact_peers [--once] [SCENE...]     --once: one state and one round, to check that all of them run
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>

#include "contact/gpu_device.h"
#include "contender.h"
#include "core/clock.h"
#include "palpate/core/error.h"
#include "report/table.h"

namespace peers {
namespace {

/// Time after which a contender skips the remaining rounds [s].
constexpr double kEnough = 4.0;

struct Options {
  int rounds = 9;  ///< After one untimed round.
  bool one_state = false;
};

struct Timed {
  std::vector<double> ms;     ///< Over all states and rounds.
  std::vector<double> least;  ///< Least over the rounds, per state.
  double contacts = 0.0, deepest = 0.0;
  double spent_s = 0.0;
};

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const auto at = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size()))) - 1;
  return values[std::min(at, values.size() - 1)];
}

std::vector<Timed> measure(const Motion& motion, const Contenders& contenders, int rounds) {
  std::vector<Timed> out(contenders.size());
  for (Timed& t : out) t.least.assign(motion.states.size(), INFINITY);
  for (int round = 0; round <= rounds; ++round)
    for (std::size_t c = 0; c < contenders.size(); ++c) {
      if (round > 1 && out[c].spent_s > kEnough) continue;
      for (std::size_t s = 0; s < motion.states.size(); ++s) {
        const double start = wall_seconds();
        contenders[c]->query(motion.states[s]);
        const double ms = 1e3 * (wall_seconds() - start);
        out[c].spent_s += 1e-3 * ms;
        if (round == 0) {  // Patterns and memory are created.
          const Found found = contenders[c]->found();
          out[c].contacts += static_cast<double>(found.contacts) / static_cast<double>(motion.states.size());
          out[c].deepest = std::max(out[c].deepest, found.deepest);
        } else {
          out[c].ms.push_back(ms);
          out[c].least[s] = std::min(out[c].least[s], ms);
        }
      }
    }
  return out;
}

/// Returns the median over the states of the ratio of run times.
double times(const Timed& of, const Timed& over) {
  std::vector<double> ratios(of.least.size());
  for (std::size_t s = 0; s < ratios.size(); ++s) ratios[s] = of.least[s] / over.least[s];
  return quantile(ratios, 0.5);
}

void run(const std::string& scene, const Options& options) {
  Motion motion = record_motion(scene);
  if (options.one_state) motion.states = {motion.states[motion.states.size() / 2]};
  Contenders contenders;
  add_distance(motion, contenders);
  if (contact::gpu_available()) add_image(motion, contenders);
  add_gimpact(motion, contenders);
  add_fcl(motion, contenders);
  add_cgal(motion, contenders);
  add_skins_alone(motion, contenders);
  const std::vector<Timed> timed = measure(motion, contenders, options.rounds);
  std::vector<std::vector<std::string>> rows;
  std::map<std::string, double> fastest;
  for (std::size_t c = 0; c < contenders.size(); ++c) {
    const Timed& t = timed[c];
    const double ratio = times(t, timed.front());
    rows.push_back({contenders[c]->group(), contenders[c]->name(),
                    fmt::format("{:.2f} / {:.2f} / {:.2f}", quantile(t.ms, 1e-9), quantile(t.ms, 0.5),
                                quantile(t.ms, 0.99)),
                    fmt::format("{:.2f}", ratio), fmt::format("{:.0f}", t.contacts),
                    fmt::format("{:.2e}", t.deepest)});
    if (contenders[c]->group() == "palpate" || contenders[c]->group().empty()) continue;
    const auto [at, is_new] = fastest.try_emplace(contenders[c]->group(), ratio);
    if (!is_new) at->second = std::min(at->second, ratio);
  }
  fmt::print(
      "{}: two skins of {} vertices and {} triangles in all, {} states in contact, up to {} rounds\n{}\n",
      motion.description.name, motion.vertices(), motion.triangles(), motion.states.size(), options.rounds,
      report::format_table(
          {"", "", "query: least / median / p99 [ms]", "times palpate at 1e-2", "contacts", "deepest [m]"},
          rows));
  for (const auto& [group, ratio] : fastest)
    fmt::print("  {}: its fastest way takes {:.1f} times as long as palpate at an error of 1e-2\n", group,
               ratio);
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace
}  // namespace peers

int main(int argc, char** argv) {
  try {
    peers::Options options;
    std::vector<std::string> scenes(argv + 1, argv + argc);
    if (std::erase(scenes, "--once") > 0) options = {.rounds = 1, .one_state = true};
    if (scenes.empty())
      for (const char* name : {"two-pumpkins", "two-heads", "gears"})
        scenes.push_back(fmt::format("{}/{}.toml", PALPATE_SCENES_FOLDER, name));
    for (const std::string& scene : scenes) peers::run(scene, options);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
