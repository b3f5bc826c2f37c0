// Text that would exceed the stack of the TOML parser, and values that no double can represent or that a
// terminal must not receive.
#include <gtest/gtest.h>

#include "messages.h"
#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "scene/scene_texts.h"
#include "scene/study.h"

using palpate::expectations::expect_contains;
using palpate::expectations::message_of;
using palpate::loop::parse;

namespace {

std::string repeated(const std::string& text, int times) {
  std::string out;
  for (int i = 0; i < times; ++i) out += text;
  return out;
}

std::string refusal(const std::string& text) {
  return message_of([&] { parse(text, "s.toml", {}); });
}
std::string refusal_of_override(const std::string& text) {
  return message_of([&] { parse(scene_texts::kWhole, "s.toml", {text}); });
}

TEST(TomlBounds, DepthIsBoundedBeforeTheParser) {
  for (const int depth : {17, 100, 200'000}) {
    for (const std::string& text :
         {"a = " + repeated("[", depth), "a = " + repeated("[", depth) + repeated("]", depth),
          "a = " + repeated("{b = ", depth), "\n# [[[\na = [1,\n" + repeated("{ b = [", depth)}) {
      const std::string message = refusal(text);
      expect_contains(message, "s.toml:");
      expect_contains(message, "nest deeper than 16");
      expect_contains(refusal_of_override(text), "nest deeper than 16");
    }
  }
}

TEST(TomlBounds, KeysAreBoundedInPartsAndBytes) {
  for (const int parts : {17, 100'000}) {
    const std::string dotted = repeated("a.", parts - 1) + "a";
    for (const std::string& text : {dotted + " = 1", "[" + dotted + "]", "[[" + dotted + "]]",
                                    "[x]\ny = {" + dotted + " = 1}", "y = [{z = 1, " + dotted + " = 1}]"})
      expect_contains(refusal(text), "a key ");
    expect_contains(refusal_of_override(dotted + "=1"), "a key ");
  }
  for (const int bytes : {257, 1'000'000}) {
    const std::string key(static_cast<std::size_t>(bytes), 'k');
    for (const std::string& text :
         {key + " = 1", key, "\"" + key + "\" = 1", "'" + key + "' = 1", "[" + key + "]", "[\"" + key + "\"]",
          "[x]\n" + key + " = 1", "y = {" + key + " = 1}", "y = [{z = 1, \"" + key + "\" = 1}]"})
      expect_contains(refusal(text), "a key is longer than 256 bytes");
    expect_contains(refusal_of_override(key + "=1"), "a key is longer than 256 bytes");
    EXPECT_LT(refusal_of_override(key + "=1").size(), 600u) << "the message does not repeat all of it";
  }
}

TEST(TomlBounds, ValuesAndCommentsAreNotKeys) {
  const std::string text = repeated("x.y[{=", 200);
  for (const std::string& harmless :
       {"# " + text + "\n", "note = \"" + text + "\" # " + text + "\n", "note = '" + text + "'\n",
        "note = \"a \\\" " + text + "\"\n", "note = \"\"\"\n\"" + text + "\n\"\"\"\n",
        "note = '''\n''" + text + "'''\n", "note = [1.5, 2.5, \"" + text + "\",\n\"" + text + "\"]\n"})
    for (const std::string& message : {refusal(harmless + "nonsense_key = 1\n")}) {
      EXPECT_EQ(message.find("nest deeper"), std::string::npos) << message;
      EXPECT_EQ(message.find("a key "), std::string::npos) << message;
      EXPECT_NE(message, "");
    }
}

TEST(TomlBounds, WholeNumbersBeyondTwoToThe53AreRefused) {
  using Case = std::pair<const char*, const char*>;
  for (const auto& [key, what] :
       {Case{"scene.duration_s", "duration_s"}, Case{"body.0.youngs_modulus_pa", "youngs_modulus_pa"},
        Case{"integrator.max_steps", "max_steps"}, Case{"integrator.threads", "threads"}})
    for (const char* value : {"9007199254740993", "-9007199254740993", "9007199254740994",
                              "9223372036854775807", "-9223372036854775808", "0x7fffffffffffffff"}) {
      const std::string message = refusal_of_override(std::string(key) + "=" + value);
      expect_contains(message, std::string("--set ") + key);
      expect_contains(message, "must be at most 9007199254740992 (2^53)");
      expect_contains(message, what);
    }
  expect_contains(refusal_of_override("scene.gravity_m_s2=[0, 0, 9007199254740993]"), "2^53");
  expect_contains(refusal_of_override("body.0.position_m=[1, 9007199254740993, 1]"), "2^53");
  expect_contains(refusal("[scene]\nname = \"s\"\nduration_s = 9007199254740993\n"),
                  "s.toml:3:14: duration_s = 9007199254740993");
  EXPECT_EQ(parse(scene_texts::kWhole, "s.toml", {"body.0.youngs_modulus_pa=9007199254740992"})
                .bodies[0]
                .youngs_modulus_pa,
            9007199254740992.0);
  EXPECT_EQ(
      parse(scene_texts::kWhole, "s.toml", {"body.0.youngs_modulus_pa=1e16"}).bodies[0].youngs_modulus_pa,
      1e16);
}

TEST(TomlBounds, HoldForStudiesToo) {
  const auto refusal_of_study = [](const std::string& text) {
    return message_of([&] { palpate::scene::parse_study(text, "s.toml"); });
  };
  const std::string study = "[study]\nscenes = [\"one-tet\"]\n";
  expect_contains(refusal_of_study(study + "limit_s = 9007199254740993\n"),
                  "s.toml:3:11: limit_s = 9007199254740993");
  expect_contains(refusal_of_study(study + "[[sweep]]\nkey = \"a\"\nvalues = [1, 9007199254740993]\n"),
                  "2^53");
  expect_contains(refusal_of_study(study + "[[random]]\nkey = \"a\"\nmin = -9007199254740993\n"), "2^53");
  expect_contains(refusal_of_study("a = " + repeated("[", 100'000)), "nest deeper");
}

TEST(TomlBounds, TextsAreOneLineWithoutControlCharacters) {
  for (const char* text : {"a\\u001b[31m", "a\\u0007", "a\\nb", "a\\r", "a\\u007f", "a\\u0085"}) {
    expect_contains(refusal_of_override(std::string("scene.name=\"") + text + "\""),
                    "must be one line without control characters");
    expect_contains(refusal_of_override(std::string("body.0.mesh.file=\"") + text + "\""),
                    "control characters");
  }
  EXPECT_EQ(parse(scene_texts::kWhole, "s.toml", {"scene.name=\"caf\\u00e9 \\u96ea\""}).name,
            "caf\xc3\xa9 \xe9\x9b\xaa");
}

}  // namespace
