#include "stability/stability.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>
#include <ostream>
#include <set>

#include "palpate/core/error.h"
#include "palpate/integrate/integrators.h"
#include "stability/faulty_stepper.h"
#include "store/csv.h"
#include "temporary_folder.h"

using namespace palpate;
using namespace palpate::stability;
using faulty::Defect;

namespace {

StabilityMatrix matrix_of(faulty::Registry registry, const std::vector<std::string>& rows,
                          double limit_s = 20.0, int jobs = 1) {
  StabilityOptions options;
  options.registry = registry;
  options.rows = rows;
  options.seeds = 2;
  options.limit_s = limit_s;
  options.jobs = jobs;
  return run(options);
}

std::string unexpected_of(const StabilityMatrix& matrix) {
  std::string out;
  for (const StabilityCell& c : matrix.cells)
    if (!c.as_expected())
      out += fmt::format("{} / {} / {}: {}, expected {}; {}; {}\n", c.row, c.sub_case, c.integrator,
                         to_string(c.verdict), c.expected.text(), c.figure, c.reason);
  return out;
}

const StabilityCell& cell_of(const StabilityMatrix& matrix, const std::string& sub_case) {
  for (const StabilityCell& cell : matrix.cells)
    if (cell.sub_case == sub_case) return cell;
  throw std::runtime_error("no cell of " + sub_case);
}

TEST(Verdicts, AreSets) {
  const Verdicts set{Verdict::kAccurate, Verdict::kError};
  EXPECT_TRUE(set.has(Verdict::kAccurate) && set.has(Verdict::kError));
  EXPECT_FALSE(set.has(Verdict::kStable) || set.has(Verdict::kSilent));
  EXPECT_EQ(set.text(), "accurate or error");
  EXPECT_TRUE(Verdicts{}.empty());
  EXPECT_FALSE(StabilityCell{}.as_expected()) << "nothing is expected of a cell that has no expectation";
}

TEST(Stability, EndsWithTheMethodThatTheoryNames) {
  // Backward Euler by hand: order 1, L-stable. Resolved at 1e3 Pa it is not yet accurate, in between it is
  // stable, and where every mode has w H > 100 it reaches rest.
  const StabilityMatrix matrix = matrix_of(faulty::registry(Defect::kNothing), {"youngs-modulus"});
  EXPECT_EQ(unexpected_of(matrix), "");
  EXPECT_EQ(cell_of(matrix, "E = 1e6 Pa").verdict, Verdict::kStable);
  EXPECT_EQ(cell_of(matrix, "E = 1e11 Pa").verdict, Verdict::kAccurate);
  for (const StabilityCell& cell : matrix.cells) EXPECT_LE(cell.gain, 1e-6);
}

// --- steppers with an injected defect: each must make cells fail, with the verdict of its defect
struct Fault {
  Defect defect;
  std::string row, sub_case;
  Verdict verdict;
  std::string reason;
};
void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.row << ", " << fault.sub_case << ": " << to_string(fault.verdict);
}
class BrokenStepper : public testing::TestWithParam<Fault> {};
/// Returns at least one fault for each row of steppers.
std::vector<Fault> faults() {
  std::vector<Fault> all = {
      Fault{Defect::kNotANumber, "youngs-modulus", "E = 1e5 Pa", Verdict::kNotFinite, ""},
      Fault{Defect::kNotANumber, "rest", "a free cube", Verdict::kNotFinite, "non-finite value"},
      Fault{Defect::kNotANumber, "contact-stiffness", "k = 1e6 Pa/m", Verdict::kNotFinite,
            "non-finite value"},
      Fault{Defect::kNotANumber, "squashed", "mirror image", Verdict::kNotFinite, "non-finite value"},
      Fault{Defect::kGainsEnergy, "youngs-modulus", "E = 1e5 Pa", Verdict::kGrew, ""},
      Fault{Defect::kGainsEnergy, "contact-stiffness", "k = 1e2 Pa/m", Verdict::kWrong, "then:"},
      Fault{Defect::kGainsALittle, "youngs-modulus", "E = 1e3 Pa", Verdict::kGrew, ""},
      Fault{Defect::kFailsInSilence, "youngs-modulus", "E = 1e5 Pa", Verdict::kSilent, ""},
      Fault{Defect::kFailsInSilence, "impact", "10 m/s", Verdict::kSilent, ""},
      Fault{Defect::kThrows, "sizes", "no body", Verdict::kSilent, "internal error"},
      Fault{Defect::kNeverEnds, "rest", "a free cube", Verdict::kTooSlow, "cut off"},
      Fault{Defect::kClaimsErrorControl, "youngs-modulus", "E = 1e5 Pa", Verdict::kStable, ""},
      Fault{Defect::kClaimsToBeExplicit, "youngs-modulus", "E = 1e7 Pa", Verdict::kWrong, "departs"},
      Fault{Defect::kClaimsToBeLStable, "stiff-modes", "w H = 1e4", Verdict::kWrong, "departs"},
      Fault{Defect::kDrags, "undamped", "E = 1e3 Pa", Verdict::kWrong, "departs"},
      Fault{Defect::kDrags, "poissons-ratio", "nu = 0.3", Verdict::kWrong, "departs"},
      Fault{Defect::kDrags, "step", "H = 0.01 s", Verdict::kWrong, "departs"},
      Fault{Defect::kForgetsToSplit, "split", "w H = 0.3, contact 0.3", Verdict::kWrong, "departs"},
      Fault{Defect::kForgetsToSplit, "split", "w H = 1, contact 10", Verdict::kWrong, "departs"},
      Fault{Defect::kDrags, "elements", "E = 1e5 Pa", Verdict::kWrong, "departs"},
      Fault{Defect::kClaimsToBeLStable, "elements", "E = 1e5 Pa", Verdict::kWrong, "departs"},
      Fault{Defect::kDrags, "slivers", "volume ratio 1e6", Verdict::kWrong, "departs"},
      Fault{Defect::kDrags, "contact-stiffness", "k = 1e2 Pa/m", Verdict::kWrong, "free flight"},
      Fault{Defect::kDrags, "impact", "1 m/s", Verdict::kWrong, "free flight"},
      Fault{Defect::kDrags, "two-bodies", "1 times as dense", Verdict::kWrong, "momentum"},
      Fault{Defect::kDrags, "rest", "a free cube", Verdict::kWrong, "released"},
      Fault{Defect::kGainsEnergy, "squashed", "scattered", Verdict::kGrew, ""},
      Fault{Defect::kFallsUpward, "sizes", "one element falls", Verdict::kGrew, ""}};
#ifdef PALPATE_HAS_TOOL
  all.push_back(Fault{Defect::kNotANumber, "density-ratio", "tool 1e6 times as dense, partitioned",
                      Verdict::kNotFinite, ""});
  all.push_back(Fault{Defect::kNotANumber, "swallowed-tool", "pulled out in 1 s", Verdict::kNotFinite, ""});
#endif
  return all;
}
INSTANTIATE_TEST_SUITE_P(Faults, BrokenStepper, testing::ValuesIn(faults()),
                         [](const auto& param) { return fmt::format("fault_{}", param.index); });
TEST_P(BrokenStepper, MakesTheCellFail) {
  const Fault& fault = GetParam();
  const StabilityMatrix matrix = matrix_of(faulty::registry(fault.defect), {fault.row}, 3.0);
  const StabilityCell& cell = cell_of(matrix, fault.sub_case);
  EXPECT_EQ(to_string(cell.verdict), std::string(to_string(fault.verdict)))
      << cell.figure << "; " << cell.reason;
  EXPECT_NE(cell.reason.find(fault.reason), std::string::npos) << cell.reason;
  EXPECT_FALSE(cell.as_expected()) << "expected " << cell.expected.text();
  EXPECT_GT(matrix.unexpected(), 0);
}

TEST(Stability, EveryRowOfSteppersFindsAFault) {
  std::set<std::string> rows;
  for (const Fault& fault : faults()) rows.insert(fault.row);
  for (const StabilityRow& row : stability_rows())
    EXPECT_TRUE(row.slow || row.sub_cases.empty() || row.name == "thrown-handle" || rows.contains(row.name))
        << row.name;
}

TEST(Stability, WhatGoesThroughAThinPlateIsCounted) {
  StabilityOptions options;
  options.rows = {"impact"};
  options.integrators = {"backward-euler"};
  const StabilityMatrix matrix = run(options);
  EXPECT_EQ(unexpected_of(matrix), "");
  EXPECT_NE(cell_of(matrix, "0.1 m/s on a thin plate").figure.find(", 0 vertices"), std::string::npos);
  const std::string figure = cell_of(matrix, "100 m/s on a thin plate").figure;
  EXPECT_EQ(figure.find(", 0 vertices"), std::string::npos) << figure;
  EXPECT_NE(figure.find("vertices through the plate"), std::string::npos) << figure;
}

TEST(Stability, ACrashIsACell) {
  StabilityOptions options;
  options.registry = faulty::registry(Defect::kCrashes);
  options.rows = {"sizes", "poissons-ratio"};
  options.jobs = 2;
  const StabilityMatrix matrix = run(options);
  ASSERT_EQ(matrix.cells.size(), 8u) << "the other cells are still run";
  for (const StabilityCell& cell : matrix.cells) {
    EXPECT_EQ(cell.verdict, Verdict::kSilent);
    EXPECT_NE(cell.reason.find("killed by signal 6"), std::string::npos) << cell.reason;
    EXPECT_FALSE(cell.as_expected());
  }
}

TEST(Stability, DoesNotDependOnTheNumberOfProcesses) {
  const auto registry = faulty::registry(Defect::kNothing);
  const StabilityMatrix one = matrix_of(registry, {"youngs-modulus", "squashed"}, 20.0, 1),
                        three = matrix_of(registry, {"youngs-modulus", "squashed"}, 20.0, 3);
  ASSERT_EQ(one.cells.size(), three.cells.size());
  for (std::size_t i = 0; i < one.cells.size(); ++i) {
    EXPECT_EQ(one.cells[i].sub_case, three.cells[i].sub_case);
    EXPECT_EQ(one.cells[i].figure, three.cells[i].figure);
    EXPECT_EQ(one.cells[i].verdict, three.cells[i].verdict);
    EXPECT_EQ(one.cells[i].expected.text(), three.cells[i].expected.text());
  }
}

TEST(Stability, StopsBetweenCells) {
  std::atomic<bool> stop{false};
  StabilityOptions options;
  options.registry = faulty::registry(Defect::kNothing);
  options.rows = {"step"};
  options.stop = &stop;
  int calls = 0;
  options.progress = [&](double fraction, const std::string& what) {
    EXPECT_LE(fraction, 1.0);
    EXPECT_FALSE(what.empty());
    if (++calls == 2) stop = true;
  };
  const StabilityMatrix matrix = run(options);
  EXPECT_TRUE(matrix.outcome.stopped);
  EXPECT_EQ(matrix.cells.size(), 2u);
}

// Rows and cases must be unique: a cell's process finds them by name.
TEST(Stability, CasesOfARowHaveNamesOfTheirOwn) {
  std::set<std::string> rows;
  for (const StabilityRow& row : stability_rows()) {
    EXPECT_TRUE(rows.insert(row.name).second) << row.name;
    const std::set<std::string> cases(row.sub_cases.begin(), row.sub_cases.end());
    EXPECT_EQ(cases.size(), row.sub_cases.size()) << row.name;
  }
}

TEST(Stability, RefusesNamesThatItDoesNotKnow) {
  StabilityOptions options;
  options.rows = {"youngs-modules"};
  try {
    run(options);
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "unknown row \"youngs-modules\" (did you mean \"youngs-modulus\"?)");
  }
  options.rows = {};
  options.integrators = {"cvode-bdg"};
  EXPECT_THROW(run(options), Error);
}

TEST(Stability, WritesWhatItFound) {
  const TemporaryFolder folder;
  const StabilityMatrix matrix = matrix_of(faulty::registry(Defect::kGainsEnergy), {"youngs-modulus"});
  write(matrix, folder.string(), "palpate stability");
  const store::CsvTable csv = store::read_csv((folder / "stability.csv").string());
  ASSERT_EQ(csv.rows.size(), matrix.cells.size());
  EXPECT_EQ(csv.column("verdict")[0], to_string(matrix.cells[0].verdict));
  EXPECT_EQ(csv.column("expected")[0], matrix.cells[0].expected.text());
  EXPECT_EQ(csv.column("as_expected")[0], matrix.cells[0].as_expected() ? "yes" : "no");
  EXPECT_TRUE(std::filesystem::exists(folder / "stability.json"));
}

}  // namespace
