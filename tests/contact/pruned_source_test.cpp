// Image space with convex proxies: only skin that may be near is rendered, in separate regions.
#include "grid_proxies.h"
#include "images.h"
#include "proxy/pruner.h"
#include "surfaces.h"

using namespace contact_tests;

// One pose, with the skin cut into 1, 8 and 64 cells: the force magnitude equals the uncut surface's to 1 %
// (each surface point contributes once). Its direction is the normal of the plane fitted to the skin passed
// on, and varies by a few degrees with the cut.
TEST(PrunedImageSource, SizeOfTheForceDoesNotDependOnTheCut) {
  SkinWorld skin;
  const TriMesh rigid = sphere(Vec3(0.1, 0.05, skin.vertices.row(2).maxCoeff() + 0.35), 0.5, 30);
  std::vector<contact::ContactSample> samples;
  contact::make_image_source(skin.surface, rigid, 0, contact::fixed_frame(), image_options(256, 0.02))
      ->query(skin.state.view(), samples);
  const Total whole = total(samples, skin.state.view());
  EXPECT_GT(whole.pressed, 25);
  for (const int cells : {1, 2, 4}) {
    samples.clear();
    const auto source = contact::make_image_source(
        skin.surface, proxies_of(skin.ball, skin.skin, skin.surface.embedding, cells), rigid,
        proxies_of(rigid), 0, contact::fixed_frame(), image_options(256, 0.02));
    source->query(skin.state.view(), samples);
    const Total cut = total(samples, skin.state.view());
    EXPECT_NEAR(cut.force.norm() / whole.force.norm(), 1.0, 0.01) << cells;
    EXPECT_LT(cut.force.normalized().cross(whole.force.normalized()).norm(), 0.1) << cells;
    ASSERT_NE(source->report().pruning, nullptr);
    EXPECT_EQ(source->report().pruning->queries, 1);
    EXPECT_LT(source->report().pruning->faces_a, skin.skin.faces.cols() / 2);
  }
}

// Two balls of one body with a rigid ball between them: from no side are they a height field as a whole. Each
// is pushed away by its overlap.
TEST(PrunedImageSource, FindsContactOnBothSides) {
  TetMesh tets = mesh::ball(1.0, 0.45);
  TriMesh skin = mesh::sphere(1.0, 16);
  const auto twice = [](auto& points, auto& cells) {
    const Eigen::Index n = points.cols(), m = cells.cols();
    points.conservativeResize(3, 2 * n);
    points.rightCols(n) = points.leftCols(n);
    points.row(0).head(n).array() -= 1.3;
    points.row(0).tail(n).array() += 1.3;
    cells.conservativeResize(Eigen::NoChange, 2 * m);
    cells.rightCols(m) = cells.leftCols(m).array() + static_cast<int>(n);
  };
  twice(tets.nodes, tets.tets);
  twice(skin.vertices, skin.faces);
  dynamics::State state;
  dynamics::BlockSpec nodes;
  nodes.name = "balls";
  nodes.q_size = nodes.u_size = static_cast<int>(tets.nodes.size());
  contact::NodeSurface surface;
  surface.block_id = state.insert(nodes, Eigen::Map<const VecX>(tets.nodes.data(), tets.nodes.size()),
                                  VecX::Zero(tets.nodes.size()));
  surface.faces = skin.faces;
  surface.embedding = mesh::embed(tets, skin.vertices);
  surface.tets = tets.tets;
  std::vector<contact::ContactSample> samples;
  const TriMesh rigid = mesh::sphere(0.4, 20);
  const auto source =
      contact::make_image_source(surface, proxies_of(tets, skin, surface.embedding, 4), rigid,
                                 proxies_of(rigid), 0, contact::fixed_frame(), image_options(128, 0.02));
  source->query(state.view(), samples);
  Vec3 left = Vec3::Zero(), right = Vec3::Zero();
  for (const auto& s : samples) {
    if (s.gap >= 0.0) continue;
    EXPECT_GT(std::abs(s.normal.x()), 0.9);
    (point_on_nodes(s.a, state.view()).x() < 0.0 ? left : right) -= s.gap * s.area * s.normal;
  }
  // Overlap of spheres of 1 and 0.4 at 1.3: pi (0.1)^2 (d^2 + 2 d (R1 + R2) - 3 (R1 - R2)^2) / (12 d)
  const double d = 1.3, volume = M_PI * 0.01 * (d * d + 2.0 * d * 1.4 - 3.0 * 0.36) / (12.0 * d);
  EXPECT_NEAR(left.x() / -volume, 1.0, 0.05);
  EXPECT_NEAR(right.x() / volume, 1.0, 0.05);
  EXPECT_LT((left + right).norm(), 0.01 * volume)
      << left.transpose() << " and " << right.transpose() << " of " << volume;
  EXPECT_GE(source->report().pruning->regions, 2);
}

TEST(PrunedImageSource, RefusesWhatDoesNotBelongTogether) {
  SkinWorld skin;
  SurfaceWorld nodes({skin.vertices, skin.skin.faces});
  const auto proxies = proxies_of(skin.ball, skin.skin, skin.surface.embedding, 1);
  const TriMesh rigid = sphere(Vec3::Zero(), 0.5, 8);
  const auto of_rigid = proxies_of(rigid);
  EXPECT_THROW(contact::make_image_source(nodes.surface, proxies, rigid, of_rigid, 0, contact::fixed_frame(),
                                          image_options(64, 0.02)),
               InternalError)
      << "nodes have no embedding to follow";
  EXPECT_THROW(contact::make_image_source(skin.surface, proxies, rigid, nullptr, 0, contact::fixed_frame(),
                                          image_options(64, 0.02)),
               InternalError);
  EXPECT_THROW(contact::make_image_source(skin.surface, proxies, sphere(Vec3::Zero(), 0.5, 9), of_rigid, 0,
                                          contact::fixed_frame(), image_options(64, 0.02)),
               InternalError);
  contact::NodeSurface fewer = skin.surface;
  fewer.faces.conservativeResize(3, fewer.faces.cols() - 1);
  EXPECT_THROW(contact::make_image_source(fewer, proxies, rigid, of_rigid, 0, contact::fixed_frame(),
                                          image_options(64, 0.02)),
               InternalError);
}

// A second query uses the body's position at that time.
TEST(PrunedImageSource, FollowsTheBody) {
  SkinWorld skin;
  const TriMesh rigid = sphere(Vec3(0.1, 0.0, -1.6), 0.8, 20);
  const auto source_of = [&] {
    return contact::make_image_source(skin.surface,
                                      proxies_of(skin.ball, skin.skin, skin.surface.embedding, 2), rigid,
                                      proxies_of(rigid), 0, contact::fixed_frame(), image_options(96, 0.02));
  };
  const auto kept = source_of();
  std::vector<contact::ContactSample> before, after, expected;
  kept->query(skin.state.view(), before);
  auto q = skin.state.q();
  for (Eigen::Index i = 0; i + 2 < q.size(); i += 3) {  // stretched and shifted
    q[i] = 1.1 * q[i] + 0.02;
    q[i + 2] *= 0.97;
  }
  kept->query(skin.state.view(), after);
  source_of()->query(skin.state.view(), expected);
  ASSERT_GT(expected.size(), 25u);
  ASSERT_EQ(after.size(), expected.size());
  for (std::size_t i = 0; i < after.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(after[i].a.weight[k], expected[i].a.weight[k], 1e-12);
}
