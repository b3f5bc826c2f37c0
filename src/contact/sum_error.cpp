#include "palpate/contact/sum_error.h"

#include <algorithm>

namespace palpate::contact {

void SumError::take(double sum, double error, double largest_term) {
  last_ = error / sum;
  largest_sum_ = std::max(largest_sum_, sum);
  largest_error_ = std::max(largest_error_, error);
  largest_term_ = std::max(largest_term_, largest_term);
}

void SumError::archive(Archive& a) {
  a("last", last_);
  a("largest_sum", largest_sum_);
  a("largest_error", largest_error_);
  a("largest_term", largest_term_);
}

}  // namespace palpate::contact
