#include "stability/modal_steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "integrate/linear_step.h"
#include "palpate/core/error.h"
#include "palpate/integrate/integrators.h"

using namespace palpate;
using namespace palpate::stability;

namespace {

constexpr double kDamping = 0.1;

/// Returns |x(T) - exp| after T = 1/w at n steps.
double error_of(const Column& column, int n, double contact_share = 0.0) {
  const ModalSteps steps(column, 1.0 / n, kDamping, contact_share);
  const Eigen::Vector2d start(1.0, -0.5);
  VecX x = steps.first() * steps.start(start);
  for (int i = 1; i < n; ++i) x = steps.next() * x;
  const MatX generator = (MatX(2, 2) << 0.0, 1.0, -1.0, -2.0 * kDamping).finished();
  return (x.head<2>() - MatX(generator.exp()) * start).norm();
}

TEST(ModalSteps, HaveTheOrderOfTheirMethod) {
  int checked = 0;
  for (const Column& column : stepper_columns(integrate::stepper_registry())) {
    if (!has_modal_steps(column)) continue;
    const double order = std::log2(error_of(column, 4) / error_of(column, 8));
    EXPECT_NEAR(order, column.entry->traits.order, 0.45) << column.label;
    ++checked;
  }
  EXPECT_EQ(checked, 44);
}

// Also tests the conditions that couple the two sides, which either side alone does not show.
TEST(ModalSteps, HaveTheOrderOfTheirMethodWhereItSplits) {
  int checked = 0;
  for (const Column& column : stepper_columns(integrate::stepper_registry())) {
    if (!has_modal_steps(column) || !splits(column)) continue;
    for (const double share : {0.3, 0.7}) {
      const double order = std::log2(error_of(column, 16, share) / error_of(column, 32, share));
      EXPECT_NEAR(order, column.entry->traits.order, 0.45) << column.label << " " << share;
    }
    ++checked;
  }
  EXPECT_EQ(checked, 8);
}

TEST(ModalSteps, VanishAtInfinityWhereTheRegistrySaysL) {
  int l_stable = 0, others = 0;
  for (const Column& column : stepper_columns(integrate::stepper_registry())) {
    if (!has_modal_steps(column) || column.entry->traits.family == "multi-rate") continue;
    const bool is_l = column.entry->traits.stability == dynamics::Stability::kL;
    EXPECT_EQ(ModalSteps(column, 1e8, 0.0).spectral_radius() < 1e-3, is_l) << column.label;
    ++(is_l ? l_stable : others);
  }
  EXPECT_GT(l_stable, 20);
  EXPECT_GT(others, 5);
}

TEST(ModalSteps, OfSymplecticEulerEndAtTwo) {
  for (const Column& column : stepper_columns(integrate::stepper_registry())) {
    if (column.name != "symplectic-euler") continue;
    EXPECT_LE(ModalSteps(column, 1.999, 0.0).spectral_radius(), 1.0 + 1e-9);
    EXPECT_GT(ModalSteps(column, 2.001, 0.0).spectral_radius(), 1.01);
  }
}

TEST(LinearStep, RefusesWhatHasNoTable) {
  EXPECT_THROW(integrate::linear_step("cvode-bdf", MatX::Identity(2, 2)), Error);
  EXPECT_THROW(integrate::linear_step("ark-erk-4", MatX::Identity(2, 3)), Error);
  EXPECT_THROW(integrate::split_step("ark-erk-4", MatX::Identity(2, 2), MatX::Identity(2, 2)), Error);
  EXPECT_THROW(integrate::split_step("ark-imex-3", MatX::Identity(2, 2), MatX::Identity(3, 3)), Error);
}

}  // namespace
