#include "palpate/contact/query_view.h"

#include <algorithm>

#include "grid_proxies.h"
#include "images.h"
#include "surfaces.h"

using namespace contact_tests;

namespace {

/// A soft unit sphere over a rigid sphere of radius 0.8, with an oblique line of centres: a lens `kDepth`
/// thick.
constexpr double kDepth = 0.1;
struct Lens {
  Vec3 axis = Vec3(0.3, -0.5, 0.8).normalized();
  TriMesh rigid = sphere(Vec3(0.2, 0.1, -0.1), 0.8, 40);
  SurfaceWorld soft{sphere(Vec3(0.2, 0.1, -0.1) + (1.8 - kDepth) * axis, 1.0, 50)};
};

Vec3 world(const contact::RegionView& region, int column, int row, double w) {
  return region.origin + region.axes * Vec3(region.u0 + (column + 0.5) * region.pixel,
                                            region.v0 + (row + 0.5) * region.pixel, w);
}

}  // namespace

TEST(QueryView, IsKeptOnlyWhereItWasAskedFor) {
  Lens lens;
  const auto source = contact::make_image_source(lens.soft.surface, lens.rigid, 0, contact::fixed_frame(),
                                                 image_options(64, 0.05));
  std::vector<contact::ContactSample> samples;
  source->query(lens.soft.state.view(), samples);
  EXPECT_EQ(source->report().view, nullptr);
  source->keep_view();
  for (int i = 0; i < 2; ++i) {  // the view shows the last query only
    source->query(lens.soft.state.view(), samples);
    ASSERT_NE(source->report().view, nullptr);
    EXPECT_EQ(source->report().view->regions.size(), 1u);
  }
  lens.soft.state.q().array() += 50.0;
  source->query(lens.soft.state.view(), samples);
  EXPECT_TRUE(source->report().view->regions.empty());
}

// A pixel of the grid lies on both spheres at its stored heights; the volume of the grid is the lens's, and
// about that of the samples at vertices.
TEST(QueryView, PixelsLieOnTheSurfaces) {
  Lens lens;
  const auto source = contact::make_image_source(lens.soft.surface, lens.rigid, 0, contact::fixed_frame(),
                                                 image_options(128, 0.05));
  source->keep_view();
  std::vector<contact::ContactSample> samples;
  source->query(lens.soft.state.view(), samples);
  const contact::RegionView& region = source->report().view->regions.at(0);
  ASSERT_EQ(region.gap.size(),
            static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height));
  EXPECT_GT(region.axes.col(2).dot(lens.axis), 0.99);
  double deepest = 0.0, volume = 0.0;
  std::size_t seen = 0;
  for (int row = 0; row < region.height; ++row)
    for (int column = 0; column < region.width; ++column) {
      const auto at = static_cast<std::size_t>(row * region.width + column);
      const double gap = region.gap[at], w = region.height_a[at];
      ASSERT_EQ(std::isnan(gap), std::isnan(w));
      if (std::isnan(gap)) continue;
      ++seen;
      const Vec3 a = world(region, column, row, w), b = world(region, column, row, w - gap);
      ASSERT_NEAR((a - (Vec3(0.2, 0.1, -0.1) + (1.8 - kDepth) * lens.axis)).norm(), 1.0, 3e-3);  // facets
      ASSERT_NEAR((b - Vec3(0.2, 0.1, -0.1)).norm(), 0.8, 3e-3);
      deepest = std::min(deepest, gap);
      volume += std::max(0.0, -gap) * region.pixel * region.pixel;
    }
  EXPECT_NEAR(deepest, -kDepth, 4e-3);
  EXPECT_GT(seen, 5000u);
  const double D = 1.8 - kDepth, h = kDepth,
               lens_volume = M_PI * h * h * (D * D + 2.0 * D * 1.8 - 3.0 * 0.04) / (12.0 * D);
  EXPECT_NEAR(volume, lens_volume, 0.03 * lens_volume) << "facets";
  double by_vertices = 0.0;
  for (const auto& s : samples) by_vertices += std::max(0.0, -s.gap) * s.area;
  EXPECT_NEAR(by_vertices, volume, 0.05 * volume);
}

TEST(QueryView, HullsAreThoseOfProxiesThatPress) {
  SkinWorld skin;
  const Vec3 centre(0.1, 0.05, skin.vertices.row(2).maxCoeff() + 0.35);
  const TriMesh rigid = sphere(centre, 0.5, 30);
  const auto proxies = proxies_of(skin.ball, skin.skin, skin.surface.embedding, 3);
  const auto source = contact::make_image_source(skin.surface, proxies, rigid, proxies_of(rigid), 0,
                                                 contact::fixed_frame(), image_options(128, 0.02));
  source->keep_view();
  std::vector<contact::ContactSample> samples;
  source->query(skin.state.view(), samples);
  const contact::QueryView& view = *source->report().view;
  EXPECT_FALSE(view.regions.empty());
  ASSERT_EQ(view.proxies_b.size(), 1u);  // a ball is a single hull
  for (const auto corner : view.proxies_b[0].colwise()) EXPECT_NEAR((corner - centre).norm(), 0.5, 1e-9);
  EXPECT_GT(view.proxies_a.size(), 0u);
  EXPECT_LT(static_cast<int>(view.proxies_a.size()), proxies->size());  // the ball's far side is pruned
  for (const Points& hull : view.proxies_a) EXPECT_EQ(hull.cols(), 8);
  const auto box_distance = [&](const Points& hull) {
    const Vec3 low = hull.rowwise().minCoeff(), high = hull.rowwise().maxCoeff();
    return (low - centre).cwiseMax(centre - high).cwiseMax(0.0).norm();
  };
  // pairs are kept whose inflated hulls may be nearer than the candidate gap
  double inflation = 0.0;
  for (int p = 0; p < proxies->size(); ++p) inflation = std::max(inflation, proxies->state(p).inflation);
  for (const Points& hull : view.proxies_a) EXPECT_LT(box_distance(hull), 0.5 + 0.02 + inflation);
}

// Contact points of the view are the samples, with the law's pressure.
TEST(QueryView, PointsAreTheSamples) {
  Lens lens;
  const contact::ImageOptions options = image_options(64, 0.05);
  contact::ContactForce term;
  term.add_frame(contact::fixed_frame());
  ContactSpec law;
  law.stiffness_pa_m = 2e4;
  term.add_pair(contact::make_image_source(lens.soft.surface, lens.rigid, 0, contact::fixed_frame(), options),
                law);
  term.refresh(lens.soft.state.view());
  const auto points = term.points(lens.soft.state.view());
  ASSERT_EQ(points.size(), term.samples().size());
  int pressed = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const contact::ContactPoint& p = points[i];
    EXPECT_EQ(p.pair, 0);
    EXPECT_NEAR(p.gap, p.normal.dot(p.a - p.b), 1e-13);
    EXPECT_NEAR(p.pressure, 2e4 * std::max(0.0, -p.gap), 1e-9);
    EXPECT_EQ(p.area, term.samples()[i].area);
    EXPECT_LT((p.a - position(term.samples()[i].a, lens.soft.state)).norm(), 1e-13);
    pressed += p.gap < 0.0;
  }
  EXPECT_GT(pressed, 20);
}
