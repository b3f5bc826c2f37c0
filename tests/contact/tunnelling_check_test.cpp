// Detection of vertices that tunnel through a closed surface between two times, against theory for the same
// motions.
#include "contact/tunnelling_check.h"

#include "surfaces.h"

using namespace contact_tests;

namespace {

contact::SurfaceMotion still(const TriMesh& mesh) { return {mesh.faces, mesh.vertices, mesh.vertices}; }

/// Motion of vertices without faces, from one position to another.
contact::SurfaceMotion points(const Points& before, const Points& now) { return {Faces(3, 0), before, now}; }

long passed(const Vec3& from, const Vec3& to, const contact::SurfaceMotion& through) {
  return contact::TunnellingCheck().count(points(from, to), through, 0.0);
}

}  // namespace

TEST(TunnellingCheck, WhatGoesThroughIsCountedAndNothingElse) {
  const auto box = still(mesh::box_surface(Vec3(2, 2, 0.1), {8, 8, 1}));
  EXPECT_EQ(passed({0.1, 0.2, 1}, {0.3, 0.1, -1}, box), 1);
  EXPECT_EQ(passed({0.3, 0.1, -1}, {0.1, 0.2, 1}, box), 1) << "back again";
  EXPECT_EQ(passed({0.25, 0.25, 1}, {0.25, 0.25, -1}, box), 1) << "through corners of triangles";
  EXPECT_EQ(passed({0.1, 0.1, 1}, {0.1, 0.1, -1}, box), 1) << "through edges";
  EXPECT_EQ(passed({0.1, 0.2, 1}, {0.1, 0.2, 0.01}, box), 0) << "it is inside";
  EXPECT_EQ(passed({0.1, 0.2, 0.01}, {0.1, 0.2, -1}, box), 0) << "it was seen inside";
  EXPECT_EQ(passed({0.1, 0.2, 1}, {3, 0, -1}, box), 0) << "it passes by";
  EXPECT_EQ(passed({0.1, 0.2, 1}, {0.1, 0.2, 0.06}, box), 0);
  EXPECT_EQ(passed({0.1, 0.2, 1}, {0.1, 0.2, 1}, box), 0) << "it stands still";
  EXPECT_EQ(passed({-3, 0.03, 0.01}, {3, 0.02, 0.02}, box), 1) << "lengthwise";
}

// Through one of two plates and into the other: at the end it is inside, where a query detects it.
TEST(TunnellingCheck, WhatIsInsideAtEitherEndIsSeen) {
  TriMesh two = mesh::box_surface(Vec3(2, 2, 0.1), {4, 4, 1});
  const Eigen::Index vertices = two.vertices.cols(), faces = two.faces.cols();
  two.vertices.conservativeResize(3, 2 * vertices);
  two.vertices.rightCols(vertices) = two.vertices.leftCols(vertices).colwise() - Vec3(0, 0, 0.5);
  two.faces.conservativeResize(3, 2 * faces);
  two.faces.rightCols(faces) = two.faces.leftCols(faces).array() + static_cast<int>(vertices);
  EXPECT_EQ(passed({0.1, 0.2, 0.3}, {0.1, 0.2, -0.51}, still(two)), 0) << "it ends in the lower one";
  EXPECT_EQ(passed({0.1, 0.2, 0.01}, {0.1, 0.2, -0.8}, still(two)), 0) << "it begins in the upper one";
  EXPECT_EQ(passed({0.1, 0.2, 0.3}, {0.1, 0.2, -0.8}, still(two)), 1) << "once, through both";
}

// Half of the faces are at rest; the other half rise and overtake a vertex that moves at their mean velocity.
TEST(TunnellingCheck, FacesMayMoveDifferently) {
  const TriMesh box = mesh::box_surface(Vec3(2, 2, 0.1), {4, 4, 1});
  const Eigen::Index vertices = box.vertices.cols(), faces = box.faces.cols();
  contact::SurfaceMotion two{Faces(3, 2 * faces), Points(3, 2 * vertices), Points(3, 2 * vertices)};
  two.faces << box.faces, Faces(box.faces.array() + static_cast<int>(vertices));
  two.before << box.vertices, Points(box.vertices.colwise() + Vec3(5, 0, 0));
  two.now << Points(box.vertices.colwise() + Vec3(0, 0, 1)), Points(box.vertices.colwise() + Vec3(5, 0, 0));
  const auto vertex = points(Vec3(0.1, 0.2, 0.2), Vec3(0.1, 0.2, 0.7));
  EXPECT_EQ(contact::TunnellingCheck().count(vertex, two, 0.09), 1);
  EXPECT_EQ(contact::TunnellingCheck().count(vertex, two, 0.11), 0) << "it is 0.1 thick";
}

// A grazed edge: the path length inside is the cut through the corner, in the frame of the box.
TEST(TunnellingCheck, AWayThatIsShortDoesNotCount) {
  const TriMesh mesh = mesh::box_surface(Vec3(2, 2, 0.1), {8, 8, 1});
  const Vec3 out_of_side(1.03, 0.3, 0.02), in_at_top(0.97, 0.3, 0.08);  // the edge lies between them
  const auto graze = [&](double deep, double least) {
    const Vec3 shift = -deep * Vec3(1, 0, 1).normalized();
    return contact::TunnellingCheck().count(points(in_at_top + shift, out_of_side + shift), still(mesh),
                                            least);
  };
  // a cut `deep` below a right-angled edge has length 2 deep
  EXPECT_EQ(graze(0.01, 0.019), 1);
  EXPECT_EQ(graze(0.01, 0.021), 0);
  EXPECT_EQ(graze(-0.001, 0.0), 0) << "it passes by";
  // both drift: the relative path counts
  contact::SurfaceMotion along = still(mesh);
  const Vec3 drift(0, 5, 0), shift = -0.01 * Vec3(1, 0, 1).normalized();
  along.now.colwise() += drift;
  const auto together = points(in_at_top + shift, out_of_side + shift + drift);
  EXPECT_EQ(contact::TunnellingCheck().count(together, along, 0.019), 1);
  EXPECT_EQ(contact::TunnellingCheck().count(together, along, 0.021), 0);
}

// A straight path with both ends outside passes through a ball if its distance from the centre is less than
// the radius: thousands of random paths, except those that depend on the facets.
TEST(TunnellingCheck, AgreesWithASphere) {
  const auto ball = still(mesh::sphere(1.0, 8));
  std::mt19937 random(2);
  int through = 0, past = 0;
  for (int i = 0; i < 800; ++i) {
    const Vec3 from = 2.0 * vector(random), to = 2.0 * vector(random), way = to - from;
    const double t = std::clamp(-from.dot(way) / way.squaredNorm(), 0.0, 1.0),
                 nearest = (from + t * way).norm();
    const bool doubt = std::abs(nearest - 0.985) < 0.016 || std::abs(from.norm() - 0.985) < 0.016 ||
                       std::abs(to.norm() - 0.985) < 0.016;
    if (doubt) continue;
    const bool expected = nearest < 1.0 && from.norm() > 1.0 && to.norm() > 1.0;
    EXPECT_EQ(passed(from, to, ball), expected) << from.transpose() << " to " << to.transpose();
    ++(expected ? through : past);
  }
  EXPECT_GT(through, 80);
  EXPECT_GT(past, 200);
}

// The surface moves, inverts on its way, or shrinks to a point and grows again: only simultaneous positions
// count.
TEST(TunnellingCheck, BothMayMove) {
  const TriMesh box = mesh::box_surface(Vec3(2, 2, 0.1), {8, 8, 1});
  const auto moving = [&](const Vec3& from, const Vec3& to) {
    return contact::SurfaceMotion{box.faces, box.vertices.colwise() + from, box.vertices.colwise() + to};
  };
  const Vec3 x(0.1, 0.2, 0.0);
  EXPECT_EQ(passed(x, x, moving({0, 0, -1}, {0, 0, 1})), 1);
  EXPECT_EQ(passed({0.1, 0.2, -0.5}, {0.1, 0.2, 1.5}, moving({0, 0, -1}, {0, 0, 1})), 0) << "together";
  EXPECT_EQ(passed({0.1, 0.2, -0.5}, {0.1, 0.2, 0.5}, moving({0, 0, -1}, {0, 0, 1})), 1) << "overtaken";
  EXPECT_EQ(passed(x, x, moving({3, 0, -1}, {3, 0, 1})), 0) << "beside it";
  // each point of the box moves straight to its opposite: at half time all are at the centre
  contact::SurfaceMotion turned = still(box);
  turned.now = -turned.before;
  EXPECT_EQ(passed({0.5, 0.3, 1}, {0.5, 0.3, 0.9}, turned), 0);
}

// Brute force: a tetrahedron whose corners move independently, so that it rotates and shears, and a vertex.
// The vertex tunnels if it is outside at both ends and inside, by its barycentric coordinates, at one of many
// times in between; paths that come within a hundredth of that limit are skipped.
TEST(TunnellingCheck, AgreesWithSamplesOfTheWayThroughWhatDeforms) {
  Faces faces(3, 4);
  faces.col(0) = Eigen::Vector3i(1, 2, 3);
  faces.col(1) = Eigen::Vector3i(0, 3, 2);
  faces.col(2) = Eigen::Vector3i(0, 1, 3);
  faces.col(3) = Eigen::Vector3i(0, 2, 1);
  std::mt19937 random(11);
  int through = 0, not_through = 0;
  for (int i = 0; i < 4000; ++i) {
    Points before(3, 4), now(3, 4);
    before << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
    now = before;
    for (int k = 0; k < 4; ++k) now.col(k) += 0.5 * vector(random);
    const Vec3 from = Vec3::Constant(0.25) + vector(random), to = Vec3::Constant(0.25) + vector(random);
    constexpr int kTimes = 400;
    double deepest = -1.0, at_ends = -1.0, least_volume = 1.0;
    for (int j = 0; j <= kTimes; ++j) {
      const double t = static_cast<double>(j) / kTimes;
      const Points p = before + t * (now - before);
      Mat3 edges;
      for (int k = 0; k < 3; ++k) edges.col(k) = p.col(k + 1) - p.col(0);
      least_volume = std::min(least_volume, edges.determinant());
      const Vec3 w = edges.inverse() * (from + t * (to - from) - p.col(0));
      const double inside = std::min(w.minCoeff(), 1.0 - w.sum());
      deepest = std::max(deepest, inside);
      if (j == 0 || j == kTimes) at_ends = std::max(at_ends, inside);
    }
    if (least_volume < 0.1 || std::abs(deepest) < 0.01 || std::abs(at_ends) < 0.01) continue;
    const bool expected = deepest > 0.0 && at_ends < 0.0;
    EXPECT_EQ(passed(from, to, {faces, before, now}), expected) << i;
    ++(expected ? through : not_through);
  }
  EXPECT_GT(through, 50);
  EXPECT_GT(not_through, 500);
}

TEST(TunnellingCheck, OfNoneThereIsNone) {
  const auto box = still(mesh::box_surface(Vec3(2, 2, 0.1), {2, 2, 1}));
  EXPECT_EQ(contact::TunnellingCheck().count(points(Points(3, 0), Points(3, 0)), box, 0.0), 0);
}

// Three thousand points all pass through nine thousand faces at once: unchecked candidates are not counted,
// and are reported as unchecked. The same points on short paths are all counted.
TEST(TunnellingCheck, GivesUpWhereAllWouldBeLookedAtAgainstAll) {
  const auto box = still(mesh::box_surface(Vec3(2, 2, 0.1), {60, 60, 4}));
  const int n = 3000;
  Points before(3, n), near(3, n), far(3, n);
  for (int i = 0; i < n; ++i) {
    const double x = std::sin(1.0 + 3.0 * i), y = std::sin(2.0 + 7.0 * i);
    before.col(i) << 0.9 * x, 0.9 * y, 0.06;
    near.col(i) << 0.9 * x, 0.9 * y, -0.06;
    far.col(i) << 0.9 * x + 50.0, 0.9 * y + 50.0, -50.0;
  }
  contact::TunnellingCheck all;
  EXPECT_EQ(all.count(points(before, near), box, 0.0), n);
  EXPECT_EQ(all.given_up(), 0);
  contact::SurfaceMotion blown_up = box;
  blown_up.now.colwise() += Vec3(50.0, -50.0, 50.0);
  for (Eigen::Index v = 0; v < blown_up.now.cols(); v += 2) blown_up.now.col(v) *= -1.0;
  EXPECT_LT(all.count(points(before, far), blown_up, 0.0), n);
  EXPECT_EQ(all.given_up(), 1);
}
