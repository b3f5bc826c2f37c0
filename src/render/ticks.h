#pragma once
#include <string>
#include <vector>

namespace palpate::render {

/// 1, 2 or 5 times a power of ten, the nearest that is not below `x` > 0.
double round_up(double x);

/// A unit with the SI prefix that makes `largest` read as 1 to 999: ("m", 0.004) -> factor 1e3, "mm".
struct ScaledUnit {
  double factor = 1.0;  ///< a value in the plain unit times this is the number shown
  std::string name;
};
/// Only plain units that people prefix (m, m/s, Pa, N, J, N m, s, W);
/// any other stays as it is, with factor 1.
ScaledUnit scaled_unit(const std::string& unit, double largest);

struct Tick {
  double value = 0.0;  ///< in the plain unit
  std::string text;    ///< in the scaled one
};
/// Three to seven round values in [low, high].
std::vector<Tick> ticks(double low, double high, const ScaledUnit& unit);

}  // namespace palpate::render
