#include "palpate/contact/sum_error.h"

#include <algorithm>

namespace palpate::contact {

void SumError::take(const Query& query) {
  last_ = query;
  largest_sum_ = std::max(largest_sum_, query.sum);
  largest_error_ = std::max(largest_error_, query.error);
  largest_term_ = std::max(largest_term_, query.largest_term);
}

// The last query is not saved: a resumed run repeats it.
void SumError::archive(Archive& a) {
  a("largest_sum", largest_sum_);
  a("largest_error", largest_error_);
  a("largest_term", largest_term_);
}

}  // namespace palpate::contact
