// A field of a spec that no scene could set would be a dead field: every one must have its key.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>

#include "palpate/scene/load.h"
#include "scene/scene_texts.h"

namespace {

/// Fields whose keys go by another name, and the two that a file cannot set.
const std::map<std::string, std::string> kOtherNames = {
    {"bodies", "body"},
    {"others", "joints"},
    {"changes", "change"},
    {"bones", "bone"},
    {"region", ""},
    {"regions", "region"},
    {"obstacles", "obstacle"},
    {"contacts", "contact"},
    {"coupling", "exchange"},
    {"keyframes", "keyframe"},
    {"attachments", "attachment"},
    {"loads", "load"},
    {"ladders", "ladder"},
    {"first", "between"},
    {"second", "between"},
    {"values", "rtol"},
    {"setting", "step_s"},
    {"path", ""},
    {"source", ""},
    {"coupling_stiffness_n_m", "stiffness_n_m"},
    {"coupling_damping_n_s_m", "damping_n_s_m"},
    {"coupling_rotational_stiffness_n_m_rad", "rotational_stiffness_n_m_rad"},
    {"coupling_rotational_damping_n_m_s_rad", "rotational_damping_n_m_s_rad"}};

std::set<std::string> last_parts(const std::vector<std::string>& keys) {
  std::set<std::string> out;
  for (const std::string& key : keys) out.insert(key.substr(key.rfind('.') + 1));
  return out;
}

TEST(Keys, EveryFieldOfEverySpecHasOne) {
  const std::set<std::string> known = last_parts(palpate::scene::known_keys());
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

TEST(Keys, AreListedDotted) {
  const auto keys = palpate::scene::known_keys();
  for (const char* key : {"scene.name", "body.mesh.radius_m", "body.attachment.keyframe.time_s",
                          "tool.coupling.stiffness_n_m", "compare.ladder.step_s"})
    EXPECT_NE(std::find(keys.begin(), keys.end(), key), keys.end()) << key;
}

}  // namespace
