#include "core/units.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(SplitUnit, TakesTheLongestEnding) {
  const auto text = [](const char* key) {
    const NameAndUnit parts = split_unit(key);
    return parts.name + "|" + parts.unit;
  };
  EXPECT_EQ(text("peak_force_n"), "peak_force|N");
  EXPECT_EQ(text("max_force_slew_n_s"), "max_force_slew|N/s");
  EXPECT_EQ(text("stiffness_pa_m"), "stiffness|Pa/m");
  EXPECT_EQ(text("gravity_m_s2"), "gravity|m/s^2");
  EXPECT_EQ(text("inertia_kg_m2"), "inertia|kg m^2");
  EXPECT_EQ(text("largest_area_m2"), "largest_area|m^2");
  EXPECT_EQ(text("rotational_damping_n_m_s_rad"), "rotational_damping|N m s/rad");
  EXPECT_EQ(text("contact_n_m_rad"), "contact|N m/rad");
  EXPECT_EQ(text("nodes"), "nodes|");
  EXPECT_EQ(text("n"), "n|") << "a count";
  EXPECT_EQ(text("_n"), "_n|");
}

TEST(SplitUnit, TellsMomentsFromStiffnesses) {
  for (const char* key : {"max_torque_n_m", "torque_x_n_m", "torque_error_rms_n_m", "largest_moment_jump_n_m",
                          "rotational_friction_n_m"})
    EXPECT_EQ(split_unit(key).unit, "N m") << key;
  for (const char* key : {"stiffness_n_m", "k_passive_n_m", "contact_n_m", "arm_stiffness_n_m"})
    EXPECT_EQ(split_unit(key).unit, "N/m") << key;
  EXPECT_EQ(split_unit("max_torque_slew_n_m_s").unit, "N m/s");
}

}  // namespace
}  // namespace palpate
