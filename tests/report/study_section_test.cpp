#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "palpate/core/error.h"
#include "report/answers.h"
#include "report/run_report.h"
#include "report/study_columns.h"
#include "temporary_folder.h"
#include "well_formed.h"

using namespace palpate;
using namespace palpate::report;

namespace {

std::string read(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

/// Two integrators, two moduli, two seeds; one task failed, one is missing.
const std::string kStudy =
    "task,scene,integrator,rtol,body.0.youngs_modulus_pa,seed,body.0.density_kg_m3,status,reason,"
    "peak_force_n,steps,end_state\n"
    "0,a.toml,cvode-bdf,0.001,1e3,1,900,ok,,1,10,aa\n"
    "1,a.toml,cvode-bdf,0.001,1e3,2,1100,ok,,3,11,ab\n"
    "2,a.toml,cvode-bdf,0.001,1e5,1,900,ok,,5,12,ac\n"
    "3,a.toml,cvode-bdf,0.001,1e5,2,1100,failed,too many <steps>,99,,\n"
    "4,a.toml,bdf2,,1e3,1,900,ok,,2,10,ba\n"
    "5,a.toml,bdf2,,1e3,2,1100,ok,,2,10,bb\n"
    "6,a.toml,bdf2,,1e5,1,900,ok,,8,10,bc\n"
    "7,a.toml,bdf2,,1e5,2,1100,missing,,,,\n";

Table table_of(const std::string& text) {
  const TemporaryFolder folder;
  return read_csv(folder.write("study.csv", text));
}

}  // namespace

TEST(StudySection, KnowsWhatIsSweptAndWhatIsDrawn) {
  const StudyColumns columns = columns_of_study(table_of(kStudy));
  EXPECT_EQ(columns.swept, std::vector<std::string>{"body.0.youngs_modulus_pa"});
  EXPECT_EQ(columns.drawn, std::vector<std::string>{"body.0.density_kg_m3"});
  EXPECT_TRUE(columns.seeds);
  const auto groups = groups_of(table_of(kStudy), columns, {"seed", "body.0.density_kg_m3"});
  ASSERT_EQ(groups.size(), 4u);
  EXPECT_EQ(groups[0].name, "cvode-bdf, rtol 0.001, body.0.youngs_modulus_pa 1e3");
  EXPECT_EQ(groups[3].name, "bdf2, body.0.youngs_modulus_pa 1e5");
  EXPECT_EQ(groups[3].rows, (std::vector<std::size_t>{6, 7}));
  EXPECT_THROW(columns_of_study(table_of("a,b\n1,2\n")), Error);
}

TEST(StudySection, AnswersInWords) {
  const Answer answer = study_answer(table_of(kStudy));
  EXPECT_EQ(answer.lead, "6 of 8 tasks finished; 1 failed, 1 missing.");
  ASSERT_GE(answer.points.size(), 2u);
  EXPECT_EQ(answer.points[0], "failed, task 3: too many <steps>") << "as standard output has it";
  EXPECT_EQ(answer.points[1], "Peak force on the hand [N]: from 1 (task 0) to 8 (task 6).")
      << "a task that failed says nothing of the force";
  const Answer all = study_answer(table_of("task,scene,status,reason,steps\n0,a,ok,,3\n1,b,ok,,4\n"));
  EXPECT_EQ(all.lead, "All 2 tasks finished.");
}

TEST(StudySection, DrawsTheSweepAndTheSeeds) {
  const TemporaryFolder folder;
  folder.write("study.csv", kStudy);
  folder.write("study-times.csv",
               "task,status,loop_cpu_s\n0,ok,1\n1,ok,2\n2,ok,3\n3,failed,4\n4,ok,5\n5,ok,6\n"
               "6,ok,7\n7,missing,\n");
  folder.write("study.toml", "[study] # a < b\n");
  const RunReport written = write_run_report(folder.path());
  EXPECT_TRUE(written.missing_figures.empty());
  const std::string html = read(written.page);
  EXPECT_EQ(well_formed_problem(html), "");
  for (const char* text :
       {"<h1>Study</h1>", "Peak force on the hand [N] over body 0: Young", "CPU time [s] over ",
        "\"x_label\":\"body 0: Young's modulus [Pa]\"", "lines are means over the seeds",
        "Spread over the seeds", "too many &lt;steps&gt;", "[study] # a &lt; b", "All figures of all tasks"})
    EXPECT_NE(html.find(text), std::string::npos) << text;
  EXPECT_EQ(count_of(html, "class=\"plot-data\""), 3u) << "force, steps, CPU";
  // mean and deviation of 1 and 3
  EXPECT_NE(html.find(">2 ± 1.41</td>"), std::string::npos);
}

/// Returns whether the first chart of a sweep of `key` over these values is logarithmic along x.
bool log_axis(const std::vector<double>& values, bool declared = false) {
  const TemporaryFolder folder;
  std::string study = "task,scene,integrator,key,status,reason,steps\n";
  for (std::size_t i = 0; i < values.size(); ++i)
    study += fmt::format("{},a,bdf2,{},ok,,{}\n", i, values[i], 10 + i);
  folder.write("study.csv", study);
  if (declared)
    folder.write("summary.json", R"({"scene": "s", "figures": {"log_spaced_parameters": [{"key": "key"}]}})");
  const std::string html = read(write_run_report(folder.path()).page);
  EXPECT_EQ(count_of(html, "\"log_x\":true") + count_of(html, "\"log_x\":false"), 1u);
  return count_of(html, "\"log_x\":true") == 1u;
}

TEST(StudySection, ASweepOfEqualRatiosHasALogarithmicAxis) {
  EXPECT_TRUE(log_axis({1e4, 1.414e4, 2e4, 2.828e4, 4e4})) << "whatever its range";
  EXPECT_TRUE(log_axis({1, 10, 100, 1000}));
  EXPECT_TRUE(log_axis({0.001, 0.01}, true)) << "the study says so";
  EXPECT_TRUE(log_axis({1.0, 2.0}, true));
  EXPECT_TRUE(log_axis({1e3, 1e5}));
  EXPECT_FALSE(log_axis({1.0, 2.0}));
  EXPECT_FALSE(log_axis({1, 21, 41, 61, 81, 101})) << "equal differences, though over two decades";
  EXPECT_FALSE(log_axis({-1, 0, 1, 2}));
  EXPECT_FALSE(log_axis({0, 0.5, 1}, true)) << "zero has no logarithm";
}

TEST(StudySection, FiguresOverDecadesHaveALogarithmicAxis) {
  const auto log_y = [](const std::string& last) {
    const TemporaryFolder folder;
    folder.write("study.csv",
                 "task,scene,integrator,key,status,reason,peak_force_n\n0,a,bdf2,1,ok,,0.02\n"
                 "1,a,bdf2,10,ok,,0.3\n2,a,bdf2,100,ok,," +
                     last + "\n");
    const std::string html = read(write_run_report(folder.path()).page);
    EXPECT_EQ(count_of(html, "\"log_y\":true") + count_of(html, "\"log_y\":false"), 1u);
    return count_of(html, "\"log_y\":true") == 1u;
  };
  EXPECT_TRUE(log_y("4"));
  EXPECT_FALSE(log_y("0.5")) << "a factor of 25";
  EXPECT_FALSE(log_y("-4")) << "a negative number has no logarithm";
  EXPECT_FALSE(log_y("0"));
}

TEST(StudySection, WithoutASweepThereIsNoChart) {
  const TemporaryFolder folder;
  folder.write("study.csv", "task,scene,integrator,status,reason,steps\n0,a,bdf2,ok,,3\n1,b,bdf2,ok,,4\n");
  const std::string html = read(write_run_report(folder.path()).page);
  EXPECT_EQ(well_formed_problem(html), "");
  EXPECT_EQ(count_of(html, "class=\"plot-data\""), 0u);
  EXPECT_EQ(html.find("Spread over"), std::string::npos);
}
