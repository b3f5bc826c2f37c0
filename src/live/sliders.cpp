#include "live/sliders.h"

#include <fmt/format.h>

#include <algorithm>

namespace palpate::live {

std::vector<Slider> sliders_of(const scene::Description& scene,
                               const std::vector<std::pair<std::string, double>>& values) {
  constexpr double kRatio = 10.0;
  std::vector<Slider> out;
  const auto add = [&](std::string key, std::string label, const char* unit, double value, int body) {
    if (!(value > 0.0)) return;
    out.push_back(
        {std::move(key), std::move(label), unit, value, value / kRatio, value * kRatio, true, body});
  };
  if (scene.tool) {
    const VirtualCouplingSpec& c = scene.tool->coupling;
    add("tool.coupling.stiffness_n_m", "Stiffness of the virtual spring", "N/m", c.stiffness_n_m, -1);
    add("tool.coupling.damping_n_s_m", "Damping of the virtual spring", "N s/m", c.damping_n_s_m, -1);
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    add(fmt::format("body.{}.youngs_modulus_pa", i),
        fmt::format("Young's modulus of {}", scene.bodies[i].name), "Pa", scene.bodies[i].youngs_modulus_pa,
        static_cast<int>(i));
  for (Slider& slider : out)
    for (const auto& [key, value] : values)
      if (key == slider.key) slider.value = std::clamp(value, slider.least, slider.most);
  return out;
}

}  // namespace palpate::live
