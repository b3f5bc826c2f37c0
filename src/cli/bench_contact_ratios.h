#pragma once
#include <vector>

#include "palpate/scene/description.h"

namespace palpate::cli {

/// Contact beside the rest of a step, as ratios (bench::ContactPrice).
void print_contact_prices(const std::vector<scene::Description>& descriptions);

/// How a query grows with the skin and with the contact region: fitted exponents.
void print_contact_growth();

}  // namespace palpate::cli
