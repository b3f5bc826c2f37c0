#include "product/contact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/core/error.h"
#include "product/contact/statistics.h"

namespace palpate::bench {
namespace {

TEST(ContactBench, QuantilesAreValuesThatWereMeasured) {
  const std::vector<double> values = {5.0, 1.0, 4.0, 2.0};
  const Spread spread = spread_of(values);
  EXPECT_EQ(spread.least, 1.0);
  EXPECT_EQ(spread.median, 2.0);
  EXPECT_EQ(spread.p99, 5.0);
  EXPECT_EQ(spread_of({}).median, 0.0);
}

// The lens of two spheres that meet in a circle of radius a has the area pi a^2, projected along the line of
// their centres; the skins are polyhedra inside the spheres.
TEST(ContactBench, TheSameRegionOnAnySkin) {
  const auto rows = bench_skin_growth({2000, 8000});
  ASSERT_EQ(rows.size(), 2u);
  for (const ContactGrowthRow& r : rows) {
    EXPECT_NEAR(r.area_m2, M_PI * 0.05 * 0.05, 0.04 * M_PI * 0.05 * 0.05) << r.skin_vertices;
    EXPECT_GT(r.samples, 50);
    EXPECT_GT(r.query.least, 0.0);
    EXPECT_LE(r.query.least, r.query.median);
    EXPECT_LE(r.query.median, r.query.p99);
  }
  EXPECT_NEAR(rows[1].skin_vertices / static_cast<double>(rows[0].skin_vertices), 4.0, 0.1);
}

TEST(ContactBench, RegionsGrowByTheFactor) {
  const auto rows = bench_patch_growth(8000, 4.0, 3);
  ASSERT_EQ(rows.size(), 3u);
  for (std::size_t k = 1; k < 3; ++k) EXPECT_NEAR(rows[k].area_m2 / rows[k - 1].area_m2, 2.0, 0.06);
  EXPECT_EQ(rows[2].skin_vertices, rows[0].skin_vertices);
  EXPECT_THROW(bench_patch_growth(2000, 1.0, 3), Error);
  EXPECT_THROW(bench_patch_growth(2000, 4.0, 1), Error);
}

TEST(ContactBench, ABodyAgainstItselfIsAlone) {
  scene::Description d;
  d.name = "two";
  d.bodies.resize(2);
  d.bodies[0].name = "left";
  d.bodies[1].name = "right";
  ContactSpec contact;
  contact.first = "left";
  contact.second = "right";
  contact.stiffness_pa_m = 123.0;
  d.contacts = {contact, contact};
  d.tool.emplace();
  const scene::Description own = against_itself(d);
  ASSERT_EQ(own.bodies.size(), 1u);
  ASSERT_EQ(own.contacts.size(), 1u);
  EXPECT_EQ(own.contacts[0].first, "left");
  EXPECT_EQ(own.contacts[0].second, "left");
  EXPECT_EQ(own.contacts[0].stiffness_pa_m, 123.0);
  EXPECT_FALSE(own.tool);
}

TEST(ContactBench, ARowTouchesFromOneToTheNext) {
  scene::Description d;
  d.bodies.resize(1);
  d.bodies[0].name = "one";
  d.bodies[0].position_m = Vec3(0.5, 1, 2);
  AttachmentSpec held;
  held.box_min_m = Vec3(0.4, -1, -1);
  held.box_max_m = Vec3(0.45, 1, 1);
  d.bodies[0].attachments = {held};
  const scene::Description row = row_of_bodies(d, 4, 0.2);
  ASSERT_EQ(row.bodies.size(), 4u);
  ASSERT_EQ(row.contacts.size(), 3u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(row.bodies[k].position_m.x(), 0.5 + 0.2 * static_cast<double>(k), 1e-15);
    ASSERT_EQ(row.bodies[k].attachments.size(), 1u);
    EXPECT_NEAR(row.bodies[k].attachments[0].box_min_m.x(), 0.4 + 0.2 * static_cast<double>(k), 1e-15);
    EXPECT_NEAR(row.bodies[k].attachments[0].box_max_m.x(), 0.45 + 0.2 * static_cast<double>(k), 1e-15);
    if (k == 0) continue;
    EXPECT_EQ(row.contacts[k - 1].first, row.bodies[k - 1].name);
    EXPECT_EQ(row.contacts[k - 1].second, row.bodies[k].name);
  }
  EXPECT_THROW(row_of_bodies(d, 1, 0.2), Error);
}

}  // namespace
}  // namespace palpate::bench
