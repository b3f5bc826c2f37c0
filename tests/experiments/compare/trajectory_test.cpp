#include "palpate/experiments/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "palpate/core/error.h"

using namespace palpate;
using namespace palpate::compare;

namespace {

/// Two nodes of masses 1 and 3 whose x coordinates equal the time; one tick per period.
Trajectory line(const std::vector<double>& times, double offset_of_second = 0.0) {
  Trajectory t;
  t.start = VecX::Zero(6);
  t.node_weights = (VecX(6) << 1, 1, 1, 3, 3, 3).finished();
  for (double time : times) {
    VecX x = VecX::Zero(6);
    x[0] = x[3] = time;
    x[4] = offset_of_second;
    t.period_times.push_back(time);
    t.positions.push_back(x);
    t.energies.push_back(2.0 + offset_of_second);
    t.tick_times.push_back(time);
    Wrench w;
    w.force = Vec3(0, 0, 5 * offset_of_second);
    w.moment = Vec3(0, offset_of_second, 0);
    t.device.push_back(w);
  }
  return t;
}

TEST(Distance, OfATrajectoryFromItselfIsZero) {
  const TrajectoryError e = distance(line({1, 2}), line({1, 2}));
  EXPECT_EQ(e.position_rel_l2, 0.0);
  EXPECT_EQ(e.force_rms_n, 0.0);
  EXPECT_EQ(e.energy_j, 0.0);
}

// At the common times 1 and 2: sum of m dx^2 = 2 x 3 x 0.1^2, and sum of displacements squared = (1 + 3)(1^2
// + 2^2).
TEST(Distance, IsMassWeightedAtTheCommonTimes) {
  const TrajectoryError e = distance(line({0.5, 1, 2}, 0.1), line({1, 1.5, 2}));
  EXPECT_NEAR(e.position_rel_l2, std::sqrt(2 * 3 * 0.01 / 20.0), 1e-15);
  EXPECT_NEAR(e.position_max_m, 0.1, 1e-15);
  EXPECT_NEAR(e.force_rms_n, 0.5, 1e-15);
  EXPECT_NEAR(e.force_max_n, 0.5, 1e-15);
  EXPECT_NEAR(e.torque_rms_n_m, 0.1, 1e-15);
  EXPECT_NEAR(e.energy_j, 0.1, 1e-15);
}

// A body falls, turns and swells by a thousandth: its error is relative to the swelling only.
TEST(Distance, IsRelativeToTheDeformationNotToRigidMotion) {
  Trajectory reference, computed;
  const Points rest = (Points(3, 4) << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1).finished();
  const Quat turn(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  Points moved = (turn.toRotationMatrix() * rest).colwise() + Vec3(0, 0, -5);
  const Points stretched = (turn.toRotationMatrix() * (1.001 * rest)).colwise() + Vec3(0, 0, -5);
  const auto flat = [](const Points& x) { return VecX(Eigen::Map<const VecX>(x.data(), x.size())); };
  for (Trajectory* t : {&reference, &computed}) {
    t->start = flat(rest);
    t->node_weights = VecX::Ones(12);
    t->bodies = {{0, 12}};
    t->period_times = {1.0};
    t->energies = {0.0};
    t->positions = {flat(stretched)};
  }
  const Vec3 centre = stretched.rowwise().mean();
  const double deformation =
      0.001 / 1.001 * (stretched.colwise() - centre).norm();  // displacements of a stretch about the centre
  computed.positions[0][0] += 1e-6;
  EXPECT_NEAR(distance(computed, reference).position_rel_l2, 1e-6 / deformation, 1e-6);
  reference.positions[0] = computed.positions[0] = flat(moved);
  computed.positions[0][0] += 1e-6;
  EXPECT_NEAR(distance(computed, reference).position_rel_l2, 1e-6 / (moved - rest).norm(), 1e-12)
      << "nothing deforms: against the displacement";
}

// std::max(0, NaN) is 0: a run of NaN must not appear exact.
TEST(Distance, OfNaNIsNaN) {
  Trajectory broken = line({1, 2, 3});
  broken.positions[1][4] = broken.energies[1] = broken.device[1].force[0] = broken.device[1].moment[0] =
      std::nan("");
  const TrajectoryError e = distance(broken, line({1, 2, 3}));
  for (const double value : {e.position_rel_l2, e.position_max_m, e.force_rms_n, e.force_max_n,
                             e.torque_rms_n_m, e.torque_max_n_m, e.energy_j})
    EXPECT_TRUE(std::isnan(value));
}

TEST(Distance, RefusesTrajectoriesWithoutACommonTime) {
  EXPECT_THROW(distance(line({1}), line({2})), InternalError);
}

}  // namespace
