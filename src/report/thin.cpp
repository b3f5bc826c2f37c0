#include "thin.h"

#include <algorithm>
#include <set>

namespace palpate::report {

void thin(std::vector<double>& x, std::vector<double>& y, std::size_t pixels) {
  if (x.size() <= 4 * pixels || !std::is_sorted(x.begin(), x.end()) || !(x.back() > x.front())) return;
  const double scale = static_cast<double>(pixels) / (x.back() - x.front());
  std::vector<double> thin_x, thin_y;
  for (std::size_t begin = 0; begin < x.size();) {
    const auto column = static_cast<std::size_t>((x[begin] - x.front()) * scale);
    std::size_t end = begin + 1;
    while (end < x.size() && static_cast<std::size_t>((x[end] - x.front()) * scale) == column) ++end;
    const auto [least, greatest] =
        std::minmax_element(y.begin() + static_cast<long>(begin), y.begin() + static_cast<long>(end));
    for (const std::size_t i :
         std::set<std::size_t>{begin, static_cast<std::size_t>(least - y.begin()),
                               static_cast<std::size_t>(greatest - y.begin()), end - 1}) {
      thin_x.push_back(x[i]);
      thin_y.push_back(y[i]);
    }
    begin = end;
  }
  x = std::move(thin_x);
  y = std::move(thin_y);
}

}  // namespace palpate::report
