#pragma once
#include <vector>

namespace palpate::report {

/// Thins a curve whose x ascends to at most four points for each of `pixels` columns: the first, the least,
/// the greatest and the last of each column, so that the drawn line covers the same pixels and no peak is
/// lost.  A curve that is short, or whose x does not ascend, is left alone.
void thin(std::vector<double>& x, std::vector<double>& y, std::size_t pixels);

}  // namespace palpate::report
