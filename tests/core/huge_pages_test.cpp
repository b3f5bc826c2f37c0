#include "core/huge_pages.h"

#include <gtest/gtest.h>

#include <numeric>

namespace palpate {
namespace {

TEST(HugePages, ContentsStay) {
  // empty, less than a page, 24 MiB
  for (const std::size_t count : {std::size_t{0}, std::size_t{100}, std::size_t{3} << 20}) {
    std::vector<double> v(count), expected(count);
    std::iota(v.begin(), v.end(), 0.0);
    std::iota(expected.begin(), expected.end(), 0.0);
    prefer_huge_pages(v);
    EXPECT_EQ(v, expected) << count;
    if (count > 0) v.back() = -1.0;  // still writable
  }
}

}  // namespace
}  // namespace palpate
