// Perceptible difference of two force and torque histories, against differences known in closed form.
#include "experiments/compare/perceptible_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "palpate/core/error.h"

namespace {

using namespace palpate;

/// Tick records at 1 kHz over 2 s, with force f(t) along z and torque tau(t) about x.
template <class Force, class Torque>
std::vector<loop::TickRecord> ticks(Force&& force, Torque&& torque, double h = 1e-3) {
  std::vector<loop::TickRecord> out;
  for (int i = 1; i * h <= 2.0 + 1e-9; ++i) {
    loop::TickRecord tick;
    tick.time = i * h;
    tick.device.force = Vec3(0, 0, force(tick.time));
    tick.device.moment = Vec3(torque(tick.time), 0, 0);
    out.push_back(tick);
  }
  return out;
}
double none(double) { return 0.0; }
double tone(double t, double hz) { return std::sin(2.0 * std::numbers::pi * hz * t); }

TEST(PerceptibleDifference, OfARunAndItselfIsNone) {
  const auto a = ticks([](double t) { return 1.0 + tone(t, 3.0); }, none);
  const compare::PerceptibleDifference d = compare::perceptible_difference(a, a);
  EXPECT_TRUE(d.identical);
  EXPECT_EQ(d.ticks, 2000);
  EXPECT_EQ(d.force.rms, 0.0);
  EXPECT_EQ(d.force.noticeable, 0.0);
  EXPECT_NEAR(d.force.peak, 2.0, 1e-4);
}

// A tone of amplitude a has an RMS of a/sqrt(2), in the band of its frequency only.
TEST(PerceptibleDifference, AToneStandsInItsBand) {
  for (const auto& [hz, band] :
       {std::pair(4.0, 0), std::pair(20.0, 1), std::pair(50.0, 2), std::pair(220.0, 3)}) {
    const auto a = ticks([](double) { return 2.0; }, none);
    const auto b = ticks([hz = hz](double t) { return 2.0 + 0.1 * tone(t, hz); },
                         [hz = hz](double t) { return 0.01 * tone(t, hz); });
    const compare::PerceptibleDifference d = compare::perceptible_difference(a, b);
    EXPECT_FALSE(d.identical);
    EXPECT_NEAR(d.force.rms, 0.1 / std::numbers::sqrt2, 1e-4);
    EXPECT_NEAR(d.torque.rms, 0.01 / std::numbers::sqrt2, 1e-5);
    EXPECT_NEAR(d.force.max, 0.1, 1e-3);
    ASSERT_EQ(d.force.bands.size(), 4u);
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(d.force.bands[static_cast<std::size_t>(i)].difference,
                  i == band ? 0.1 / std::numbers::sqrt2 : 0.0, 1e-3)
          << hz << " Hz in band " << i;
    EXPECT_NEAR(d.force.bands[0].reference, 2.0, 1e-9);
  }
}

// At 4 kHz there is a fifth band, up to the Nyquist frequency.
TEST(PerceptibleDifference, BandsReachTheNyquistFrequency) {
  constexpr double kTick = 2.5e-4;
  const auto a = ticks(none, none, kTick), b = ticks([](double t) { return tone(t, 900.0); }, none, kTick);
  const compare::PerceptibleDifference d = compare::perceptible_difference(a, b);
  ASSERT_EQ(d.force.bands.size(), 5u);
  EXPECT_NEAR(d.force.bands[4].high_hz, 2000.0, 1e-6);
  EXPECT_NEAR(d.force.bands[4].difference, 1.0 / std::numbers::sqrt2, 1e-3);
  EXPECT_LT(d.force.bands[3].difference, 1e-3);
}

/// RMS over all bands: root of the sum of the bands' squares.
double whole(const compare::WrenchSeries& s, double compare::WrenchSeries::Band::*part) {
  double out = 0.0;
  for (const compare::WrenchSeries::Band& band : s.bands) out += band.*part * band.*part;
  return std::sqrt(out);
}

// The bands add up to the mean square of the run, also for a transient at the beginning, middle or end of the
// run, where windows have different weights.
TEST(PerceptibleDifference, BandsAddUpToTheWhole) {
  const auto still = ticks([](double) { return 0.5; }, none);
  for (const double at : {0.05, 0.4, 1.0, 1.95}) {
    const auto pulse = ticks([at](double t) { return 0.5 + 0.2 * std::exp(-std::pow((t - at) / 0.02, 2)); },
                             [at](double t) { return std::exp(-std::pow((t - at) / 0.01, 2)); });
    const compare::PerceptibleDifference d = compare::perceptible_difference(still, pulse);
    EXPECT_NEAR(whole(d.force, &compare::WrenchSeries::Band::difference) / d.force.rms, 1.0, 1e-12) << at;
    EXPECT_NEAR(whole(d.torque, &compare::WrenchSeries::Band::difference) / d.torque.rms, 1.0, 1e-12) << at;
    EXPECT_NEAR(whole(d.force, &compare::WrenchSeries::Band::reference), 0.5, 1e-12) << at;
    const compare::PerceptibleDifference back = compare::perceptible_difference(pulse, still);
    EXPECT_NEAR(whole(back.force, &compare::WrenchSeries::Band::difference), d.force.rms, 1e-12) << at;
  }
}

// A ball without friction has a torque at rounding level: no percentage is reported for it.
TEST(PerceptibleDifference, OfRoundingThereAreNoPercents) {
  const auto force = [](double) { return 1.0; };
  const auto a = ticks(force, [](double t) { return 1e-17 * tone(t, 7.0); }),
             b = ticks(force, [](double t) { return 3e-17 * tone(t, 9.0); }),
             c = ticks(force, [](double) { return 0.02; });
  const auto torque_of = [](const auto& reference, const auto& other) {
    const std::string text = compare::text_of(compare::perceptible_difference(reference, other));
    return text.substr(text.find("torque"));
  };
  EXPECT_EQ(torque_of(a, b).find("torque: none in either run beyond rounding (at most "), 0u)
      << torque_of(a, b);
  EXPECT_EQ(torque_of(a, b).find('%'), std::string::npos);
  EXPECT_EQ(torque_of(a, c).find("torque: differs by 0.02 N m RMS (the reference has none), at most 0.02; "),
            0u)
      << torque_of(a, c);
  EXPECT_EQ(torque_of(a, c).find(" of "), torque_of(a, c).find(" of the ticks"));
  EXPECT_NE(torque_of(c, a).find("(100 % of the peak of 0.02)"), std::string::npos);
}

// At 2 N the threshold is 0.14 N: 0.139 N is below it and 0.141 N above, at each tick. Below 0.5 N the
// threshold is constant, 0.035 N.
TEST(PerceptibleDifference, NoticeableIsBeyondWebersLaw) {
  const auto share = [](double force, double by) {
    return compare::perceptible_difference(ticks([=](double) { return force; }, none),
                                           ticks([=](double) { return force + by; }, none))
        .force.noticeable;
  };
  EXPECT_EQ(share(2.0, 0.139), 0.0);
  EXPECT_EQ(share(2.0, -0.141), 1.0);
  EXPECT_EQ(share(0.0, 0.034), 0.0);
  EXPECT_EQ(share(0.0, 0.036), 1.0);
  const auto torque = [](double by) {
    return compare::perceptible_difference(ticks(none, [](double) { return 0.1; }),
                                           ticks(none, [=](double) { return 0.1 + by; }))
        .torque.noticeable;
  };
  EXPECT_EQ(torque(0.0126), 0.0);
  EXPECT_EQ(torque(0.0128), 1.0);
}

// Runs with different rates and lengths are compared over their common duration; forces are interpolated
// linearly between ticks.
TEST(PerceptibleDifference, OtherRatesAreInterpolated) {
  const auto line = [](double t) { return 3.0 * t; };
  auto coarse = ticks(line, none, 4e-3);
  coarse.resize(coarse.size() / 2);
  const compare::PerceptibleDifference d = compare::perceptible_difference(ticks(line, none), coarse);
  EXPECT_NEAR(d.from_s, 0.004, 1e-12);
  EXPECT_NEAR(d.to_s, 1.0, 1e-12);
  EXPECT_LT(d.force.max, 1e-12);
  EXPECT_FALSE(d.identical);
  EXPECT_NE(compare::text_of(d).find("force: differs by"), std::string::npos);
}

TEST(PerceptibleDifference, RefusesWhatCannotBeCompared) {
  const auto a = ticks(none, none);
  EXPECT_THROW(compare::perceptible_difference(a, {}), Error);
  auto later = a;
  for (loop::TickRecord& tick : later) tick.time += 10.0;
  EXPECT_THROW(compare::perceptible_difference(a, later), Error);
}

}  // namespace
