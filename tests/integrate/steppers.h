#pragma once
#include <gtest/gtest.h>

#include "integrate/fakes.h"

namespace palpate::fakes {

/// Conformance suite of the integrator registry. A new entry is tested by being listed.
class Steppers : public testing::TestWithParam<std::string> {
 protected:
  IntegratorSpec spec() const {
    IntegratorSpec s = mode_spec(GetParam());
    if (!steps_are_fixed(GetParam())) s.rtol = 1e-6;
    s.step_s = 1e-3;
    return s;
  }
  int order() const { return ladder_order(GetParam()); }
};

}  // namespace palpate::fakes
