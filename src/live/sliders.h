#pragma once
#include <string>
#include <utility>
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::live {

/// Number of a scene that viewers may change.
struct Slider {
  std::string key;  ///< Key of the scene, as for --set: "tool.coupling.stiffness_n_m"
  std::string label, unit;
  double value = 0.0, least = 0.0, most = 0.0;
  bool logarithmic = true;
  int body = -1;  ///< Body whose Young's modulus it is, which changes at once; -1: another number.
};

/// Returns the sliders of a scene: spring and damper of the first hand's coupling, and Young's modulus of
/// each body, each from a tenth to ten times the scene's value.
/// @param scene  the scene without changes by sliders  @param values  keys and present values
std::vector<Slider> sliders_of(const scene::Description& scene,
                               const std::vector<std::pair<std::string, double>>& values);

}  // namespace palpate::live
