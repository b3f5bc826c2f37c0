// Selection of the OpenGL display: hardware before software, in whatever order EGL lists them.
#include "gl/display_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

using namespace palpate::gl;

TEST(DisplayOrder, HardwareIsTriedBeforeSoftware) {
  using enum DisplayKind;
  const std::vector<DisplayKind> requested = {kHardwareDevice, kHardwareDevice, kSurfaceless, kSoftwareDevice,
                                              kSoftwareDevice};
  std::vector<DisplayKind> listed = requested;
  std::sort(listed.begin(), listed.end());
  int orders = 0;
  do {
    std::vector<DisplayKind> tried = listed;
    std::stable_sort(tried.begin(), tried.end(), is_tried_before);
    EXPECT_EQ(tried, requested);
    ++orders;
  } while (std::next_permutation(listed.begin(), listed.end()));
  EXPECT_EQ(orders, 30);  // 5! / (2! 2!)
}
