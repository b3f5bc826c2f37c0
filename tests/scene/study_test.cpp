#include "scene/study.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "messages.h"
#include "palpate/core/error.h"

using namespace palpate;
using scene::drawn_value;
using scene::parse_study;
using scene::RandomSpec;

namespace {

const std::string kHead = "[study]\nscenes = [\"press-ball\"]\n";

void expect_refused(const std::string& text, std::initializer_list<const char*> words) {
  const std::string said = expectations::message_of([&] { parse_study(text, "my.toml"); });
  for (const char* word : words) expectations::expect_contains(said, word);
}

RandomSpec drawn_from(scene::Distribution distribution, double min, double max) {
  RandomSpec out;
  out.key = "body.0.youngs_modulus_pa";
  out.distribution = distribution;
  out.min = min;
  out.max = max;
  return out;
}

}  // namespace

TEST(Study, HoldsWhatTheFileSays) {
  const scene::StudySpec spec = parse_study(R"([study]
scenes = ["press-ball", "my.toml"]
integrators = ["cvode-bdf"]
rtol = [1e-3, 1e-5]
seeds = 3
set = ["record.energy=true"]
limit_s = 9
[[sweep]]
key = "body.0.youngs_modulus_pa"
from = 1e3
to = 1e5
count = 3
spacing = "log"
[[sweep]]
key = "body.0.name"
values = ["it's", 2, 3.0, [1, 2.5], true]
[[random]]
key = "body.0.poissons_ratio"
min = 0.3
max = 0.4
)",
                                            "folder/softness.toml");
  EXPECT_EQ(spec.name, "softness");
  EXPECT_EQ(spec.scenes, (std::vector<std::string>{"press-ball", "my.toml"}));
  EXPECT_EQ(spec.rtol, (std::vector<double>{1e-3, 1e-5}));
  EXPECT_EQ(spec.seeds, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(spec.limit_s, 9.0);
  EXPECT_EQ(spec.repeats, 1);
  ASSERT_EQ(spec.sweeps.size(), 2u);
  EXPECT_EQ(spec.sweeps[0].values, (std::vector<std::string>{"1000.0", "10000.0", "100000.0"}));
  EXPECT_EQ(spec.sweeps[1].values, (std::vector<std::string>{"\"it's\"", "2", "3.0", "[1, 2.5]", "true"}));
  EXPECT_EQ(parse_study(kHead, "x.toml").seeds.size(), 0u);
}

TEST(Study, RangesEndWhereTheySay) {
  const auto spec =
      parse_study(kHead + "[[sweep]]\nkey = \"a.b\"\nfrom = 0.1\nto = 0.7\ncount = 4\n", "x.toml");
  EXPECT_EQ(spec.sweeps[0].values, (std::vector<std::string>{"0.1", "0.3", "0.5", "0.7"}));
}

TEST(Study, NamesTheNearestKeyAndThePlace) {
  expect_refused("[study]\nscenes = [\"a\"]\nintegrator = [\"b\"]\n",
                 {"my.toml:3:1: study: ", "\"integrator\"", "did you mean \"integrators\"?"});
  expect_refused(kHead + "[[sweep]]\nkey = \"a\"\nvlaues = [1]\n",
                 {"my.toml:5:1", "did you mean \"values\"?"});
  expect_refused(kHead + "[sweeep]\n", {"did you mean \"sweep\"?"});
  expect_refused(kHead + "[[random]]\nkey = \"a\"\ndistribution = \"unifrom\"\n",
                 {"\"unifrom\"", "did you mean \"uniform\"?"});
  expect_refused("[study]\n", {"scenes is missing"});
  expect_refused("[study]\nscenes = 3\n", {"my.toml:2:", "must be a list of strings"});
  expect_refused("[study\n", {"my.toml:1:", "not valid TOML"});
}

TEST(Study, RefusesWhatMakesNoSense) {
  const std::string sweep = "[[sweep]]\nkey = \"a.b\"\n", values = "values = [1, 2]\n";
  expect_refused("[study]\nscenes = []\n", {"at least one scene"});
  expect_refused("[study]\nscenes = [\"a\", \"a\"]\n", {"scenes has a twice"});
  expect_refused(kHead + "rtol = [1e-3, 0.001]\n", {"rtol has 0.001 twice"});
  expect_refused(kHead + "rtol = [-1]\n", {"rtol", "must be positive"});
  expect_refused(kHead + "seeds = 3\n", {"seeds without a [[random]] key", "repeats"});
  expect_refused(kHead + "[[random]]\nkey = \"a\"\nmin = 1\nmax = 2\n", {"seeds is missing"});
  expect_refused(kHead + sweep, {"sweep of \"a.b\"", "give values"});
  expect_refused(kHead + sweep + "values = []\n", {"at least one value"});
  expect_refused(kHead + sweep + "values = [1, 1]\n", {"the value 1 is given twice"});
  expect_refused(kHead + sweep + values + "count = 3\n", {"exclude each other"});
  expect_refused(kHead + sweep + "from = 1\n", {"belong together"});
  expect_refused(kHead + sweep + "from = 0\nto = 1\ncount = 3\nspacing = \"log\"\n", {"must be positive"});
  expect_refused(kHead + sweep + values + sweep + values, {"\"a.b\" is varied twice"});
  expect_refused(kHead + sweep + values + "together = true\n", {"needs a [[sweep]] before it"});
  expect_refused(kHead + sweep + values + "[[sweep]]\nkey = \"c\"\nvalues = [1]\ntogether = true\n",
                 {"together with \"a.b\", which has 2 values", "not 1"});
  expect_refused(kHead + "[[sweep]]\nkey = \"integrator.name\"\n" + values, {"set integrators in [study]"});
  expect_refused(kHead + "rtol = [1e-3]\n[[sweep]]\nkey = \"integrator.rtol\"\nvalues = [1e-4]\n",
                 {"[study] lists it too"});
  const std::string random = "seeds = 2\n[[random]]\nkey = \"a\"\n";
  expect_refused(kHead + random, {"needs min and max"});
  expect_refused(kHead + random + "min = 2\nmax = 1\n", {"max must be greater than min"});
  expect_refused(kHead + random + "min = 0\nmax = 1\ndistribution = \"log-uniform\"\n", {"must be positive"});
  expect_refused(kHead + random + "distribution = \"normal\"\nmean = 1\n", {"standard_deviation"});
  expect_refused(kHead + random + "min = 0\nmax = 1\nmean = 1\n", {"belong to distribution = \"normal\""});
}

TEST(Study, AFileThatIsNotThereIsNamed) {
  const auto load = [] { scene::load_study("/no/such/study.toml"); };
  expectations::expect_contains(expectations::message_of(load), "/no/such/study.toml: no such study file");
}

TEST(StudySeeds, DrawFromTheDistributionThatTheyAreSaidTo) {
  constexpr int kSeeds = 4000;
  const auto moments = [](const RandomSpec& random, auto of) {
    double sum = 0.0, square = 0.0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      const double x = of(std::stod(drawn_value(random, seed)));
      EXPECT_GE(std::stod(drawn_value(random, seed)), random.min.value_or(-HUGE_VAL));
      EXPECT_LE(std::stod(drawn_value(random, seed)), random.max.value_or(HUGE_VAL));
      sum += x, square += x * x;
    }
    const double mean = sum / kSeeds;
    return std::pair(mean, std::sqrt(square / kSeeds - mean * mean));
  };
  const auto same = [](double x) { return x; };
  // five standard deviations of the mean of that many samples
  const auto uniform = moments(drawn_from(scene::Distribution::kUniform, 2.0, 6.0), same);
  EXPECT_NEAR(uniform.first, 4.0, 5.0 * 4.0 / std::sqrt(12.0 * kSeeds));
  EXPECT_NEAR(uniform.second, 4.0 / std::sqrt(12.0), 0.05);
  const auto log =
      moments(drawn_from(scene::Distribution::kLogUniform, 1e3, 1e5), [](double x) { return std::log10(x); });
  EXPECT_NEAR(log.first, 4.0, 5.0 * 2.0 / std::sqrt(12.0 * kSeeds));
  EXPECT_NEAR(log.second, 2.0 / std::sqrt(12.0), 0.03);
  RandomSpec normal;
  normal.key = "a";
  normal.distribution = scene::Distribution::kNormal;
  normal.mean = 10.0;
  normal.standard_deviation = 2.0;
  const auto gauss = moments(normal, same);
  EXPECT_NEAR(gauss.first, 10.0, 5.0 * 2.0 / std::sqrt(1.0 * kSeeds));
  EXPECT_NEAR(gauss.second, 2.0, 0.12);
  normal.min = 9.0;
  normal.max = 11.0;
  moments(normal, same);  // all values are between the bounds
  normal.min = 100.0;
  normal.max = 101.0;
  EXPECT_THROW(drawn_value(normal, 1), Error);
}

TEST(StudySeeds, DependOnSeedAndKeyAlone) {
  RandomSpec one = drawn_from(scene::Distribution::kUniform, 0.0, 1.0), other = one;
  other.key = "body.0.density_kg_m3";
  EXPECT_EQ(drawn_value(one, 7), drawn_value(one, 7));
  std::set<std::string> values;
  for (int seed = 0; seed < 200; ++seed) {
    values.insert(drawn_value(one, seed));
    EXPECT_NE(drawn_value(one, seed), drawn_value(other, seed));
  }
  EXPECT_GE(values.size(), 199u) << "six digits of 200 draws hardly ever meet";
}

// Computed independently of any library, in Python, from the text of the standard: [rand.util.seedseq] for
// the seeding, [rand.eng.mers] for the first number x of 64 bits, and floor(x / 2^11) / 2^53.
TEST(StudySeeds, AreTheSameOnEveryMachine) {
  EXPECT_EQ(drawn_value(drawn_from(scene::Distribution::kUniform, 0.0, 1.0), 1), "0.0514308");
  EXPECT_EQ(drawn_value(drawn_from(scene::Distribution::kUniform, 0.0, 1.0), 2), "0.843484");
}
