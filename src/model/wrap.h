#pragma once
#include "soup.h"

namespace palpate::model {

/// Returns a closed surface around all faces, without self-intersections, at `offset` [m] outside of them;
/// openings narrower than 2 `alpha` [m] are closed.
Soup wrapped(const Soup& soup, double alpha, double offset);

}  // namespace palpate::model
