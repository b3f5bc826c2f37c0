#pragma once
#include <vector>

#include "model/tetrahedralise.h"

namespace palpate::model {

/// Cuts lines where they turn by more than 30 degrees, so that these places become nodes.  A smooth closed
/// line stays whole.
std::vector<Polyline> cut_at_corners(const std::vector<Polyline>& lines);

}  // namespace palpate::model
