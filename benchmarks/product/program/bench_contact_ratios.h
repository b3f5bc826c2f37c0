#pragma once
#include <vector>

#include "product/contact.h"

namespace palpate::cli {

/// Contact beside the rest of a step, as ratios.
void print_contact_prices(const std::vector<bench::ContactCost>& prices);

/// How a query grows with the skin and with the contact region, with fitted exponents.
std::vector<bench::ContactGrowth> run_contact_growth();
void print_contact_growth(const std::vector<bench::ContactGrowth>& growth);

/// Each bar, its figure, and whether it is met.  @return whether all are
bool print_contact_bars(const std::vector<bench::ContactBar>& bars);

}  // namespace palpate::cli
