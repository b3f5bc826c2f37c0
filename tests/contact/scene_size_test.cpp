// Skins as fine as those of the scenes, that deform and slide: who draws the images changes no force.
#include "palpate/proxy/pruner.h"
#include "two_balls.h"

using namespace contact_tests;

namespace {

constexpr double kApart = 0.1;  // so far that only bumps touch

/// Two soft balls with bumps that touch in several places, in some states of a slide.
struct Slide {
  TwoBalls balls{{.subdivisions = 24, .bumps = 0.08, .cells = 6}};
  dynamics::State at(int step) const {
    dynamics::State out = balls.state;
    const double phase = 0.7 * step;
    for (Eigen::Index i = 0; i < out.q().size(); i += 3) {
      auto x = out.q().segment<3>(i);
      const Vec3 bent = (2.0 * Vec3(x.y(), x.z(), x.x()).array() + phase).sin();
      x += 0.02 * bent;
      if (i >= 3 * balls.nodes_of_a())
        x += kApart * Vec3(0.17, -0.1, -0.98) + 0.05 * step * Vec3(1.0, 0.4, 0.1);
    }
    return out;
  }
};

struct Felt {
  VecX force;
  std::size_t samples;
  long regions;
};

std::vector<Felt> felt_by(const Slide& slide, contact::DepthBackend which, contact::SampleRule rule,
                          double error) {
  backend() = which;
  contact::ImageOptions options = slide.balls.options();
  options.pixels = 256;
  options.samples = rule;
  options.quadrature_error = error;
  ContactSpec law;
  law.stiffness_pa_m = 1e6;
  law.damping_pa_s_m = 1e4;
  law.friction = 0.3;
  contact::ContactForce term;
  auto source = slide.balls.source(true, options);
  const proxy::PruneCounts& counts = *source->pruning();
  term.add_pair(std::move(source), law);
  std::vector<Felt> out;
  for (int step = 0; step < 4; ++step) {
    const dynamics::State state = slide.at(step);
    const long before = counts.regions;
    term.refresh(state.view());
    out.push_back({VecX::Zero(state.view().u.size()), term.samples().size(), counts.regions - before});
    term.add_force(state.view(), out.back().force);
  }
  return out;
}

}  // namespace

ON_EACH_BACKEND(SceneSize);

TEST_P(SceneSize, ForcesAreThoseOfExactLines) {
  const Slide slide;
  EXPECT_GT(slide.balls.a.surface.faces.cols(), 10000);
  for (const auto rule : {contact::SampleRule::kPixel, contact::SampleRule::kVertex})
    for (const double error : {0.0, 1e-3}) {
      const std::vector<Felt> exact = felt_by(slide, contact::DepthBackend::kExact, rule, error),
                              here = felt_by(slide, GetParam(), rule, error);
      for (std::size_t i = 0; i < exact.size(); ++i) {
        SCOPED_TRACE(testing::Message()
                     << "rule " << static_cast<int>(rule) << ", error " << error << ", state " << i);
        EXPECT_GE(exact[i].regions, 2);
        EXPECT_GT(exact[i].samples, 200u);
        EXPECT_GT(exact[i].force.norm(), 100.0);
        EXPECT_EQ(here[i].samples, exact[i].samples);
        EXPECT_LT((here[i].force - exact[i].force).norm(), 1e-12 * exact[i].force.norm());
      }
    }
}
