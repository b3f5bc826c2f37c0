// The image's resolution follows the wanted error of a region's force.
#include "backends.h"
#include "grid_proxies.h"
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
  return {total(samples, skin.state.view()), samples.size(), source.stages()->quadrature_error};
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
