// The image's resolution follows the wanted error of a region's force.
#include <array>
#include <cmath>
#include <numeric>
#include <set>

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

// A ball that touches three walls in one region, which falls into three parts with planes of their own.
//
// A part with the share v of the volume may err e / sqrt(v) of its own.  A cap with a contact of radius a
// errs 0.102 (h / a)^2.5 on pixels of edge h (quadrature.cpp), so the three take
//     pi sum (a_i / h_i)^2 = pi (0.102 / e)^0.8 sum v_i^0.4
// pixels that press, and the sum of their volumes errs by e.  Were each part to err e of its own, they would
// take pi (0.102 / e)^0.8 three times.
namespace {

struct BallBetweenWalls {
  static constexpr std::array<double, 3> kDepth = {0.03, 0.05, 0.08};
  std::array<Vec3, 3> normal;
  LayeredModel ball, walls;
  dynamics::State state;
  contact::NodeSurface surface;

  BallBetweenWalls() {
    ball.tets = mesh::ball(1.0, 0.45);
    ball.skin = mesh::sphere(1.0, 40);
    ball.embedding = mesh::embed(ball.tets, ball.skin.vertices);
    ball.proxies.resize(3);
    for (std::size_t i = 0; i < 3; ++i) {
      const double around = 2.0 * kPi * static_cast<double>(i) / 3.0 + 0.3, up = 0.6;
      normal[i] = Vec3(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around),
                       std::sin(up));  // on the ball
    }
    cut_in_sectors();
    build_walls();
    dynamics::BlockSpec nodes;
    nodes.name = "ball";
    nodes.q_size = nodes.u_size = static_cast<int>(ball.tets.nodes.size());
    surface.block_id = state.insert(nodes, Eigen::Map<const VecX>(ball.tets.nodes.data(), nodes.q_size),
                                    VecX::Zero(nodes.u_size));
    surface.faces = ball.skin.faces;
    surface.embedding = ball.embedding;
    surface.tets = ball.tets.tets;
  }

  double distance(const Vec3& x, std::size_t wall) const {  // of the ball's skin, above a wall's face
    return normal[wall].dot(x) + 1.0 - kDepth[wall];
  }

  /// What of the skin's polyhedron is beyond a wall's face: over each triangle the integral of the depth, of
  /// one that the face cuts over what is left of it, in triangles, where the depth is linear.
  double overlap(std::size_t wall) const {
    double volume = 0.0;
    for (const auto corner : ball.skin.faces.colwise()) {
      std::vector<Vec3> inside;
      for (int k = 0; k < 3; ++k) {
        const Vec3 p = ball.skin.vertices.col(corner[k]), q = ball.skin.vertices.col(corner[(k + 1) % 3]);
        const double at_p = distance(p, wall), at_q = distance(q, wall);
        if (at_p < 0.0) inside.push_back(p);
        if ((at_p < 0.0) != (at_q < 0.0)) inside.push_back(p + at_p / (at_p - at_q) * (q - p));
      }
      for (std::size_t k = 2; k < inside.size(); ++k) {
        const Vec3 area = 0.5 * (inside[k - 1] - inside[0]).cross(inside[k] - inside[0]);
        volume += area.dot(normal[wall]) / 3.0 *
                  (distance(inside[0], wall) + distance(inside[k - 1], wall) + distance(inside[k], wall));
      }
    }
    return volume;
  }

  std::unique_ptr<contact::SampleSource> source(double wanted, double shift_u, double shift_v) const {
    contact::ImageOptions options;
    options.pixels = 1024;
    options.quadrature_error = wanted;
    options.candidate_gap = 0.002;
    options.shift_u = shift_u;
    options.shift_v = shift_v;
    return contact::make_image_source(surface, std::make_shared<proxy::ProxySet>(ball), walls.skin,
                                      std::make_shared<proxy::ProxySet>(walls), 0, contact::fixed_frame(),
                                      options);
  }

 private:
  static void bound(ProxyHull& hull, const Points& vertices) {
    const Points points = vertices(Eigen::all, hull.members);
    const Vec3 low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
    hull.corners.resize(3, 8);
    for (int i = 0; i < 8; ++i)
      hull.corners.col(i) =
          Vec3(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
  }
  /// One proxy about each wall.
  void cut_in_sectors() {
    std::array<std::set<int>, 3> members;
    for (const auto corner : ball.skin.faces.colwise()) {
      Vec3 middle = Vec3::Zero();
      for (const int v : corner) middle += ball.skin.vertices.col(v) / 3.0;
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < 3; ++i)
        if (normal[i].dot(middle) < normal[nearest].dot(middle)) nearest = i;
      members[nearest].insert(corner.begin(), corner.end());
    }
    for (std::size_t i = 0; i < 3; ++i) {
      ball.proxies[i].members.assign(members[i].begin(), members[i].end());
      bound(ball.proxies[i], ball.skin.vertices);
    }
  }
  /// Three slabs in one proxy, whose hull is full of the ball.
  void build_walls() {
    const TriMesh slab = mesh::box_surface(Vec3(1.1, 1.1, 0.3), {8, 8, 2});
    const Eigen::Index vertices = slab.vertices.cols(), faces = slab.faces.cols();
    walls.skin.vertices.resize(3, 3 * vertices);
    walls.skin.faces.resize(3, 3 * faces);
    for (std::size_t i = 0; i < 3; ++i) {
      const Quat turn = Quat::FromTwoVectors(Vec3::UnitZ(), normal[i]);
      const auto at = static_cast<Eigen::Index>(i);
      for (Eigen::Index v = 0; v < vertices; ++v)
        walls.skin.vertices.col(at * vertices + v) =
            turn * Vec3(slab.vertices.col(v)) - (1.0 - kDepth[i] + 0.15) * normal[i];
      walls.skin.faces.middleCols(at * faces, faces) = slab.faces.array() + static_cast<int>(at * vertices);
    }
    ProxyHull all;
    all.members.resize(static_cast<std::size_t>(walls.skin.vertices.cols()));
    std::iota(all.members.begin(), all.members.end(), 0);
    bound(all, walls.skin.vertices);
    walls.proxies = {all};
  }
};

}  // namespace

TEST(WantedErrorOfParts, IsSharedByVolume) {
  const BallBetweenWalls world;
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
      EXPECT_NEAR(source->stages()->quadrature_error / kWanted, 1.0, 0.15);
    }
  EXPECT_LT(std::sqrt(squares / (kGrids * kGrids)), 1.25 * kWanted);
  EXPECT_NEAR(pressed / (kGrids * kGrids) / (kPi * std::pow(0.102 / kWanted, 0.8) * shares), 1.0, 0.15);
}
