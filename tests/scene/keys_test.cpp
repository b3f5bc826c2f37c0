// Every field of a spec must have a key: a field that no scene can set would be dead.
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>

#include "palpate/loop/load.h"
#include "scene/scene_texts.h"

namespace {

/// Fields whose keys have another name, and the two that a file cannot set.
const std::map<std::string, std::string> kOtherNames = {{"bodies", "body"},
                                                        {"others", "joints"},
                                                        {"changes", "change"},
                                                        {"bones", "bone"},
                                                        {"region", ""},
                                                        {"friction_retardation_s", ""},
                                                        {"regions", "region"},
                                                        {"obstacles", "obstacle"},
                                                        {"hands", "hand"},
                                                        {"contacts", "contact"},
                                                        {"keyframes", "keyframe"},
                                                        {"motions", "motion"},
                                                        {"presses", "press"},
                                                        {"number", "switch"},
                                                        {"attachments", "attachment"},
                                                        {"loads", "load"},
                                                        {"ladders", "ladder"},
                                                        {"first", "between"},
                                                        {"second", "between"},
                                                        {"values", "rtol"},
                                                        {"setting", "step_s"},
                                                        {"path", ""},
                                                        {"source", ""},
                                                        {"not_carried_over", ""}};

std::set<std::string> last_parts(const std::vector<std::string>& keys) {
  std::set<std::string> out;
  for (const std::string& key : keys) out.insert(key.substr(key.rfind('.') + 1));
  return out;
}

TEST(Keys, EveryFieldOfEverySpecHasOne) {
  const std::set<std::string> known = last_parts(palpate::scene::known_keys(palpate::loop::kinds()));
  const std::regex field(R"(^  [A-Za-z:<>_]+ ([a-z_0-9]+)( = [^;(]+(\(.*\))?)?;)");
  int fields = 0;
  for (const char* header : {"mesh/spec.h", "fem/spec.h", "contact/spec.h", "tool/spec.h", "device/spec.h",
                             "dynamics/spec.h", "store/spec.h", "scene/description.h"}) {
    std::istringstream in(scene_texts::read(std::string(PALPATE_SOURCE_DIR "/include/palpate/") + header));
    for (std::string line; std::getline(in, line);) {
      std::smatch match;
      if (!std::regex_search(line, match, field)) continue;
      ++fields;
      const auto other = kOtherNames.find(match[1]);
      const std::string key = other == kOtherNames.end() ? match[1].str() : other->second;
      EXPECT_TRUE(key.empty() || known.contains(key))
          << header << ": " << match[1] << " has no key; add it to src/scene/keys*.cpp";
    }
  }
  EXPECT_GE(fields, 90) << "the pattern no longer finds the fields";
}

/// Checks the data behind every row of the generated documentation.
TEST(Keys, EachSaysItsUnitDefaultAndMeaning) {
  int units = 0, defaults = 0;
  std::set<std::string> seen;
  const auto rows = palpate::scene::key_rows(palpate::loop::kinds());
  EXPECT_GT(rows.size(), 130u);
  for (const auto& row : rows) {
    const std::string name =
        row.table + "." + row.name + " of " + fmt::format("{}", fmt::join(row.users, " "));
    EXPECT_TRUE(seen.insert(name).second) << name << " twice";
    EXPECT_GE(row.meaning.size(), 8u) << name;
    EXPECT_LE(row.meaning.size(), 100u) << name;
    EXPECT_NE(row.meaning.back(), '.') << name << ": a phrase, no sentence";
    EXPECT_FALSE(row.type.empty()) << name;
    const bool number = row.type.find("number") != std::string::npos && row.type != "whole number";
    static const std::regex unit_suffix("_(m|s|n|kg|pa|rad|m2|m3|s2)$");
    const bool has_suffix = std::regex_search(row.name, unit_suffix);
    EXPECT_EQ(number && has_suffix, !row.unit.empty()) << name << " in \"" << row.unit << '"';
    units += !row.unit.empty();
    EXPECT_FALSE(row.required && !row.fallback.empty()) << name;
    if (!row.is_value) continue;
    ++defaults;
    ASSERT_TRUE(row.read_back) << name;
    EXPECT_EQ(row.read_back(row.fallback), row.fallback) << name;
  }
  EXPECT_GT(units, 50);
  EXPECT_GT(defaults, 60);
}

/// A key of an option reads each of its names into the value of that name.
TEST(Keys, OptionsReadEveryNameTheyList) {
  int names = 0;
  for (const auto& row : palpate::scene::key_rows(palpate::loop::kinds())) {
    if (row.type != "text" || !row.is_value || !row.read_back) continue;
    static const std::regex quoted("\"[^\"]*\"");
    for (std::sregex_iterator at(row.range.begin(), row.range.end(), quoted), end; at != end; ++at, ++names)
      EXPECT_EQ(row.read_back(at->str()), at->str()) << row.table << '.' << row.name;
  }
  EXPECT_GT(names, 30);
}

TEST(Keys, DefaultsAreThoseOfTheSpecs) {
  const auto rows = palpate::scene::key_rows(palpate::loop::kinds());
  const auto row = [&](const std::string& table, const std::string& name) {
    for (const auto& one : rows)
      if (one.table == table && one.name == name) return one;
    ADD_FAILURE() << table << "." << name;
    return rows.front();
  };
  EXPECT_EQ(row("integrator", "spectral_radius").fallback,
            fmt::format("{}", palpate::IntegratorSpec{}.spectral_radius));
  EXPECT_EQ(row("integrator", "spectral_radius").range, "[0, 1]");
  EXPECT_EQ(row("integrator", "spectral_radius").users, std::vector<std::string>{"generalized-alpha"});
  EXPECT_EQ(row("contact", "stiffness_pa_m").unit, "Pa/m");
  EXPECT_EQ(row("device", "max_torque_n_m").unit, "N m");
  EXPECT_EQ(row("tool.coupling", "stiffness_n_m").unit, "N/m");
  EXPECT_EQ(row("device", "max_torque_n_m").unit, "N m");
  EXPECT_EQ(row("body", "mass").fallback, "\"lumped\"");
  EXPECT_EQ(row("body", "mass").range, "\"lumped\", \"consistent\"");
  EXPECT_EQ(row("obstacle", "normal").fallback, "[0.0, 0.0, 1.0]");
  EXPECT_EQ(row("obstacle", "normal").users, std::vector<std::string>{"plane"});
  EXPECT_TRUE(row("body", "youngs_modulus_pa").required);
  EXPECT_EQ(row("body.mesh", "generator").range, "\"box\", \"ball\", \"cylinder\", \"tet\"");
  EXPECT_TRUE(row("body.mesh", "size_m").required) << "by all that use it";
  EXPECT_FALSE(row("body.mesh", "grading").required);
  EXPECT_TRUE(row("device", "keyframe").required);
  EXPECT_EQ(row("exchange", "contact_refresh_s").fallback, "exchange_period_s");
  EXPECT_EQ(row("body.skeleton.joint.keyframe", "time_s").unit, "s");
}

TEST(Keys, AreListedDotted) {
  const auto keys = palpate::scene::known_keys(palpate::loop::kinds());
  for (const char* key : {"scene.name", "body.mesh.radius_m", "body.attachment.keyframe.time_s",
                          "tool.coupling.stiffness_n_m", "compare.ladder.step_s"})
    EXPECT_NE(std::find(keys.begin(), keys.end(), key), keys.end()) << key;
}

}  // namespace
