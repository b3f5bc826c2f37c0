#include "core/units.h"

#include <algorithm>
#include <array>
#include <utility>

namespace palpate {
namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 29> kUnits = {{
    {"_n_m_s_rad", "N m s/rad"},
    {"_n_m_rad", "N m/rad"},
    {"_gflop_s", "Gflop/s"},
    {"_pa_s_m", "Pa s/m"},
    {"_n_s_m", "N s/m"},
    {"_kg_m3", "kg/m^3"},
    {"_kg_m2", "kg m^2"},
    {"_rad_s", "rad/s"},
    {"_per_s", "1/s"},
    {"_n_m_s", "N m/s"},
    {"_pa_m", "Pa/m"},
    {"_m_s2", "m/s^2"},
    {"_gb_s", "GB/s"},
    {"_n_m", "N/m"},
    {"_m2", "m^2"},
    {"_m_s", "m/s"},
    {"_n_s", "N/s"},
    {"_s_m", "s/m"},
    {"_mib", "MiB"},
    {"_rad", "rad"},
    {"_kg", "kg"},
    {"_pa", "Pa"},
    {"_hz", "Hz"},
    {"_ms", "ms"},
    {"_us", "us"},
    {"_n", "N"},
    {"_m", "m"},
    {"_s", "s"},
    {"_j", "J"},
}};

bool is_moment(std::string_view name) {
  constexpr std::array<std::string_view, 3> kWords = {"torque", "moment", "friction"};
  return std::any_of(kWords.begin(), kWords.end(),
                     [&](std::string_view word) { return name.find(word) != std::string_view::npos; });
}

}  // namespace

NameAndUnit split_unit(std::string_view key) {
  for (const auto& [ending, unit] : kUnits) {
    if (!key.ends_with(ending) || key.size() == ending.size()) continue;
    const std::string_view name = key.substr(0, key.size() - ending.size());
    return {std::string(name), ending == "_n_m" && is_moment(name) ? "N m" : std::string(unit)};
  }
  return {std::string(key), ""};
}

}  // namespace palpate
