#include "cases.h"

namespace palpate::study {

const std::vector<ValidationCase>& validation_cases() {
  static const std::vector<ValidationCase> cases = {
  };
  return cases;
}

}  // namespace palpate::study
