// Tests which figures of a report have acceptance limits, and when they are missed.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "product/contact.h"

namespace palpate::bench {
namespace {

ContactBenchRow row(const std::string& method, int threads, double query_ms) {
  ContactBenchRow out;
  out.variant = {method, threads};
  out.query = out.to_forces = {query_ms, query_ms, query_ms};
  out.touches = true;
  return out;
}

/// Returns a contact cost with each figure at its limit.
ContactCost price(const std::string& scene, double query_ms) {
  ContactCost out;
  out.scene = scene;
  out.one_body_ms = 3.0;
  out.bodies_ms = 10.0;
  out.row = row("distance", 1, query_ms);
  out.row.assembly_ms = out.row.elements_ms = 1.0;
  out.row.step.median = 13.0;
  out.friction.symmetric_ms = 19.5;
  return out;
}

/// Returns skins or areas from 10 to 1,000 with times that grow by the power `exponent`.
ContactGrowth growth(const std::string& with, double exponent) {
  ContactGrowth out{with, {}};
  for (const double size : {10.0, 100.0, 1000.0}) {
    ContactGrowthRow r;
    r.skin_vertices = with == "skin" ? static_cast<int>(size) : 7;
    r.area_m2 = with == "area" ? size : 7.0;
    r.query.median = 0.01 * std::pow(size, exponent);
    out.rows.push_back(r);
  }
  return out;
}

constexpr double kJustBelow = 1.0 - 1e-9, kJustAbove = 1.0 + 1e-9;

/// Returns a report with all figures within rounding of their limits, on the accepted side.
ContactBenchReport on_the_bars() {
  ContactBenchReport out;
  for (const char* name : {"touch-head", "gears"}) {
    ContactBenchReport::Scene scene{name, {}};
    ContactBenchRow points = row("distance", 2, 1.0);
    points.period_s = 0.01;
    points.period.median = 10.0 * (name == std::string("gears") ? 5.0 : kJustBelow);
    ContactBenchRow software = row("image", 1, 10.0), hardware = row("image", 1, 0.3);
    software.device_is_software = true;
    scene.rows = {points, row("distance", 1, 2.0), name == std::string("gears") ? hardware : software};
    out.scenes.push_back(scene);
  }
  out.prices = {price("touch-head", 0.15 * kJustBelow), price("two-pumpkins", 3.0), price("two-heads", 3.0)};
  out.prices[2].row.step.median = 1e3;  // This limit applies to two pumpkins alone.
  out.growth = {growth("skin", 0.2 * kJustBelow), growth("area", 1.1 * kJustBelow)};
  return out;
}

std::vector<std::string> missed(const ContactBenchReport& report) {
  std::vector<std::string> out;
  for (const ContactBar& bar : contact_bars(report))
    if (!bar.is_met()) out.push_back(bar.scene + ": " + bar.what);
  return out;
}

TEST(ContactBars, AreMetBySoMuchAndMissedByMore) {
  const ContactBenchReport good = on_the_bars();
  EXPECT_EQ(missed(good), std::vector<std::string>{});
  // Real time of one scene; an image on hardware; samples and queries of three costs; two more of the
  // pumpkins; two growths.
  EXPECT_EQ(contact_bars(good).size(), 1u + 1u + 2u * 3u + 2u + 2u);
  const std::vector<std::pair<std::string, std::function<void(ContactBenchReport&)>>> faults = {
      {"touch-head: simulated over run time, 2 threads",
       [](auto& r) { r.scenes[0].rows[0].period.median = 10.0 * kJustAbove; }},
      {"gears: image: query [ms]", [](auto& r) { r.scenes[1].rows[2].query.median = 0.3 * kJustAbove; }},
      {"touch-head: query / step", [](auto& r) { r.prices[0].row.to_forces.median = 0.15 * kJustAbove; }},
      {"two-heads: query / step", [](auto& r) { r.prices[2].row.to_forces.median = 3.0 * kJustAbove; }},
      {"two-heads: samples / elements", [](auto& r) { r.prices[2].row.assembly_ms = kJustAbove; }},
      {"two-pumpkins: contact / apart",
       [](auto& r) {
         r.prices[1].row.step.median = 13.0 * kJustAbove;
         r.prices[1].friction.symmetric_ms = 16.0;
       }},
      {"two-pumpkins: friction / contact",
       [](auto& r) { r.prices[1].friction.symmetric_ms = 19.5 * kJustAbove; }},
      {": growth with skin: exponent", [](auto& r) { r.growth[0] = growth("skin", 0.201); }},
      {": growth with area: exponent", [](auto& r) { r.growth[1] = growth("area", 1.101); }}};
  for (const auto& [what, fault] : faults) {
    ContactBenchReport bad = good;
    fault(bad);
    EXPECT_EQ(missed(bad), std::vector<std::string>{what});
  }
}

TEST(ContactBars, WhatWasNotMeasuredIsNotMet) {
  ContactBenchReport report = on_the_bars();
  report.prices.resize(1);
  report.scenes.clear();
  report.growth.clear();
  report.prices[0].one_body_ms = 0.0;
  EXPECT_EQ(missed(report), std::vector<std::string>{"touch-head: query / step"});
  EXPECT_EQ(contact_bars({}).size(), 0u);
}

TEST(ContactBars, StandInTheFileWithDevicesAndStages) {
  ContactBenchReport report = on_the_bars();
  ContactBenchRow& r = report.scenes[0].rows[1];
  r.device = "a processor, avx2";
  r.stages[static_cast<std::size_t>(ContactStage::kPasses)] = {1.0, 2.0, 3.0};
  report.prices[1].friction.full_ms = 36.0;
  report.prices[1].friction.force_change = 0.01;
  report.growth[0].rows.resize(1);  // No exponent.
  report.no_image = "no EGL device";
  const auto json = nlohmann::json::parse(to_json(report));
  EXPECT_FALSE(json.at("processor").get<std::string>().empty());
  EXPECT_EQ(json.at("image_left_out"), "no EGL device");
  const auto& scene = json.at("scenes").at(0);
  EXPECT_EQ(scene.at("scene"), "touch-head");
  EXPECT_EQ(scene.at("rows").at(1).at("device"), "a processor, avx2");
  EXPECT_EQ(scene.at("rows").at(1).at("stages_ms").size(), static_cast<std::size_t>(kContactStages));
  EXPECT_EQ(scene.at("rows").at(1).at("stages_ms").at("passes").at("p99"), 3.0);
  EXPECT_TRUE(scene.at("rows").at(2).at("device_is_software"));
  const auto& pumpkins = json.at("prices").at(1).at("contact");
  EXPECT_EQ(pumpkins.at("friction_full_tangent_step_ms"), 36.0);
  EXPECT_EQ(pumpkins.at("force_change_by_symmetric_tangent"), 0.01);
  EXPECT_TRUE(json.at("growth").at(0).at("exponent").is_null());
  EXPECT_EQ(json.at("bars").size(), contact_bars(report).size());
  EXPECT_EQ(json.at("bars").at(0).at("at_least"), 1.0);
  EXPECT_TRUE(json.at("bars").at(0).at("met"));
}

}  // namespace
}  // namespace palpate::bench
