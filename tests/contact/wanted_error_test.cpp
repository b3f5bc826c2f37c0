// The image's resolution follows the wanted error of a region's force.
#include <array>
#include <cmath>

#include "backends.h"
#include "ball_between_walls.h"
#include "grid_proxies.h"
#include "palpate/proxy/pruner.h"
#include "surfaces.h"

using namespace contact_tests;

namespace {

struct Resolved {
  Total total;
  std::size_t samples;
  double estimate;  // of the error, relative
};
Resolved resolved(contact::SampleSource& source, const SkinWorld& skin) {
  std::vector<contact::ContactSample> samples;
  source.query(skin.state.view(), samples);
  return {total(samples, skin.state.view()), samples.size(), source.sum_error()->last_relative()};
}

}  // namespace

ON_EACH_BACKEND(WantedError);

// As few pixels as the wanted error allows, in the whole image and in regions: the force is as near to that
// of very many pixels, and fewer errors cost more samples.
TEST_P(WantedError, PixelsFollowTheWantedError) {
  SkinWorld skin;
  const TriMesh rigid = sphere(Vec3(0.1, 0.05, skin.vertices.row(2).maxCoeff() + 0.35), 0.5, 30);
  for (const bool pruned : {false, true}) {
    const auto look = [&](int pixels, double wanted) {
      contact::ImageOptions options = image_options(pixels, 0.02);
      options.quadrature_error = wanted;
      const auto source =
          pruned ? contact::make_image_source(skin.surface,
                                              proxies_of(skin.ball, skin.skin, skin.surface.embedding, 2),
                                              rigid, proxies_of(rigid), 0, contact::fixed_frame(), options)
                 : contact::make_image_source(skin.surface, rigid, 0, contact::fixed_frame(), options);
      return resolved(*source, skin);
    };
    const Resolved all = look(1024, 0.0);
    EXPECT_GT(all.samples, 50000u);
    EXPECT_LT(all.estimate, 2e-6);
    std::size_t before = 0;
    for (const double wanted : {1e-3, 1e-5}) {
      const Resolved some = look(1024, wanted);
      EXPECT_LT(some.estimate, 1.3 * wanted) << "pruned: " << pruned;
      EXPECT_NEAR(some.total.force.norm() / all.total.force.norm(), 1.0, 3.0 * wanted)
          << "pruned: " << pruned << ", " << some.samples << " samples";
      // a region's normal is aligned to a thousandth
      EXPECT_LT(some.total.force.normalized().cross(all.total.force.normalized()).norm(),
                pruned ? 1e-3 : 3.0 * wanted)
          << "pruned: " << pruned << ", " << some.samples << " samples";
      EXPECT_GT(some.samples, before) << "pruned: " << pruned << ", wanted " << wanted;
      before = some.samples;
    }
    EXPECT_LT(look(1024, 1e-3).samples, all.samples / 100) << "pruned: " << pruned;
    EXPECT_LT(before, all.samples / 40) << "no more than a hundred-thousandth needs, pruned: " << pruned;
    // pixels is the most that there may be; the error that is left is told
    const Resolved few = look(24, 1e-4);
    EXPECT_LT(few.samples, 24u * 24u);
    EXPECT_GT(few.estimate, 2e-4) << "pruned: " << pruned;
  }
}

// A ball that touches three walls in one region, which falls into three parts with planes of their own.
//
// A part with the share v of the volume may err e / sqrt(v) of its own.  A cap with a contact of radius a
// errs 0.102 (h / a)^2.5 on pixels of edge h (quadrature.cpp), so the three take
//     pi sum (a_i / h_i)^2 = pi (0.102 / e)^0.8 sum v_i^0.4
// pixels that press, and the sum of their volumes errs by e.  Were each part to err e of its own, they would
// take pi (0.102 / e)^0.8 three times.
TEST(WantedErrorOfParts, IsSharedByVolume) {
  std::vector<Vec3> normals;
  for (int i = 0; i < 3; ++i) {
    const double around = 2.0 * kPi * i / 3.0 + 0.3, up = 0.6;
    normals.emplace_back(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up));
  }
  const BallBetweenWalls world(normals, {0.03, 0.05, 0.08});
  double volume = 0.0, shares = 0.0;
  std::array<double, 3> of_wall{};
  for (std::size_t i = 0; i < 3; ++i) volume += of_wall[i] = world.overlap(i);
  for (const double v : of_wall) shares += std::pow(v / volume, 0.4);
  constexpr double kWanted = 1e-5;
  constexpr int kGrids = 5;  // along either axis
  double squares = 0.0, pressed = 0.0;
  for (int i = 0; i < kGrids; ++i)
    for (int j = 0; j < kGrids; ++j) {
      const auto source = world.source(kWanted, (i + 0.5) / kGrids, (j + 0.3) / kGrids);
      std::vector<contact::ContactSample> samples;
      source->query(world.state.view(), samples);
      ASSERT_EQ(source->pruning()->regions, 1) << "the parts are of one region";
      std::array<double, 3> seen{};
      for (const contact::ContactSample& s : samples) {
        if (s.gap >= 0.0) continue;
        std::size_t wall = 0;
        while (wall < 3 && s.normal.dot(world.normal[wall]) < 0.99) ++wall;
        ASSERT_LT(wall, 3u) << s.normal.transpose();
        seen[wall] -= s.gap * s.area;
        ++pressed;
      }
      double error = 0.0;
      for (std::size_t wall = 0; wall < 3; ++wall) {
        EXPECT_NEAR(seen[wall] / of_wall[wall], 1.0, 5.0 * kWanted / std::sqrt(of_wall[wall] / volume));
        error += (seen[wall] - of_wall[wall]) / volume;
      }
      squares += error * error;
      EXPECT_NEAR(source->sum_error()->last_relative() / kWanted, 1.0, 0.15);
    }
  EXPECT_LT(std::sqrt(squares / (kGrids * kGrids)), 1.25 * kWanted);
  EXPECT_NEAR(pressed / (kGrids * kGrids) / (kPi * std::pow(0.102 / kWanted, 0.8) * shares), 1.0, 0.15);
}
