#include "validation.h"

#include <cmath>

#include "palpate/core/error.h"

namespace palpate::validation {

bool Measurement::passed() const {
  if (!(error <= bar)) return false;
  if (std::isnan(order_low) && std::isnan(order_high)) return true;
  return order >= order_low && (std::isnan(order_high) || order <= order_high);
}

bool Fault::is_found(const std::vector<Measurement>& measurements) const {
  bool found = false;
  for (const Measurement& m : measurements) {
    if (fails.empty() || m.quantity.find(fails) == std::string::npos) continue;
    if (m.passed()) return false;
    found = true;
  }
  return found;
}

double fitted_order(const std::vector<double>& h, const std::vector<double>& error) {
  PALPATE_CHECK(h.size() == error.size() && h.size() >= 2, "{} steps, {} errors", h.size(), error.size());
  double mean_x = 0, mean_y = 0;
  const double n = static_cast<double>(h.size());
  for (std::size_t i = 0; i < h.size(); ++i) {
    mean_x += std::log(h[i]) / n;
    mean_y += std::log(error[i]) / n;
  }
  double xy = 0, xx = 0;
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double dx = std::log(h[i]) - mean_x;
    xy += dx * (std::log(error[i]) - mean_y);
    xx += dx * dx;
  }
  return xy / xx;
}

}  // namespace palpate::validation
