#include <gtest/gtest.h>
#include <link.h>

#include <cmath>
#include <string>
#include <vector>

#include "isolation/cpodes.h"
#include "palpate/integrate/self_test.h"

namespace {

void expect_sundials(double t) {
  const auto answers = palpate::integrate::self_test::all(t);
  ASSERT_EQ(answers.size(), 3u);
  for (const auto& answer : answers) EXPECT_NEAR(answer.y, std::exp(-t), 1e-6) << answer.library;
}

/// ctest runs each test in a separate process, so that this is the order of first use.
TEST(Isolation, SundialsThenCPodes) {
  expect_sundials(1.0);
  EXPECT_NEAR(cpodes_decay(1.0), std::exp(-1.0), 1e-6);
  expect_sundials(2.0);
}

TEST(Isolation, CPodesThenSundials) {
  EXPECT_NEAR(cpodes_decay(1.0), std::exp(-1.0), 1e-6);
  expect_sundials(1.0);
  EXPECT_NEAR(cpodes_decay(2.0), std::exp(-2.0), 1e-6);
}

// The loader finds the libraries in the order that the executable's name specifies.
TEST(Isolation, LinkedInTheOrderMeant) {
  std::vector<std::string> loaded;
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* data) {
        static_cast<std::vector<std::string>*>(data)->emplace_back(info->dlpi_name);
        return 0;
      },
      &loaded);
  const auto place = [&](const char* name) {
    for (std::size_t i = 0; i < loaded.size(); ++i)
      if (loaded[i].find(name) != std::string::npos) return static_cast<long>(i);
    return -1L;
  };
  ASSERT_GE(place("libpalpate_integrate"), 0);
  ASSERT_GE(place("libSimTKmath"), 0);
  EXPECT_EQ(place("libpalpate_integrate") < place("libSimTKmath"), PALPATE_INTEGRATE_FIRST == 1);
}

}  // namespace
