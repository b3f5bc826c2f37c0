#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <regex>
#include <string>

#include "palpate/integrate/self_test.h"

namespace {

std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string out;
  char buffer[4096];
  while (pipe && std::fgets(buffer, sizeof buffer, pipe.get())) out += buffer;
  return out;
}

const std::regex kSundials(
    "\\b(_?N_V|SUN|CVode|cv[A-Z]|ARKStep|ARKode|ark[A-Z]|IDA|ida[A-Z])|_generic_(N_Vector|SUN)");

// An exported symbol may be bound to or replaced by Simbody's copy; an imported one would be.
TEST(Isolation, NoSundialsSymbolLeavesOrEntersTheLibrary) {
  const std::string symbols = output_of(PALPATE_NM " -D -C " PALPATE_INTEGRATE_LIBRARY);
  ASSERT_NE(symbols.find("palpate::integrate::make_stepper"), std::string::npos) << "nm did not work";
  std::smatch found;
  EXPECT_FALSE(std::regex_search(symbols, found, kSundials))
      << found.str() << " in: " << found.prefix().str().substr(found.prefix().length() - 60);
}

TEST(Isolation, ThePatternKnowsWhatItLooksFor) {
  for (const char* name : {"N_VNew_Serial", "SUNLinSol_Dense", "CVodeCreate", "ARKStepCreate", "IDACreate",
                           "f(_generic_N_Vector*)"})
    EXPECT_TRUE(std::regex_search(std::string("0000 T ") + name, kSundials)) << name;
}

TEST(Isolation, TheSelfTestTellsWrongFromRight) {
  for (const auto& answer : palpate::integrate::self_test::all(1.0))
    EXPECT_NEAR(answer.y, std::exp(-1.0), 1e-6) << answer.library;
  EXPECT_EQ(palpate::integrate::self_test::all(1.0).size(), 3u);
}

}  // namespace
