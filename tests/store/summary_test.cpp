#include "store/summary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "messages.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/sample_run.h"

using namespace palpate;

namespace {

store::Summary sample() {
  store::Summary s;
  s.command = "palpate run scenes/press-ball.toml";
  s.scene = "press-ball";
  s.scene_source = "[scene]\nname = \"press-ball\"\n";
  s.overrides = {"integrator.rtol=1e-4"};
  s.provenance = store::provenance();
  s.section("counts").values = {{"force_evaluations", 1234LL}, {"contact_queries", 40LL}};
  s.section("errors").values = {
      {"position_relative", 1.5e-3}, {"reference_error", std::nan("")}, {"marked", true}};
  s.section("timings").values = {{"cpu_s", std::vector<double>{0.1, 0.2}}};
  s.list("contacts") = {
      {{"between", std::vector<std::string>{"ball", "tool"}}, {"triangles", std::vector<long long>{3, 4}}},
      {{"between", std::vector<std::string>{"ball", "floor"}}, {"deepest_overlap_m", 1e-3}}};
  return s;
}

TEST(Summary, IsValidJsonWithUnitsAndOrder) {
  const auto json = nlohmann::ordered_json::parse(store::to_json(sample()));
  EXPECT_EQ(json["figures"]["counts"]["force_evaluations"], 1234);
  EXPECT_TRUE(json["figures"]["errors"]["reference_error"].is_null()) << "JSON has no NaN";
  EXPECT_EQ(json["figures"].begin().key(), "counts") << "in the order in which they were given";
  EXPECT_EQ(json.begin().key(), "schema_version");
  EXPECT_EQ(json["schema_version"], store::kSummarySchema);
  EXPECT_EQ(json["outcome"], "finished");
  const auto& libraries = json["provenance"]["libraries"];
  EXPECT_TRUE(
      std::any_of(libraries.begin(), libraries.end(), [](const auto& l) { return l["name"] == "HDF5"; }));
}

TEST(Summary, RowsAreAnArrayOfObjects) {
  const auto json = nlohmann::ordered_json::parse(store::to_json(sample()));
  const auto& contacts = json["figures"]["contacts"];
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_EQ(contacts[0]["between"], (std::vector<std::string>{"ball", "tool"}));
  EXPECT_EQ(contacts[0]["triangles"], (std::vector<int>{3, 4}));
  EXPECT_FALSE(contacts[0].contains("deepest_overlap_m")) << "a row omits what it does not have";
  EXPECT_EQ(contacts[1]["deepest_overlap_m"], 1e-3);
}

TEST(Summary, RefusesAnotherSchema) {
  const sample_run::Folder folder;
  const std::string path = folder / "s.json";
  const std::string is = fmt::format("\"schema_version\": {}", store::kSummarySchema);
  std::string text = store::to_json(sample());
  const std::size_t at = text.find(is);
  ASSERT_NE(at, std::string::npos);
  store::write_atomically(path, text.replace(at, is.size(), "\"schema_version\": 1000"));
  EXPECT_NE(expectations::message_of([&] { store::read_summary(path); }).find("schema_version is 1000"),
            std::string::npos);
}

TEST(Summary, RoundTrip) {
  const sample_run::Folder folder;
  store::Summary s = sample();
  s.outcome = "interrupted";
  s.message = "at t = 0.1 s, by Ctrl-C";
  s.remarks = {"bodies and contact at 21.7 Hz", "too deep"};
  store::write_summary(folder / "summary.json", s);
  const store::Summary again = store::read_summary(folder / "summary.json");
  EXPECT_EQ(store::to_json(again), store::to_json(s));
  EXPECT_EQ(std::get<long long>(again.sections[0].values[0].second), 1234);
  EXPECT_TRUE(std::isnan(std::get<double>(again.sections[1].values[1].second)));
  EXPECT_EQ(std::get<std::vector<long long>>(again.lists[0].rows[0][1].second),
            (std::vector<long long>{3, 4}));
  EXPECT_EQ(again.remarks, s.remarks);
}

TEST(Summary, ABadByteDoesNotLoseTheFile) {
  store::Summary s = sample();
  s.command = "palpate run caf\xe9.toml";  // Latin-1: no UTF-8
  EXPECT_TRUE(nlohmann::json::accept(store::to_json(s)));
}

TEST(Summary, RefusesWhatIsNoSummary) {
  const sample_run::Folder folder;
  for (const char* text : {"", "{", "[]", "{\"command\": 3}", "{}"}) {
    store::write_atomically(folder / "s.json", text);
    EXPECT_THROW(store::read_summary(folder / "s.json"), Error) << text;
  }
}

TEST(Summary, RefusesNumbersAndDepthsThatItWouldMisread) {
  const sample_run::Folder folder;
  const std::string path = folder / "s.json";
  const auto refusal = [&](const std::string& text) {
    store::write_atomically(path, text);
    return expectations::message_of([&] { store::read_summary(path); });
  };
  for (const char* number : {"9007199254740993", "-9007199254740993", "18446744073709551615"}) {
    std::string text = store::to_json(sample());
    const std::size_t at = text.find("1234");
    ASSERT_NE(at, std::string::npos);
    const std::string message = refusal(text.replace(at, 4, number));
    EXPECT_NE(message.find(path + ": " + number + " must be at most 9007199254740992"), std::string::npos)
        << message;
  }
  EXPECT_NE(refusal(std::string(100'000, '[')).find("nests deeper than 64"), std::string::npos);
}

TEST(Provenance, SaysWhatMadeIt) {
  const store::Provenance p = store::provenance();
  EXPECT_FALSE(p.version.empty());
  EXPECT_FALSE(p.commit.empty());
  EXPECT_GE(p.cores, 1);
  EXPECT_EQ(p.started_utc.size(), std::string("2007-03-22T10:00:00Z").size());
  for (const auto& [name, version] : p.libraries) EXPECT_FALSE(version.empty()) << name;
}

}  // namespace
