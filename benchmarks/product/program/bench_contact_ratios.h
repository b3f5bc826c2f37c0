#pragma once
#include <vector>

#include "product/contact.h"

namespace palpate::cli {

/// Prints the cost of contact relative to the rest of a step, as ratios.
void print_contact_prices(const std::vector<bench::ContactCost>& prices);

/// Measures the growth of a query with the skin and with the contact region, with fitted exponents.
std::vector<bench::ContactGrowth> run_contact_growth();
void print_contact_growth(const std::vector<bench::ContactGrowth>& growth);

/// Prints each limit, its figure, and whether it is met. @return whether all are met
bool print_contact_bars(const std::vector<bench::ContactBar>& bars);

}  // namespace palpate::cli
