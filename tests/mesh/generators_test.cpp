#include "palpate/mesh/generators.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "helpers.h"
#include "mesh/surface_checks.h"
#include "palpate/mesh/boundary.h"
#include "palpate/mesh/quality.h"

using namespace palpate;
using namespace palpate::mesh;

namespace {

constexpr double kPi = std::numbers::pi;

/// A spec of each generator with several elements across.
MeshSpec some_spec(const std::string& name, double grading) {
  MeshSpec spec = generator_spec(name);
  spec.size_m = {1.0, 0.5, 0.75};
  spec.radius_m = 0.6;
  spec.length_m = 1.3;
  spec.element_size_m = 0.11;
  spec.grading = grading;
  return spec;
}

/// Least-squares slope of log(error) over log(h).
double fitted_order(const std::vector<double>& h, const std::vector<double>& error) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const auto n = static_cast<double>(h.size());
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double x = std::log(h[i]), y = std::log(error[i]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

double mean_edge(const TetMesh& mesh, double r_min, double r_max) {
  double sum = 0;
  int edges = 0;
  for (int t = 0; t < static_cast<int>(mesh.tets.cols()); ++t)
    for (const auto& [i, j] : kTetEdges) {
      const Vec3 a = mesh.nodes.col(mesh.tets(i, t)), b = mesh.nodes.col(mesh.tets(j, t));
      if (std::min(a.norm(), b.norm()) < r_min || std::max(a.norm(), b.norm()) > r_max) continue;
      sum += (a - b).norm();
      ++edges;
    }
  return sum / edges;
}

}  // namespace

// Conformance suite: a generator is tested by being listed.
TEST(Generators, EveryTetGeneratorIsValidClosedAndDeterministic) {
  int checked = 0;
  for (const auto& generator : tet_generators())
    for (const double grading : {1.0, 2.0, 0.7}) {
      SCOPED_TRACE(generator.name);
      const MeshSpec spec = some_spec(generator.name, grading);
      MeshReport report;
      const TetMesh mesh = tet_mesh(spec, "", &report);
      EXPECT_EQ(report.flipped, 0) << "a generator orients its own elements";
      TriMesh surface = boundary(mesh).surface;
      EXPECT_EQ(check_surface(surface, surface_provenance("boundary")).flipped, 0);
      EXPECT_NEAR(enclosed_volume(surface), report.volume, 1e-12 * report.volume);
      const TetMesh again = generator.make(spec);
      EXPECT_EQ(again.nodes, mesh.nodes);
      EXPECT_EQ(again.tets, mesh.tets);
      ++checked;
    }
  EXPECT_EQ(checked, 12);
}

TEST(Generators, EverySurfaceIsTheBoundaryOfTheTetrahedraOfItsName) {
  int checked = 0;
  for (const auto& generator : surface_generators())
    for (const double grading : {1.0, 2.0}) {
      SCOPED_TRACE(generator.name);
      const MeshSpec spec = some_spec(generator.name, grading);
      MeshReport report;
      const TriMesh mesh = surface(spec, "", &report);
      EXPECT_EQ(report.flipped, 0);
      const Boundary skin = boundary(tet_mesh(spec, ""));
      ASSERT_EQ(mesh.vertices, skin.surface.vertices);
      const auto triples = [](const Faces& faces) {
        std::vector<std::array<int, 3>> out;
        for (Eigen::Index f = 0; f < faces.cols(); ++f) {
          std::array<int, 3> n = {faces(0, f), faces(1, f), faces(2, f)};
          // preserves the orientation
          std::rotate(n.begin(), std::min_element(n.begin(), n.end()), n.end());
          out.push_back(n);
        }
        std::sort(out.begin(), out.end());
        return out;
      };
      EXPECT_EQ(triples(mesh.faces), triples(skin.surface.faces));
      ++checked;
    }
  EXPECT_EQ(checked, 6);
}

TEST(Generators, BarOfTheBenchmarksHasItsCounts) {
  const TetMesh bar = box({1.0, 0.25, 0.25}, {36, 9, 9});
  EXPECT_EQ(bar.nodes.cols(), 3700);
  EXPECT_EQ(bar.tets.cols(), 14580);
  MeshSpec spec = generator_spec("box");
  spec.size_m = {1.0, 0.25, 0.25};
  spec.element_size_m = 1.0 / 36;
  EXPECT_EQ(tet_mesh(spec, "").tets, bar.tets);
}

TEST(Generators, BoxHasItsVolumeCornersAndAngles) {
  for (const double grading : {1.0, 3.0}) {
    const MeshReport r = measure(box({1.0, 0.5, 0.25}, {8, 4, 3}, grading));
    EXPECT_NEAR(r.volume, 0.125, 1e-15);
  }
  const TetMesh cube = box({2, 2, 2}, {3, 3, 3});
  EXPECT_EQ(cube.nodes.rowwise().minCoeff(), Vec3(-1, -1, -1));
  EXPECT_EQ(cube.nodes.rowwise().maxCoeff(), Vec3(1, 1, 1));
  // between a face along the cell's edges and the slanted face
  EXPECT_NEAR(measure(cube).smallest_dihedral_deg, std::acos(1 / std::sqrt(3.0)) * 180 / kPi, 1e-10);
}

TEST(Generators, GradedCellsGrowTowardsTheMiddleByTheGrading) {
  const TetMesh graded = box({1, 1, 1}, {40, 1, 1}, 4.0);
  const double end = graded.nodes(0, 1) - graded.nodes(0, 0),
               middle = graded.nodes(0, 20) - graded.nodes(0, 19);
  // A cell is the mean of 1 + 3 (1 - s^2) over its width of 0.05: 4 - 0.0025 in the middle, 1 + 3 (0.05 -
  // 0.05^2 / 3) at the end.
  EXPECT_NEAR(middle / end, (4 - 0.0025) / (1 + 3 * (0.05 - 0.0025 / 3)), 1e-12);
}

TEST(Generators, BallBoundaryLiesOnTheSphereAndVolumeConvergesWithOrderTwo) {
  const double radius = 0.3;
  for (const double grading : {1.0, 3.0}) {
    std::vector<double> h, error;
    for (const int n : {4, 6, 8, 12, 16, 24}) {
      const TetMesh mesh = ball(radius, 1.05 * radius / n, grading);
      const TriMesh skin = boundary(mesh).surface;
      EXPECT_EQ(skin.faces.cols(), 20 * n * n);
      EXPECT_LE((skin.vertices.colwise().norm().array() - radius).abs().maxCoeff(), 2e-16 * radius * 4);
      h.push_back(1.0 / n);
      error.push_back(4.0 / 3.0 * kPi * std::pow(radius, 3) - measure(mesh).volume);
    }
    EXPECT_NEAR(fitted_order(h, error), 2.0, 0.1);
  }
}

TEST(Generators, UniformBallHasCountsOfItsLattice) {
  for (const int n : {1, 2, 5, 9}) {
    const MeshReport r = measure(ball(1.0, 1.05 / n));
    EXPECT_EQ(r.elements, 20 * n * n * n);
    EXPECT_EQ(r.nodes, 1 + 2 * n + 5 * n * (n + 1) * (2 * n + 1) / 3);  // centre, and 10 m^2 + 2 on shell m
  }
}

TEST(Generators, BallsAreWellShapedAtEveryGradingAndSize) {
  int checked = 0;
  for (const double grading : {0.5, 1.0, 1.42, 2.0, 2.8, 4.0, 8.0, 32.0})
    for (const double h : {1.0, 0.5, 0.34, 0.25, 0.17, 0.12, 0.08}) {
      const MeshReport r = measure(ball(1.0, h, grading));
      EXPECT_GE(r.smallest_dihedral_deg, grading == 1.0 ? 36.0 : 20.0)
          << "h = " << h << ", grading = " << grading;
      ++checked;
    }
  EXPECT_EQ(checked, 56);
}

TEST(Generators, GradedBallIsCoarserInTheMiddleAndHasFewerElements) {
  for (const double grading : {1.0, 2.0, 4.0}) {
    const TetMesh mesh = ball(1.0, 0.05, grading);
    const double surface = mean_edge(mesh, 0.9, 1.1), middle = mean_edge(mesh, 0.0, 0.4);
    EXPECT_NEAR(middle / surface / grading, 1.0, 0.25) << grading;
  }
  EXPECT_LT(2 * ball(1.0, 0.05, 4.0).tets.cols(), ball(1.0, 0.05, 1.0).tets.cols());
}

TEST(Generators, CylinderVolumeConvergesWithOrderTwo) {
  std::vector<double> h, error;
  for (const int n : {3, 5, 8, 12}) {
    const TetMesh mesh = cylinder(0.5, 2.0, 1.05 * 0.5 / n);
    h.push_back(1.0 / n);
    error.push_back(kPi * 0.25 * 2.0 - measure(mesh).volume);
    EXPECT_GE(measure(mesh).smallest_dihedral_deg, 30.0);
    EXPECT_NEAR(mesh.nodes.topRows(2).colwise().norm().maxCoeff(), 0.5, 1e-15);
    EXPECT_EQ(mesh.nodes.row(2).minCoeff(), -1.0);
    EXPECT_EQ(mesh.nodes.row(2).maxCoeff(), 1.0);
  }
  EXPECT_NEAR(fitted_order(h, error), 2.0, 0.1);
  // with the same rim
  EXPECT_NEAR(measure(cylinder(0.5, 2.0, 0.1, 2.0)).volume, measure(cylinder(0.5, 2.0, 0.1)).volume, 1e-12);
}

TEST(Generators, SphereIsClosedAndOutwards) {
  for (const int n : {1, 2, 7}) {
    TriMesh mesh = sphere(2.0, n);
    const MeshReport r = check_surface(mesh, surface_provenance("sphere"));
    EXPECT_EQ(r.flipped, 0);
    EXPECT_EQ(r.elements, 20 * n * n);
    EXPECT_EQ(r.nodes, 10 * n * n + 2);
  }
}

TEST(Generators, CornerTetHasAKnownVolume) { EXPECT_DOUBLE_EQ(measure(corner_tet({1, 2, 3})).volume, 1.0); }

TEST(Generators, PerturbedMovesInteriorNodesOnly) {
  const TetMesh mesh = ball(1.0, 0.3), moved = perturbed(mesh, 0.2, 7);
  const Boundary skin = boundary(mesh);
  for (const int node : skin.node_of_vertex) EXPECT_EQ(moved.nodes.col(node), mesh.nodes.col(node));
  EXPECT_NEAR(measure(moved).volume, measure(mesh).volume, 1e-13);
  int stayed = 0;
  for (Eigen::Index i = 0; i < mesh.nodes.cols(); ++i) stayed += moved.nodes.col(i) == mesh.nodes.col(i);
  EXPECT_EQ(stayed, static_cast<int>(skin.node_of_vertex.size()));
  EXPECT_EQ(perturbed(mesh, 0.2, 7).nodes, moved.nodes);
  EXPECT_NE(perturbed(mesh, 0.2, 8).nodes, moved.nodes);
  expect_contains(error_of([&] { perturbed(mesh, 0.99, 7); }), "amplitude = 0.99 inverts element");
  expect_contains(error_of([&] { perturbed(mesh, -1, 7); }), "amplitude = -1 must lie in [0, 1)");
}

TEST(Generators, BadSpecsAreRefusedWithKeyAndValue) {
  const auto refused = [](auto change, const std::string& fragment, const std::string& name = "ball") {
    MeshSpec spec = generator_spec(name);
    change(spec);
    expect_contains(error_of([&] { tet_mesh(spec, ""); }), fragment);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  refused([](MeshSpec& s) { s.generator = "bal"; },
          "unknown mesh generator \"bal\" (did you mean \"ball\"?)");
  refused([](MeshSpec& s) { s.radius_m = -1; },
          "generator \"ball\": radius_m = -1 must lie in (0, 1000000); lengths are in metres");
  refused([](MeshSpec& s) { s.radius_m = kNan; }, "radius_m = nan");
  refused([](MeshSpec& s) { s.element_size_m = 0; }, "element_size_m = 0 must lie in");
  refused([](MeshSpec& s) { s.element_size_m = 1e-9; }, "element_size_m = 1e-09 gives about");
  refused([](MeshSpec& s) { s.grading = 0; }, "grading = 0 must lie in [0.5, 32]");
  refused([](MeshSpec& s) { s.size_m = {1, 0, 1}; }, "size_m[1] = 0", "box");
  refused([](MeshSpec& s) { s.size_m = {1e5, 1e-9, 1e-9}, s.element_size_m = 1e-5; }, "gives about", "box");
  refused([](MeshSpec& s) { s.length_m = -2; }, "length_m = -2", "cylinder");
  refused([](MeshSpec& s) { s.size_m[2] = -1; }, "size_m[2] = -1", "tet");
  refused([](MeshSpec& s) { s.file = "a.msh"; }, "exclude each other");
  refused([](MeshSpec& s) { s.generator = ""; }, "neither file nor generator");
  expect_contains(error_of([] { surface(generator_spec("tet"), ""); }), "unknown surface generator \"tet\"");
}
