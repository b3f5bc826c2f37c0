#pragma once
#include "soup.h"

namespace palpate::model {

/// A closed surface around everything, without self-intersections, at `offset` [m] outside of it; openings
/// narrower than 2 `alpha` [m] are closed over.
Soup wrapped(const Soup& soup, double alpha, double offset);

}  // namespace palpate::model
