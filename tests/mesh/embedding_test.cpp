#include "palpate/mesh/embedding.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "helpers.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"
#include "palpate/mesh/quality.h"

using namespace palpate;

namespace {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vec3 vector(double reach) { return {in(-reach, reach), in(-reach, reach), in(-reach, reach)}; }
  Points points(int count, double reach) {
    Points p(3, count);
    for (int i = 0; i < count; ++i) p.col(i) = vector(reach);
    return p;
  }
  std::mt19937& engine() { return engine_; }

 private:
  std::mt19937 engine_;
};

/// Distance to the hull of four points by trying all 15 of its faces, edges, corners and the tetrahedron
/// itself: the nearest point of the affine space of one of them that lies inside it. Independent of the
/// tested method.
double brute_distance(const TetMesh& mesh, int tet, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (int mask = 1; mask < 16; ++mask) {
    std::vector<Vec3> x;
    for (int k = 0; k < 4; ++k)
      if (mask & (1 << k)) x.push_back(mesh.nodes.col(mesh.tets(k, tet)));
    MatX E(3, static_cast<Eigen::Index>(x.size()) - 1);
    for (std::size_t k = 1; k < x.size(); ++k) E.col(static_cast<Eigen::Index>(k) - 1) = x[k] - x[0];
    const VecX l = E.cols() > 0 ? VecX((E.transpose() * E).inverse() * E.transpose() * (p - x[0])) : VecX();
    if (l.size() > 0 && (l.minCoeff() < 0 || l.sum() > 1)) continue;
    least = std::min(least, (p - x[0] - (l.size() > 0 ? Vec3(E * l) : Vec3(Vec3::Zero()))).norm());
  }
  return least;
}

/// Sum |w| of a point's barycentric coordinates.
double weight_sum(const TetMesh& mesh, int tet, const Vec3& p) {
  Eigen::Matrix4d corners;
  corners.row(3).setOnes();
  for (int k = 0; k < 4; ++k) corners.col(k).head<3>() = mesh.nodes.col(mesh.tets(k, tet));
  return Eigen::Vector4d(corners.partialPivLu().solve(Eigen::Vector4d(p.x(), p.y(), p.z(), 1.0)))
      .cwiseAbs()
      .sum();
}

}  // namespace

TEST(Embedding, NearestTetrahedraAreThoseOfBruteForce) {
  const TetMesh meshes[] = {mesh::perturbed(mesh::ball(0.8, 0.3), 0.2, 5),
                            mesh::perturbed(mesh::box(Vec3(1, 1.5, 0.7), {4, 5, 3}), 0.2, 6)};
  Random random(7);
  int held = 0, outside = 0, farther = 0;
  for (const TetMesh& mesh : meshes) {
    const Points points = random.points(300, 0.85);
    mesh::EmbeddingReport report;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {  // points permitted by the limit on sum |w|
      try {
        const auto one = mesh::embed(mesh, points.col(i), &report);
        double least = std::numeric_limits<double>::infinity();
        for (int t = 0; t < mesh.tets.cols(); ++t)
          least = std::min(least, brute_distance(mesh, t, points.col(i)));
        const double taken = brute_distance(mesh, one.tet[0], points.col(i));
        if (taken > least + 3e-9) {  // a better tetrahedron that is nearly as near
          ++farther;
          EXPECT_LE(taken, 1.25 * least + 3e-9) << i;
          double of_nearest = std::numeric_limits<double>::infinity();
          for (int t = 0; t < mesh.tets.cols(); ++t)
            if (brute_distance(mesh, t, points.col(i)) < least + 3e-9)
              of_nearest = std::min(of_nearest, weight_sum(mesh, t, points.col(i)));
          EXPECT_GT(of_nearest, 3.0) << i;
          EXPECT_LT(one.weights.col(0).cwiseAbs().sum(), 0.9 * of_nearest) << i;
        }
        if (least > 1e-8) { EXPECT_NEAR(report.largest_distance, least, 1e-9); }
        EXPECT_EQ(report.outside, least > 1e-8 ? 1 : 0);
        ++(report.outside ? outside : held);
      } catch (const Error& e) { expect_contains(e.what(), "skin vertex 0 at"); }
    }
  }
  EXPECT_GT(held, 150);
  EXPECT_GT(outside, 100);
  EXPECT_GT(farther, 0);
}

TEST(Embedding, WeightsSumToOneAndGiveThePointBack) {
  const TetMesh mesh = mesh::ball(1.0, 0.25);
  const TriMesh skin = mesh::sphere(1.02, 40);
  mesh::EmbeddingReport report;
  const auto embedding = mesh::embed(mesh, skin.vertices, &report);
  EXPECT_LT((embedding.weights.colwise().sum().array() - 1.0).abs().maxCoeff(), 1e-13);
  Points back;
  mesh::evaluate(embedding, mesh.tets, mesh.nodes, back);
  EXPECT_LT((back - skin.vertices).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_EQ(report.outside, skin.vertices.cols());
  // boundary nodes lie on the unit sphere, 0.02 below the skin; the centre of a face whose corners lie on a
  // circle of radius c <= h / sqrt(3) of the sphere (nearly equilateral) lies 1 - sqrt(1 - c^2) deeper
  EXPECT_GE(report.largest_distance, 0.02);
  EXPECT_LT(report.largest_distance, 1.02 - std::sqrt(1 - std::pow(mesh::measure(mesh).largest_edge, 2) / 3));
  EXPECT_GT(report.largest_weight_sum, 1.0);
  EXPECT_LT(report.largest_weight_sum, 2.0);
  EXPECT_NEAR(report.largest_weight_sum, embedding.weights.cwiseAbs().colwise().sum().maxCoeff(), 1e-12);
}

TEST(Embedding, AffineMapsAreExact) {
  const TetMesh mesh = mesh::perturbed(mesh::ball(1.0, 0.3), 0.2, 8);
  const TriMesh skin = mesh::sphere(1.05, 30);
  const auto embedding = mesh::embed(mesh, skin.vertices);
  Random random(9);
  for (int i = 0; i < 5; ++i) {
    Mat3 A;
    for (int k = 0; k < 3; ++k) A.col(k) = random.vector(2.0);  // shears, stretches, reflects
    const Vec3 b = random.vector(3.0);
    Points points;
    mesh::evaluate(embedding, mesh.tets, (A * mesh.nodes).colwise() + b, points);
    EXPECT_LT((points - ((A * skin.vertices).colwise() + b)).cwiseAbs().maxCoeff(), 1e-12);
  }
}

// The transposed map preserves virtual work, force and moment, in any deformed state.
TEST(Embedding, ForcesKeepWorkResultantAndMoment) {
  const TetMesh mesh = mesh::ball(1.0, 0.3);
  const TriMesh skin = mesh::sphere(1.05, 20);
  const auto embedding = mesh::embed(mesh, skin.vertices);
  Random random(10);
  const Points nodes = mesh.nodes + random.points(static_cast<int>(mesh.nodes.cols()), 0.3),
               moved = random.points(static_cast<int>(mesh.nodes.cols()), 1.0);
  const Points f = random.points(static_cast<int>(skin.vertices.cols()), 1.0);
  Points points, step, node_f = Points::Zero(3, mesh.nodes.cols());
  mesh::evaluate(embedding, mesh.tets, nodes, points);
  mesh::evaluate(embedding, mesh.tets, moved, step);
  mesh::add_to_nodes(embedding, mesh.tets, f, node_f);
  EXPECT_NEAR(f.cwiseProduct(step).sum(), node_f.cwiseProduct(moved).sum(), 1e-10);
  EXPECT_LT((f.rowwise().sum() - node_f.rowwise().sum()).norm(), 1e-11);
  Vec3 moment = Vec3::Zero();
  for (Eigen::Index i = 0; i < points.cols(); ++i) moment += points.col(i).cross(f.col(i));
  for (Eigen::Index n = 0; n < nodes.cols(); ++n) moment -= nodes.col(n).cross(node_f.col(n));
  EXPECT_LT(moment.norm(), 1e-11);
}

// A point on a common face, edge or node belongs to several tetrahedra; the first is chosen, independently of
// the preceding points.
TEST(Embedding, TiesGoToTheFirstInAnyOrder) {
  const TetMesh mesh = mesh::box(Vec3(1, 1, 1), {3, 3, 3});
  std::vector<Vec3> shared;
  for (int t = 0; t < mesh.tets.cols(); t += 7)
    for (const auto& face : mesh::kTetFaces) {
      const Vec3 a = mesh.nodes.col(mesh.tets(face[0], t)), b = mesh.nodes.col(mesh.tets(face[1], t)),
                 c = mesh.nodes.col(mesh.tets(face[2], t));
      shared.insert(shared.end(), {a, 0.5 * (a + b), (a + b + c) / 3.0, 0.3 * a + 0.3 * b + 0.4 * c});
    }
  Points points(3, static_cast<Eigen::Index>(shared.size()));
  for (std::size_t i = 0; i < shared.size(); ++i) points.col(static_cast<Eigen::Index>(i)) = shared[i];
  const auto embedding = mesh::embed(mesh, points);
  int tied = 0;
  for (int i = 0; i < embedding.size(); ++i) {
    std::vector<int> holding;
    for (int t = 0; t < mesh.tets.cols(); ++t)
      if (brute_distance(mesh, t, points.col(i)) < 1e-10) holding.push_back(t);
    ASSERT_FALSE(holding.empty());
    EXPECT_EQ(embedding.tet[static_cast<std::size_t>(i)], holding.front());
    tied += holding.size() > 1;
  }
  EXPECT_GT(tied, 50);

  std::vector<int> order(shared.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), Random(11).engine());
  const auto shuffled = mesh::embed(mesh, Points(points(Eigen::all, order)));
  for (std::size_t i = 0; i < order.size(); ++i)
    EXPECT_EQ(shuffled.tet[i], embedding.tet[static_cast<std::size_t>(order[i])]);
}

TEST(Embedding, AbsurdWeightsAreRefusedByName) {
  const TetMesh mesh = mesh::corner_tet(Vec3(1, 1, 1));
  Points points(3, 2);
  points << 0.2, 3.0, 0.2, 3.0, 0.2, 3.0;  // sum |w| of the second point: 9 + 8 = 17
  const std::string said = error_of([&] { mesh::embed(mesh, points); });
  expect_contains(said, "skin vertex 1 at (3, 3, 3) m");
  expect_contains(said, "sum to 17");
  points.col(1) = Vec3(0.6, 0.6, 0.6);
  mesh::EmbeddingReport report;
  mesh::embed(mesh, points, &report);
  EXPECT_EQ(report.farthest, 1);
  EXPECT_EQ(report.most_extrapolated, 1);
  EXPECT_NEAR(report.largest_weight_sum, 2.6, 1e-12);                 // weights -0.8, 0.6, 0.6, 0.6
  EXPECT_NEAR(report.largest_distance, 0.8 / std::sqrt(3.0), 1e-12);  // plane x + y + z = 1
  points(0, 0) = std::numeric_limits<double>::quiet_NaN();
  expect_contains(error_of([&] { mesh::embed(mesh, points); }), "skin vertex 0 at (nan");
  expect_contains(error_of([&] { mesh::embed(TetMesh{}, points); }), "no tetrahedra");
}

// Area vectors of a closed surface cancel. Areas at a box's corner: of its three faces of two triangles each,
// one or two triangles touch it.
TEST(Embedding, NormalsAndAreas) {
  const TriMesh sphere = mesh::sphere(2.0, 30);
  Points normals, vectors;
  VecX areas;
  mesh::vertex_normals_and_areas(sphere.faces, sphere.vertices, normals, areas);
  mesh::vertex_area_vectors(sphere.faces, sphere.vertices, vectors);
  EXPECT_LT(vectors.rowwise().sum().norm(), 1e-12);
  double area = 0.0;
  for (Eigen::Index f = 0; f < sphere.faces.cols(); ++f) {
    const Vec3 a = sphere.vertices.col(sphere.faces(0, f)), b = sphere.vertices.col(sphere.faces(1, f)),
               c = sphere.vertices.col(sphere.faces(2, f));
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  EXPECT_NEAR(areas.sum(), area, 1e-10);
  EXPECT_NEAR(area, 16 * M_PI, 0.01 * 16 * M_PI);
  for (Eigen::Index v = 0; v < sphere.vertices.cols(); ++v) {
    EXPECT_GT(normals.col(v).dot(sphere.vertices.col(v)) / 2.0, 0.999);
    EXPECT_NEAR(normals.col(v).norm(), 1.0, 1e-12);
    EXPECT_LT((vectors.col(v).normalized() - normals.col(v)).norm(), 1e-12);
    EXPECT_LE(vectors.col(v).norm(), areas[v] * (1 + 1e-12));
  }
  // divergence theorem: sum of x . a over the vertices is three times the enclosed volume, up to the
  // extent of the faces
  EXPECT_NEAR(sphere.vertices.cwiseProduct(vectors).sum() / 3.0, mesh::enclosed_volume(sphere), 1e-10);

  TriMesh folded;  // two faces back to back: their normals cancel, their areas do not
  folded.vertices.resize(3, 3);
  folded.vertices << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  folded.faces.resize(3, 2);
  folded.faces << 0, 0, 1, 2, 2, 1;
  mesh::vertex_normals_and_areas(folded.faces, folded.vertices, normals, areas);
  EXPECT_TRUE(normals.isZero());
  EXPECT_NEAR(areas.sum(), 1.0, 1e-15);
}
