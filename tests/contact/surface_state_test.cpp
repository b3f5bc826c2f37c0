#include "contact/surface_state.h"
#include "contact/image_side.h"

#include "core/counters.h"
#include "surfaces.h"

using namespace contact_tests;

// A skin vertex is the same whether evaluated alone or with all others, and follows the nodes at each update.
TEST(SurfaceState, OneVertexIsAsAllAre) {
  SkinWorld world;
  contact::SurfaceState one(world.surface), all(world.surface);
  for (const double moved : {0.0, 0.25}) {
    world.state.q().tail(world.state.q().size() - 6).array() += moved;
    one.update(world.state.view());
    all.update(world.state.view());
    const Points& x = all.positions();
    double change = 0.0;
    for (int v = one.vertex_count() - 1; v >= 0; v -= 3) {
      EXPECT_EQ(one.position(v), Vec3(x.col(v)));
      change += (one.position(v) - world.vertices.col(v)).norm();
    }
    if (moved > 0.0) { EXPECT_GT(change, 0.1 * one.vertex_count()); }
    EXPECT_EQ(one.positions(), x) << "those that were asked for and the others";
  }
}

// --- Squashed tetrahedra

namespace {

/// A skin on a ball in which one tetrahedron that carries many vertices is squashed to `share` of its height:
/// the node opposite its outermost face is moved almost into that face.
struct SquashedWorld : SkinWorld {
  int squashed = -1;

  explicit SquashedWorld(double share) {
    std::vector<int> carried(static_cast<std::size_t>(ball.tets.cols()), 0);
    for (const int tet : surface.embedding.tet) ++carried[static_cast<std::size_t>(tet)];
    squashed = static_cast<int>(std::max_element(carried.begin(), carried.end()) - carried.begin());
    const auto at = [&](int k) { return state.q().segment<3>(6 + 3 * ball.tets(k, squashed)); };
    int inner = 0;
    for (int k = 1; k < 4; ++k)
      if (at(k).norm() < at(inner).norm()) inner = k;
    Vec3 corner[3];
    for (int k = 0, i = 0; k < 4; ++k)
      if (k != inner) corner[i++] = at(k);
    const Vec3 n = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
    at(inner) -= (1.0 - share) * n.dot(at(inner) - corner[0]) * n;
  }
};

}  // namespace

// However flat a tetrahedron is, its nodes carry a skin point by weights no larger than those of an
// embedding, and the point lies on the line of the force: the moment of a force along it is preserved.
TEST(SurfaceState, ASquashedTetrahedronAmplifiesNoForce) {
  std::mt19937 random(5);
  int beside = 0;
  for (const double share : {1.0, 1e-2, 1e-4, 1e-8, 0.0}) {
    SquashedWorld world(share);
    contact::SurfaceState surface(world.surface);
    const auto view = world.state.view();
    surface.update(view);
    const auto side = contact::soft_side(world.surface);
    side->update(view);
    const long before = counters::counter("contact.squashed_tetrahedron").load();
    double largest = 0.0, largest_exact = 0.0, largest_offset = 0.0;
    for (int f = 0; f < surface.face_count(); ++f)
      for (int i = 0; i < 4; ++i) {
        Vec3 weights = vector(random).cwiseAbs();
        weights /= weights.sum();
        const auto corner = surface.faces().col(f);
        Vec3 x = Vec3::Zero();
        for (int k = 0; k < 3; ++k) x += weights[k] * surface.position(corner[k]);
        const Vec3 area = (surface.position(corner[1]) - surface.position(corner[0]))
                              .cross(surface.position(corner[2]) - surface.position(corner[0]));
        const Vec3 n = (area.normalized() + 0.3 * vector(random)).normalized();
        const contact::SurfacePoint point = side->carried(f, weights, x, n).point;
        ASSERT_EQ(point.count, 4);
        double sum = 0.0, size = 0.0;
        Vec3 carried = Vec3::Zero();
        for (std::size_t k = 0; k < 4; ++k) {
          sum += point.weight[k];
          size += std::abs(point.weight[k]);
          carried += point.weight[k] * view.position(point.node[k]);
        }
        EXPECT_NEAR(sum, 1.0, 1e-12);
        EXPECT_LT((point_on_nodes(point, view) - x).norm(), 1e-12);
        EXPECT_LT((x - carried).cross(n).norm(), 1e-12) << "a moment of its own, squashed to " << share;
        largest = std::max(largest, size);
        largest_offset = std::max(largest_offset, point.offset.norm());
        // coordinates in the nearest corner's tetrahedron
        Eigen::Index nearest = 0;
        weights.maxCoeff(&nearest);
        const int tet = world.surface.embedding.tet[static_cast<std::size_t>(corner[nearest])];
        Mat3 edges;
        const auto node = [&](int k) { return Vec3(view.position(2 + world.ball.tets(k, tet))); };
        for (int k = 0; k < 3; ++k) edges.col(k) = node(k + 1) - node(0);
        const Vec3 w = edges.fullPivLu().solve(x - node(0));
        largest_exact = std::max(largest_exact, w.cwiseAbs().sum() + std::abs(1.0 - w.sum()));
      }
    const long fallbacks = counters::counter("contact.squashed_tetrahedron").load() - before;
    EXPECT_LE(largest, (1.0 + 1e-9) * mesh::kLargestWeightSum);
    if (share == 1.0) {
      EXPECT_EQ(fallbacks, 0);
      EXPECT_LT(largest_offset, 1e-13);
      continue;
    }
    EXPECT_GT(fallbacks, 0) << share;
    EXPECT_LT(largest_offset, 0.5) << "of a ball of radius 1, squashed to " << share;
    if (share > 0.0) {
      EXPECT_GT(largest_exact * share, 0.05) << "they grow as the inverse height";
      ++beside;
    }
  }
  EXPECT_EQ(beside, 3);
}

// Forces and moments balance on a squashed tetrahedron, and no node takes a large multiple of the total
// force.
TEST(SurfaceState, ContactOnASquashedTetrahedronBalances) {
  for (const double share : {1e-2, 1e-4}) {
    SquashedWorld world(share);
    Vec3 middle = Vec3::Zero();
    int count = 0;
    Points vertices;
    contact::SurfaceState surface(world.surface);
    surface.update(world.state.view());
    for (int v = 0; v < surface.vertex_count(); ++v)
      if (world.surface.embedding.tet[static_cast<std::size_t>(v)] == world.squashed)
        middle += surface.position(v), ++count;
    middle /= count;
    const Vec3 out = middle.normalized();
    const Vec3 centre = middle + 0.4 * out;
    contact::ContactForce term;
    const auto frame = contact::fixed_frame();
    term.add_frame(frame);
    contact::ImageOptions options;
    options.pixels = 96;
    options.candidate_gap = 0.02;
    ContactSpec law;
    law.stiffness_pa_m = 1e5;
    term.add_pair(contact::make_image_source(world.surface, sphere(centre, 0.5, 24), 0, frame, options), law);
    term.refresh(world.state.view());
    const VecX f = force(term, world.state);
    const Wrench w = term.frame_wrench(world.state.view(), 0);
    Vec3 sum = w.force, moment = w.moment;
    double size = 0.0, largest = 0.0;
    for (int i = 0; i < world.state.layout().node_count(); ++i) {
      const Vec3 fi = f.segment<3>(3 * i);
      sum += fi;
      moment += world.state.view().position(i).cross(fi);
      size += fi.norm();
      largest = std::max(largest, fi.norm());
    }
    EXPECT_GT(w.force.norm(), 10.0);
    EXPECT_LT(sum.norm(), 1e-12 * size) << share;
    EXPECT_LT(moment.norm(), 1e-12 * size * 2.0) << share;
    EXPECT_LT(largest, 3.0 * w.force.norm()) << share;
  }
}
