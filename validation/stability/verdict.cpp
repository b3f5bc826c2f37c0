#include <algorithm>
#include <array>

#include "stability.h"

namespace palpate::stability {

const char* to_string(Verdict verdict) {
  static constexpr std::array<const char*, kVerdicts> kNames = {
      "accurate", "stable", "bounded", "error", "grew", "not finite", "silent", "too slow", "wrong"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::string Verdicts::text() const {
  std::string out;
  for (int v = 0; v < kVerdicts; ++v)
    if (has(static_cast<Verdict>(v)))
      out += (out.empty() ? "" : " or ") + std::string(to_string(static_cast<Verdict>(v)));
  return out;
}

long StabilityMatrix::unexpected() const {
  return std::count_if(cells.begin(), cells.end(),
                       [](const StabilityCell& cell) { return !cell.as_expected(); });
}

}  // namespace palpate::stability
