#pragma once
#include <string>
#include <vector>

#include "palpate/fem/material.h"

namespace palpate::fem {

/// Material with published values, selected by the key `material` of a body or a region.
struct MaterialPreset {
  std::string name;     ///< Name in a scene.
  std::string summary;  ///< Specimen and conditions of the measurement.
  std::string source;   ///< Publication of each figure, and how the preset follows from it.
  Material material;    ///< Values; mass_damping is zero.
};

/// Returns all presets, in the order of `palpate list materials`.
const std::vector<MaterialPreset>& material_presets();

/// Returns the preset with that name.
/// @throws Error with the nearest known name
const MaterialPreset& material_preset(const std::string& name);

}  // namespace palpate::fem
