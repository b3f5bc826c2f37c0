#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "palpate/core/error.h"
#include "product/fem.h"

namespace palpate::bench {
namespace {

namespace fs = std::filesystem;

std::string message_of(const std::string& path) {
  try {
    read_published_timings(path);
  } catch (const Error& e) { return e.what(); }
  return "no error";
}

TEST(PublishedTimings, TheFileThatIsShippedHoldsFiguresOfKnownSizes) {
  const PublishedTimings published = read_published_timings(PALPATE_PUBLISHED_TIMINGS);
  EXPECT_EQ(published.step_times.size(), 16u);
  EXPECT_EQ(published.accuracy.size(), 10u);
  int of_one_ms = 0;
  for (const PublishedStepTime& figure : published.step_times) {
    EXPECT_NO_THROW(size_named(figure.size));
    EXPECT_GT(figure.ten_ms, 0.0) << figure.program;
    of_one_ms += std::isfinite(figure.one_ms);
  }
  EXPECT_EQ(of_one_ms, 11);
  for (const auto& [size, point] : published.accuracy) {
    EXPECT_NO_THROW(size_named(size));
    EXPECT_TRUE(point.quoted);
    EXPECT_GT(point.ms_of_ten_ms, 0.0);
  }
}

TEST(PublishedTimings, TheBandwidthIsThatOfTheMostThreadsMeasured) {
  PublishedTimings published;
  published.reference_copy_gb_s = {{1, 12.8}, {2, 25.0}};
  EXPECT_EQ(published.reference_bandwidth_gb_s(1), 12.8);
  EXPECT_EQ(published.reference_bandwidth_gb_s(2), 25.0);
  EXPECT_EQ(published.reference_bandwidth_gb_s(8), 25.0);
  EXPECT_TRUE(std::isnan(PublishedTimings{}.reference_bandwidth_gb_s(1)));
}

TEST(PublishedTimings, AMissingOrBrokenFileIsNamed) {
  std::string folder = (fs::temp_directory_path() / "palpate_published_XXXXXX").string();
  ASSERT_NE(::mkdtemp(folder.data()), nullptr);
  const std::string path = folder + "/timings.json";
  EXPECT_NE(message_of(path).find(path + ": cannot be read"), std::string::npos) << message_of(path);
  std::ofstream(path) << "{\"sources\": {}}";
  EXPECT_NE(message_of(path).find("reference_machine"), std::string::npos) << message_of(path);
  std::stringstream text;
  text << std::ifstream(PALPATE_PUBLISHED_TIMINGS).rdbuf();
  std::string unknown = text.str();
  const std::string source = "\"source\": \"vega\"";
  ASSERT_NE(unknown.find(source), std::string::npos);
  unknown.replace(unknown.find(source), source.size(), "\"source\": \"hearsay\"");
  std::ofstream(path) << unknown;
  EXPECT_NE(message_of(path).find("hearsay"), std::string::npos) << message_of(path);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace palpate::bench
