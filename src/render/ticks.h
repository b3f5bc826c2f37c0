#pragma once
#include <string>
#include <vector>

namespace palpate::render {

/// Returns the least number not below `x` > 0 that is 1, 2 or 5 times a power of ten.
double round_up(double x);

/// Unit with the SI prefix for which `largest` reads as 1 to 999: ("m", 0.004) -> factor 1e3, "mm".
struct ScaledUnit {
  double factor = 1.0;  ///< Number shown = value in the plain unit x factor.
  std::string name;
};
/// Returns the prefixed unit for m, m/s, Pa, N, J, N m, s, W; any other unit is returned unchanged, with
/// factor 1.
ScaledUnit scaled_unit(const std::string& unit, double largest);

/// Tick of an axis.
struct Tick {
  double value = 0.0;  ///< In the plain unit.
  std::string text;    ///< Number in the scaled unit.
};
/// Returns three to seven round values in [low, high].
std::vector<Tick> ticks(double low, double high, const ScaledUnit& unit);

}  // namespace palpate::render
