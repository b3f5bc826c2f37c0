#include "loop/run_figures.h"

#include <gtest/gtest.h>

#include "palpate/core/archive.h"

using namespace palpate;

namespace {

loop::TickRecord tick_of(double time_s, double force_n, double torque_n_m) {
  loop::TickRecord tick;
  tick.time = time_s;
  tick.device = {Vec3(0.0, torque_n_m, 0.0), Vec3(0.0, 0.0, -force_n)};
  return tick;
}

TEST(RunFigures, HoldThePeaksOfEachHand) {
  loop::RunFigures figures;
  EXPECT_TRUE(figures.peaks().empty()) << "there is no tick";
  EXPECT_EQ(figures.largest().force_n, 0.0);
  figures.tick_of(0, tick_of(0.001, 1.0, 0.5));
  figures.tick_of(0, tick_of(0.002, 3.0, 0.25));
  figures.tick_of(0, tick_of(0.003, 3.0, 0.125));
  figures.tick_of(1, tick_of(0.004, 2.0, 4.0));
  ASSERT_EQ(figures.peaks().size(), 2u);
  const loop::PeakWrench first = figures.peaks()[0], any = figures.largest();
  EXPECT_EQ(first.force_n, 3.0);
  EXPECT_EQ(first.force_at_s, 0.002) << "the first of equal ones";
  EXPECT_EQ(first.torque_n_m, 0.5);
  EXPECT_EQ(first.torque_at_s, 0.001);
  EXPECT_EQ(any.force_n, 3.0);
  EXPECT_EQ(any.torque_n_m, 4.0);
  EXPECT_EQ(any.torque_at_s, 0.004);
}

TEST(RunFigures, ContinueFromTheirArchive) {
  loop::RunFigures figures, resumed;
  figures.tick_of(0, tick_of(0.001, 1.0, 0.5));
  Archive kept;
  figures.archive(kept);
  Archive again(kept.values(), "here");
  resumed.archive(again);
  ASSERT_EQ(resumed.peaks().size(), 1u);
  EXPECT_EQ(resumed.peaks()[0].force_n, 1.0);
  EXPECT_EQ(resumed.peaks()[0].torque_at_s, 0.001);
}

TEST(RunFigures, ASeriesHasThePeaksOfItsTicks) {
  const std::vector<Wrench> series = {tick_of(0.0, 1.0, 0.5).device, tick_of(0.0, 2.0, 0.25).device};
  const loop::PeakWrench peak = loop::peak_of(series, {0.1, 0.2});
  EXPECT_EQ(peak.force_n, 2.0);
  EXPECT_EQ(peak.force_at_s, 0.2);
  EXPECT_EQ(peak.torque_n_m, 0.5);
  EXPECT_EQ(peak.torque_at_s, 0.1);
  EXPECT_THROW(loop::peak_of(series, {0.1}), std::exception);
}

}  // namespace
