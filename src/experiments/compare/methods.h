#pragma once
#include <vector>

#include "palpate/experiments/comparison.h"

namespace palpate::compare {

/// Results of compare_contact_methods().
struct Methods {
  std::vector<MethodPoint> points;

  void archive(Archive& a) {
    a.list("points", points, [&a](MethodPoint& point) { point.archive(a); });
  }
};

}  // namespace palpate::compare
