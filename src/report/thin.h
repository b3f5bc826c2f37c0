#pragma once
#include <vector>

namespace palpate::report {

/// Thins a curve with ascending x to at most four points per column of `pixels` columns: the first, the
/// least, the greatest and the last, so that the drawn line covers the same pixels and no peak is lost. A
/// short curve, or one whose x does not ascend, is unchanged.
void thin(std::vector<double>& x, std::vector<double>& y, std::size_t pixels);

}  // namespace palpate::report
