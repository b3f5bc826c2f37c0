// Damaged scenes: each is read or rejected by palpate::Error, without any other outcome.
#include <gtest/gtest.h>

#include <random>

#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "scene/scene_texts.h"

namespace {

const char* const kFragments[] = {"[",          "]",
                                  "[[",         "]]",
                                  "=",          "\"",
                                  "'''",        "\n",
                                  ",",          ".",
                                  "{",          "}",
                                  "nan",        "-inf",
                                  "1e999",      "0x",
                                  "-",          "#",
                                  "body",       "tool",
                                  "keyframe",   "99999999999999999999",
                                  "true",       "\xff\xfe",
                                  "\xe2\x82",   "\\u0000",
                                  "0.0",        "-1",
                                  "[[body]]\n", "[tool]\n"};

std::string damaged(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(random() % std::max<std::size_t>(1, n));
  };
  for (std::size_t n = 1 + below(4); n > 0; --n) {
    const std::size_t at = below(text.size()), length = 1 + below(20);
    switch (below(5)) {
      case 0: text.erase(at, length); break;
      case 1: text.insert(at, kFragments[below(std::size(kFragments))]); break;
      case 2:
        if (!text.empty()) text[at] = static_cast<char>(random());
        break;
      case 3: text.insert(below(text.size()), text.substr(at, 4 * length)); break;
      default:
        if (at < text.size()) text.resize(text.size() - below(text.size() / 8 + 1));
        break;
    }
  }
  return text;
}

/// Returns whether a text is read; otherwise checks that it is rejected with a message that has a location.
bool is_read(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    palpate::loop::parse(text, "fuzz.toml", overrides);
    return true;
  } catch (const palpate::Error& e) {
    const std::string message = e.what();
    EXPECT_TRUE(message.starts_with("fuzz.toml:") || message.starts_with("--set ")) << message;
    return false;
  }
}

TEST(Fuzz, DamagedScenesAreReadOrRefused) {
  std::mt19937 random(20070322);
  int read = 0, refused = 0;
  for (const std::string& path : scene_texts::in_folder(scene_texts::kScenes)) {
    const std::string good = scene_texts::read(path);
    for (int i = 0; i < 400; ++i) (is_read(damaged(good, random)) ? read : refused)++;
  }
  EXPECT_GT(read, 50) << "damage in comments is harmless";
  EXPECT_GT(refused, 500);
}

TEST(Fuzz, DamagedOverridesAreAppliedOrRefused) {
  std::mt19937 random(4);
  int refused = 0;
  for (int i = 0; i < 1000; ++i)
    refused += !is_read(scene_texts::kWhole, {damaged("device.keyframe.1.position_m=[0, 0, 0.5]", random)});
  EXPECT_GT(refused, 500);
}

/// Reads the fuzzer's corpus with all registries; the fuzzer includes only a few names of each (tests/fuzz).
TEST(Fuzz, TheFuzzersInputsAreReadOrRefused) {
  int inputs = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(PALPATE_SOURCE_DIR "/tests/fuzz/corpus/scene")) {
    SCOPED_TRACE(entry.path().string());
    EXPECT_NO_THROW(is_read(scene_texts::read(entry.path().string())));
    ++inputs;
  }
  EXPECT_GT(inputs, 5);
}

TEST(Fuzz, DeepNestingIsRefused) {
  EXPECT_FALSE(is_read("a = " + std::string(100000, '[')));
  EXPECT_FALSE(is_read("[" + std::string(20000, 'a') + "]"));
}

}  // namespace
