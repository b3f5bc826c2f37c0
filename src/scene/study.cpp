#include "scene/study.h"
#include "palpate/core/named_enum.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>
#include <set>

#include "palpate/core/error.h"
#include "scene/read_text.h"
#include "scene/study_keys.h"

namespace palpate::scene {
namespace {

constexpr int kMostRedraws = 1000;

/// Keys of a scene that are varied by these keys of [study] instead of a [[sweep]].
const std::vector<std::pair<std::string, std::string>>& keys_of_their_own() {
  static const std::vector<std::pair<std::string, std::string>> all = {{"integrator.name", "integrators"},
                                                                       {"scene.duration_s", "duration_s"}};
  return all;
}

/// Rounds a value for readability: six significant digits, exactly the value that the scene gets.
double rounded(double value) { return std::stod(fmt::format("{:.6g}", value)); }

class Checker {
 public:
  explicit Checker(const Document& document) : document_(document) {}

  void check(StudySpec& spec) {
    if (spec.scenes.empty()) refuse_at("study.scenes", "study", "scenes must list at least one scene");
    no_doubles("study.scenes", "scenes", spec.scenes);
    no_doubles("study.integrators", "integrators", spec.integrators);
    no_doubles("study.rtol", "rtol", spec.rtol);
    no_doubles("study.step_s", "step_s", spec.step_s);
    no_doubles("study.seeds", "seeds", spec.seeds);
    std::set<std::string> keys;
    for (std::size_t i = 0; i < spec.sweeps.size(); ++i) sweep(spec, i, keys);
    for (std::size_t i = 0; i < spec.randoms.size(); ++i) random(spec, i, keys);
    if (!spec.randoms.empty() && spec.seeds.empty())
      refuse_at("study", "study", "seeds is missing: each seed draws a value for every [[random]] key");
    if (spec.randoms.empty() && !spec.seeds.empty())
      refuse_at("study.seeds", "study",
                "seeds without a [[random]] key would repeat identical runs; use repeats to repeat runs for "
                "timing");
  }

 private:
  [[noreturn]] void refuse_at(const std::string& at, const std::string& where, const std::string& what) {
    refuse(location(document_, at), where, what);
  }

  template <class Item>
  void no_doubles(const std::string& at, const char* key, const std::vector<Item>& items) {
    std::set<Item> met;
    for (const Item& one : items)
      if (!met.insert(one).second) refuse_at(at, "study", fmt::format("{} has {} twice", key, one));
  }

  void own_key(const std::string& at, const std::string& where, const StudySpec& spec, const std::string& key,
               std::set<std::string>& keys) {
    if (!keys.insert(key).second) refuse_at(at, where, fmt::format("key \"{}\" is varied twice", key));
    for (const auto& [of_scene, of_study] : keys_of_their_own())
      if (key == of_scene)
        refuse_at(at, where, fmt::format("key \"{}\": set {} in [study] instead", key, of_study));
    const bool listed = (key == "integrator.rtol" && !spec.rtol.empty()) ||
                        (key == "integrator.step_s" && !spec.step_s.empty());
    if (listed) refuse_at(at, where, fmt::format("key \"{}\" is varied twice: [study] lists it too", key));
  }

  void sweep(StudySpec& spec, std::size_t i, std::set<std::string>& keys) {
    SweepSpec& s = spec.sweeps[i];
    const std::string at = fmt::format("sweep[{}]", i), where = fmt::format("sweep of \"{}\"", s.key);
    own_key(at + ".key", where, spec, s.key, keys);
    const bool range = s.from || s.to || s.count > 0;
    if (range && !s.values.empty())
      refuse_at(at + ".values", where, "values, and from, to and count, exclude each other");
    if (range && !(s.from && s.to && s.count > 0)) refuse_at(at, where, "from, to and count belong together");
    if (!range && s.values.empty()) refuse_at(at, where, "give values = [...], or from, to and count");
    if (range) fill(s, at, where);
    std::set<std::string> met;
    for (const std::string& value : s.values)
      if (!met.insert(value).second && !s.together && !moves_with_next(spec, i))
        refuse_at(at, where, fmt::format("the value {} is given twice", value));
    if (!s.together) return;
    if (i == 0) refuse_at(at + ".together", where, "together needs a [[sweep]] before it");
    if (const std::size_t before = spec.sweeps[i - 1].values.size(); before != s.values.size())
      refuse_at(at + ".together", where,
                fmt::format("together with \"{}\", which has {} values, requires as many values, not {}",
                            spec.sweeps[i - 1].key, before, s.values.size()));
  }

  static bool moves_with_next(const StudySpec& spec, std::size_t i) {
    return i + 1 < spec.sweeps.size() && spec.sweeps[i + 1].together;
  }

  void fill(SweepSpec& s, const std::string& at, const std::string& where) {
    const bool log = s.spacing == Spacing::kLog;
    if (log && !(*s.from > 0.0 && *s.to > 0.0))
      refuse_at(at, where, "from and to must be positive where spacing = \"log\"");
    for (int i = 0; i < s.count; ++i) {
      const double part = i / static_cast<double>(s.count - 1);
      const double value = i == 0             ? *s.from
                           : i == s.count - 1 ? *s.to
                           : log              ? rounded(*s.from * std::pow(*s.to / *s.from, part))
                                              : rounded(*s.from + (*s.to - *s.from) * part);
      s.values.push_back(palpate::to_toml(value));
    }
  }

  void random(const StudySpec& spec, std::size_t i, std::set<std::string>& keys) {
    const RandomSpec& r = spec.randoms[i];
    const std::string at = fmt::format("random[{}]", i), where = fmt::format("random \"{}\"", r.key);
    own_key(at + ".key", where, spec, r.key, keys);
    if (r.min && r.max && !(*r.min < *r.max)) refuse_at(at + ".max", where, "max must be greater than min");
    if (r.distribution == Distribution::kNormal) {
      if (!r.mean || !r.standard_deviation)
        refuse_at(at, where, "a normal distribution needs mean and standard_deviation");
      return;
    }
    if (!r.min || !r.max)
      refuse_at(at, where, fmt::format("a {} distribution needs min and max", name_of(r.distribution)));
    if (r.mean || r.standard_deviation)
      refuse_at(at, where, "mean and standard_deviation belong to distribution = \"normal\"");
    if (r.distribution == Distribution::kLogUniform && !(*r.min > 0.0))
      refuse_at(at + ".min", where, "min must be positive where distribution = \"log-uniform\"");
  }

  const Document& document_;
};

/// Returns a number in [0, 1) with 53 bits; std::uniform_real_distribution differs between libraries.
double unit(std::mt19937_64& engine) { return std::ldexp(static_cast<double>(engine() >> 11), -53); }

/// Draws from the standard normal distribution, by Box and Muller (1958).
double standard_normal(std::mt19937_64& engine) {
  constexpr double kTwoPi = 6.283185307179586;
  const double radius = std::sqrt(-2.0 * std::log(1.0 - unit(engine)));
  return radius * std::cos(kTwoPi * unit(engine));
}

}  // namespace

StudySpec parse_study(const std::string& text, const std::string& path) {
  const Document document = parse_document(text, path, {});
  StudySpec spec;
  read_table(document.root, "", study_file_keys(), spec);
  spec.path = path;
  spec.text = text;
  if (spec.name.empty()) spec.name = std::filesystem::path(path).stem().string();
  Checker(document).check(spec);
  return spec;
}

StudySpec load_study(const std::string& path) {
  return parse_study(read_text_file(path, "study", "a study is a TOML file: `palpate help studies`"), path);
}

std::vector<KeyRow> study_key_rows() { return rows_of("", study_file_keys()); }

std::string drawn_value(const RandomSpec& r, int seed) {
  std::vector<std::uint32_t> words = {static_cast<std::uint32_t>(seed)};
  for (const char c : r.key) words.push_back(static_cast<unsigned char>(c));
  std::seed_seq sequence(words.begin(), words.end());
  std::mt19937_64 engine(sequence);
  if (r.distribution != Distribution::kNormal) {
    const double u = unit(engine);
    const double value = r.distribution == Distribution::kUniform ? *r.min + (*r.max - *r.min) * u
                                                                  : *r.min * std::pow(*r.max / *r.min, u);
    return palpate::to_toml(std::clamp(rounded(value), *r.min, *r.max));
  }
  for (int i = 0; i < kMostRedraws; ++i) {
    const double value = rounded(*r.mean + *r.standard_deviation * standard_normal(engine));
    if ((!r.min || value >= *r.min) && (!r.max || value <= *r.max)) return palpate::to_toml(value);
  }
  fail("random \"{}\": none of {} draws falls between min and max; widen them, or move the mean", r.key,
       kMostRedraws);
}

}  // namespace palpate::scene
