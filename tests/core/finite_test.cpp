#include "core/finite.h"

#include <gtest/gtest.h>

#include <limits>

#include "palpate/core/types.h"

namespace palpate {
namespace {

TEST(AllFinite, FindsWhatIsNoNumberWhereverItStands) {
  EXPECT_TRUE(all_finite(VecX()));
  for (const Eigen::Index size : {1, 7, 64, 1001})
    for (const Eigen::Index at : {Eigen::Index{0}, size / 2, size - 1}) {
      VecX v = VecX::Constant(size, std::numeric_limits<double>::max());
      EXPECT_TRUE(all_finite(v)) << "the largest is one";
      v[at] = -std::numeric_limits<double>::denorm_min();
      EXPECT_TRUE(all_finite(v));
      for (const double wrong :
           {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
            std::numeric_limits<double>::quiet_NaN()}) {
        v[at] = wrong;
        EXPECT_FALSE(all_finite(v)) << wrong << " at " << at << " of " << size;
      }
    }
  MatX two = MatX::Ones(2, 2);
  two(0, 1) = std::numeric_limits<double>::infinity();
  two(1, 0) = -two(0, 1);
  EXPECT_FALSE(all_finite(two)) << "they do not cancel";
}

}  // namespace
}  // namespace palpate
