// Materials with published values: each follows from the figures of its source.
#include "palpate/fem/material_presets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "palpate/core/error.h"

namespace palpate::fem {
namespace {

TEST(MaterialPresets, AreValidAndNameTheirSource) {
  std::set<std::string> names;
  for (const MaterialPreset& preset : material_presets()) {
    check(preset.material, preset.name.c_str());
    EXPECT_TRUE(names.insert(preset.name).second);
    EXPECT_FALSE(preset.summary.empty());
    EXPECT_GT(preset.source.size(), 20u) << preset.name;
  }
  EXPECT_GE(names.size(), 5u);
}

/// Loss factor and storage modulus of a measured |G|.
double youngs_modulus(double absolute_shear_modulus, double loss_factor) {
  return 3.0 * absolute_shear_modulus / std::sqrt(1.0 + loss_factor * loss_factor);
}

// Published figures, and the presets rounded to two digits.
TEST(MaterialPresets, FollowFromThePublishedFigures) {
  const double w = 2.0 * M_PI * 50.0;  // [rad/s], frequency of Hatt et al. 2023
  const auto close = [](double preset, double published) {
    EXPECT_NEAR(preset, published, 0.05 * published);
  };
  // Krouskop et al. 1998: the storage modulus is at least 93 % of |E|, so that tan = sqrt(1/0.93^2 - 1)
  const double fat = std::sqrt(1.0 / (0.93 * 0.93) - 1.0), muscle = std::tan(0.253 * M_PI / 2.0);
  close(material_preset("fat").material.youngs_modulus, youngs_modulus(752.0, fat));
  close(material_preset("fat").material.stiffness_damping, fat / w);
  close(material_preset("muscle").material.youngs_modulus, youngs_modulus(1000.0, muscle));
  close(material_preset("muscle").material.stiffness_damping, muscle / w);
  close(material_preset("liver").material.youngs_modulus, 3.0 * 1160.0);
  close(material_preset("liver").material.stiffness_damping, 7.3 / 1160.0);
  close(material_preset("silicone").material.youngs_modulus, 3.0 * 250e3);
  close(material_preset("rubber").material.youngs_modulus, 3.0 * 0.5e6);
}

TEST(MaterialPresets, UnknownNameGetsTheNearest) {
  try {
    material_preset("livre");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean \"liver\"?"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace palpate::fem
