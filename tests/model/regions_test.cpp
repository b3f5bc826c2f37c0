#include "model/regions.h"

#include <gtest/gtest.h>

#include "model/make_model.h"
#include "palpate/mesh/quality.h"
#include "surfaces.h"

using namespace palpate;
using namespace surfaces;

namespace {

model::RegionSource source(const std::string& name, const TriMesh& surface) {
  return {name, false, surface, from()};
}

std::vector<MaterialRegion> added(const TetMesh& tets, const std::vector<model::RegionSource>& sources,
                                  std::vector<MaterialRegion> before = {}) {
  std::vector<double> volumes;
  return model::add_regions(tets, {}, std::move(before), sources, volumes);
}

Vec3 middle(const TetMesh& mesh, int tet) {
  return mesh.nodes(Eigen::all, mesh.tets.col(tet)).rowwise().mean();
}

std::string refused(const std::function<void()>& f) { return refusal(f); }

TEST(Regions, AreTheTetrahedraWithTheirMiddleInside) {
  const TetMesh tets = mesh::ball(1.0, 0.12);
  std::vector<double> volumes;
  const std::vector<MaterialRegion> regions =
      model::add_regions(tets, {}, {}, {source("core", ball(0.5, 20))}, volumes);
  ASSERT_EQ(regions.size(), 1u);
  std::vector<char> in(static_cast<std::size_t>(tets.tets.cols()), 0);
  for (const int tet : regions[0].tets) in[static_cast<std::size_t>(tet)] = 1;
  double volume = 0.0;
  int near = 0;
  for (int t = 0; t < tets.tets.cols(); ++t) {
    const double r = middle(tets, t).norm();
    if (std::abs(r - 0.5) < 0.004)
      ++near;  // deviation of the ball's facets
    else
      EXPECT_EQ(in[static_cast<std::size_t>(t)] != 0, r < 0.5) << r;
    if (in[static_cast<std::size_t>(t)]) volume += mesh::tet_volume(tets, t);
  }
  EXPECT_LT(near, tets.tets.cols() / 20);
  EXPECT_NEAR(volumes[0], surfaces::volume(ball(0.5, 20)), 1e-12);
  EXPECT_NEAR(volume / volumes[0], 1.0, 0.08);
}

TEST(Regions, TheLastSourceHasATetrahedron) {
  const TetMesh tets = mesh::ball(1.0, 0.2);
  const std::vector<MaterialRegion> regions =
      added(tets, {source("shell", ball(2.0)), source("core", ball(0.5))});
  ASSERT_EQ(regions.size(), 2u);
  EXPECT_EQ(static_cast<Eigen::Index>(regions[0].tets.size() + regions[1].tets.size()), tets.tets.cols());
  const std::vector<MaterialRegion> beside =
      added(tets, {source("core", ball(0.5))}, {{"left", {0, 1, 2}}, {"right", {3}}});
  EXPECT_EQ(beside.back().tets, regions[1].tets);
  for (const MaterialRegion& region : beside)
    EXPECT_TRUE(std::is_sorted(region.tets.begin(), region.tets.end()));
  EXPECT_EQ(added(tets, {source("core", ball(0.5)), source("all", ball(2.0))}).size(), 1u)
      << "what is left with none goes";
}

TEST(Regions, OfTheBones) {
  const TetMesh tets = mesh::ball(1.0, 0.15);
  Skeleton skeleton;
  skeleton.bones = {{"a", -1, {0, 0, -0.5}, {0, 0, 0.5}, 0.3, 0.3}};
  std::vector<double> volumes;
  const std::vector<MaterialRegion> regions =
      model::add_regions(tets, skeleton, {}, {{"bone", true, {}, {}}}, volumes);
  ASSERT_EQ(regions.size(), 1u);
  for (const int tet : regions[0].tets) {
    const Vec3 p = middle(tets, tet), nearest(0, 0, std::clamp(p.z(), -0.5, 0.5));
    EXPECT_LE((p - nearest).norm(), 0.3 + 1e-12);
  }
  double volume = 0.0;
  for (const int tet : regions[0].tets) volume += mesh::tet_volume(tets, tet);
  EXPECT_NEAR(volume, M_PI * 0.09 * (1.0 + 0.4), 0.1 * volume);  // a capsule: pi r^2 (L + 4 r / 3)
}

TEST(Regions, Refusals) {
  const TetMesh tets = mesh::ball(1.0, 0.3);
  EXPECT_NE(refused([&] { added(tets, {source("core", ball(0.5, 8, Vec3(3, 0, 0)))}); })
                .find("--region core=test.obj: no tetrahedron has its centroid inside: the surface extends "
                      "from (2.5, "),
            std::string::npos);
  EXPECT_NE(refused([&] {
              added(tets, {source("left", ball(0.5))}, {{"left", {0}}});
            }).find("there is already a region of this name"),
            std::string::npos);
  EXPECT_NE(refused([&] {
              added(tets, {{"bone", true, {}, {}}});
            }).find("the model has no bones"),
            std::string::npos);
  EXPECT_NE(refused([&] {
              added(tets, {source("core", without(ball(), [](const Vec3& p) { return p.z() > 0; }))});
            }).find("hole"),
            std::string::npos);
}

TEST(Regions, GoThroughTheWholeOfIt) {
  model::Input input;
  input.name = "test";
  input.source = input.from.source = "test.msh";
  input.tets = mesh::ball(1.0, 0.25);
  input.regions = {{"upper", {}}};
  for (int t = 0; t < input.tets.tets.cols(); ++t)
    if (middle(input.tets, t).z() > 0) input.regions[0].tets.push_back(t);
  model::Options options;
  options.proxies = 0;
  options.regions = {source("core", ball(0.4))};
  options.scale = 1e-3;
  model::ProgressListener silent;
  const model::Made taken = model::make_model(input, options, silent);
  ASSERT_EQ(taken.file.model.regions.size(), 2u);
  ASSERT_EQ(taken.regions.size(), 2u);
  EXPECT_EQ(taken.regions[1].name, "core");
  EXPECT_NEAR(taken.regions[1].surface_volume, 1e-9 * surfaces::volume(ball(0.4)), 1e-21)
      << "scaled as the body is";
  options.regions.clear();
  options.remesh = true;
  options.tetrahedra.tetrahedra = 1500;
  const model::Made anew = model::make_model(input, options, silent);
  ASSERT_EQ(anew.file.model.regions.size(), 1u);
  EXPECT_NEAR(anew.regions[0].volume / anew.quality.volume, 0.5, 0.02);
  EXPECT_NE(anew.file.record.notes.back().find("transferred"), std::string::npos);
}

}  // namespace
