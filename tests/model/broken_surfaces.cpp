#include "broken_surfaces.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "surfaces.h"

namespace broken {
namespace {

using surfaces::ball, surfaces::box, surfaces::loose, surfaces::together, surfaces::turned, surfaces::without;

model::Input surface(TriMesh mesh) {
  model::Input out;
  out.name = "test";
  out.source = "test.obj";
  out.from = surfaces::from();
  out.surface = std::move(mesh);
  return out;
}

model::Input tetrahedra(TetMesh mesh) {
  model::Input out;
  out.name = "test";
  out.source = out.from.source = "test.msh";
  out.tets = std::move(mesh);
  return out;
}

/// Every vertex moved by up to `amplitude` [m] along each axis.
TriMesh noisy(TriMesh mesh, double amplitude) {
  std::mt19937 random(17);
  for (Eigen::Index i = 0; i < mesh.vertices.size(); ++i)
    mesh.vertices.data()[i] += amplitude * (2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0);
  return mesh;
}

TriMesh scaled(TriMesh mesh, double x, double y, double z) {
  mesh.vertices = Vec3(x, y, z).asDiagonal() * mesh.vertices;
  return mesh;
}

TriMesh mapped(TriMesh mesh, const std::function<Vec3(const Vec3&)>& map) {
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i)
    mesh.vertices.col(i) = map(Vec3(mesh.vertices.col(i)));
  return mesh;
}

TriMesh with_vertex(TriMesh mesh, int vertex, const Vec3& at) {
  mesh.vertices.col(vertex) = at;
  return mesh;
}

/// Boundary of the tetrahedra for whose centres `keep` holds.
TriMesh boundary_of(TetMesh mesh, const std::function<bool(const Vec3&)>& keep) {
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < mesh.tets.cols(); ++t) {
    Vec3 middle = Vec3::Zero();
    for (int k = 0; k < 4; ++k) middle += mesh.nodes.col(mesh.tets(k, t)) / 4;
    if (keep(middle)) mesh.tets.col(kept++) = mesh.tets.col(t);
  }
  mesh.tets.conservativeResize(4, kept);
  return mesh::boundary(mesh).surface;
}

/// Adds a pyramid of this height on each face: sharp edges everywhere.
TriMesh stellated(const TriMesh& mesh, double height) {
  const Eigen::Index n = mesh.vertices.cols(), faces = mesh.faces.cols();
  TriMesh out{Points(3, n + faces), Faces(3, 3 * faces)};
  out.vertices.leftCols(n) = mesh.vertices;
  for (Eigen::Index f = 0; f < faces; ++f) {
    const Vec3 a = mesh.vertices.col(mesh.faces(0, f)), b = mesh.vertices.col(mesh.faces(1, f)),
               c = mesh.vertices.col(mesh.faces(2, f));
    out.vertices.col(n + f) = (a + b + c) / 3 + height * (b - a).cross(c - a).normalized();
    for (int k = 0; k < 3; ++k)
      out.faces.col(3 * f + k) << mesh.faces(k, f), mesh.faces((k + 1) % 3, f), static_cast<int>(n + f);
  }
  return out;
}

/// A prism over a triangle with this angle [degrees] at its edge along y.
TriMesh wedge(double degrees) {
  const double half = std::tan(degrees / 2 * std::numbers::pi / 180);
  TriMesh out{Points(3, 6), Faces(3, 8)};
  out.vertices << 0, 1, 1, 0, 1, 1, -0.5, -0.5, -0.5, 0.5, 0.5, 0.5, 0, -half, half, 0, -half, half;
  out.faces << 0, 3, 0, 0, 0, 0, 1, 1, 1, 5, 4, 3, 2, 5, 4, 5, 2, 4, 1, 4, 5, 3, 5, 2;
  return out;
}

/// Two boxes that share the vertices of one edge, or one vertex only.
TriMesh boxes_sharing(bool edge) {
  const TetMesh cells = mesh::box(Vec3(2, 2, 2), {4, 4, 4});
  return boundary_of(cells, [edge](const Vec3& p) {
    return edge ? p.x() * p.y() > 0 && p.z() < 0 : (p.array() > 0).all() || (p.array() < 0).all();
  });
}

/// A ball with a thin fin, a finger's breadth thick at the root and sharp at the rim.
TriMesh finned(double sharpness) {
  return mapped(ball(1.0, 10), [&](const Vec3& p) -> Vec3 {
    const double near = std::exp(-sharpness * p.y() * p.y());
    return p * (1.0 + 0.9 * near * std::max(0.0, p.z()));
  });
}

TriMesh mobius() {
  constexpr int kSteps = 40;
  TriMesh out{Points(3, 2 * kSteps), Faces(3, 2 * kSteps)};
  for (int i = 0; i < kSteps; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSteps;
    for (int side = 0; side < 2; ++side) {
      const double r = 1 + 0.3 * (side ? 1 : -1) * std::cos(angle / 2);
      out.vertices.col(2 * i + side) << r * std::cos(angle), r * std::sin(angle),
          0.3 * (side ? 1 : -1) * std::sin(angle / 2);
    }
    const int a = 2 * i, b = a + 1, twist = i + 1 == kSteps;
    const int c = (a + 2) % (2 * kSteps) + twist, d = (a + 3) % (2 * kSteps) - twist;
    out.faces.col(2 * i) << a, b, c;
    out.faces.col(2 * i + 1) << b, d, c;
  }
  return out;
}

TriMesh with_faces(TriMesh mesh, const std::vector<std::array<int, 3>>& more) {
  const Eigen::Index n = mesh.faces.cols();
  mesh.faces.conservativeResize(3, n + static_cast<Eigen::Index>(more.size()));
  for (std::size_t i = 0; i < more.size(); ++i)
    mesh.faces.col(n + static_cast<Eigen::Index>(i)) << more[i][0], more[i][1], more[i][2];
  return mesh;
}

TriMesh some_turned(TriMesh mesh, int every) {
  for (Eigen::Index f = 0; f < mesh.faces.cols(); f += every) std::swap(mesh.faces(1, f), mesh.faces(2, f));
  return mesh;
}

TriMesh not_finite() {
  TriMesh out = ball();
  out.vertices(1, 17) = std::numeric_limits<double>::quiet_NaN();
  return out;
}

TetMesh flattened(double by) {
  TetMesh out = mesh::ball(1.0, 0.4);
  // one inner node is moved towards a face of one of its tetrahedra
  const int tet = static_cast<int>(out.tets.cols()) / 2;
  const Vec3 foot =
      (out.nodes.col(out.tets(1, tet)) + out.nodes.col(out.tets(2, tet)) + out.nodes.col(out.tets(3, tet))) /
      3;
  out.nodes.col(out.tets(0, tet)) = foot + by * (out.nodes.col(out.tets(0, tet)) - foot);
  return out;
}

/// An inner node pulled through the face of a neighbouring tetrahedron.
TetMesh inverted() { return flattened(-0.2); }

/// Twelve fins from pole to pole, which meet at the poles.
TriMesh fins() {
  constexpr double kFins = 12.0;
  return mapped(ball(1.0, 16), [](const Vec3& p) -> Vec3 {
    return p * (1 + 0.5 * std::pow(std::sin(kFins / 2 * std::atan2(p.y(), p.x())), 8));
  });
}

model::Options options(const std::function<void(model::Options&)>& set) {
  model::Options out;
  set(out);
  return out;
}

/// Returns sound surfaces that are hard to mesh.
std::vector<Entry> sound_surfaces() {
  const auto largest = options([](model::Options& o) { o.repair.largest_shell = true; });
  const auto no_creases = options([](model::Options& o) { o.creases = model::Creases::kNone; });
  return {
      {"ball", [] { return surface(ball()); }, "model"},
      {"noise of a tenth of an edge", [] { return surface(noisy(ball(), 0.015)); }, "model"},
      {"noise of half an edge", [] { return surface(noisy(ball(), 0.08)); }, "model"},
      {"noise on a fine ball", [] { return surface(noisy(ball(1.0, 24), 0.03)); }, "model", false},
      {"coarse relief", [] { return surface(noisy(ball(1.0, 3), 0.25)); }, "model"},
      {"boundary of coarse tetrahedra with relief",
       [] {
         TetMesh coarse = mesh::ball(1.0, 0.5);
         TriMesh skin = boundary_of(coarse, [](const Vec3& p) { return p.x() + p.y() > -0.9; });
         return surface(noisy(skin, 0.12));
       },
       "model"},
      {"pyramids on every face", [] { return surface(stellated(ball(1.0, 2), 0.6)); }, "model"},
      {"needles on every face", [] { return surface(stellated(ball(1.0, 2), 2.0)); }, "model", false},
      {"stellated without creases", [] { return surface(stellated(ball(1.0, 2), 0.6)); }, "model", true,
       no_creases},
      {"wedge of 30 degrees", [] { return surface(wedge(30)); }, "model"},
      {"wedge of 8 degrees", [] { return surface(wedge(8)); }, "model", false},
      {"wedge of 30 degrees without creases", [] { return surface(wedge(30)); }, "model", true, no_creases},
      {"fin", [] { return surface(finned(20)); }, "model"},
      {"knife-thin fin", [] { return surface(finned(300)); }, "model", false},
      {"one vertex pulled out",
       [] { return surface(with_vertex(ball(1.0, 6), 7, Vec3(ball(1.0, 6).vertices.col(7) * 3))); }, "model"},
      {"one vertex pushed in",
       [] { return surface(with_vertex(ball(1.0, 6), 7, Vec3(ball(1.0, 6).vertices.col(7) * 0.1))); },
       "model"},
      {"faces like needles",
       [] {
         const TriMesh b = ball();
         return surface(
             with_vertex(b, b.faces(0, 9),
                         b.vertices.col(b.faces(1, 9)) * 0.9999 + b.vertices.col(b.faces(2, 9)) * 0.0001));
       },
       "model"},
      {"sheet of a twentieth", [] { return surface(scaled(box(), 1, 1, 0.1)); }, "model"},
      {"sheet of a thousandth", [] { return surface(scaled(box(), 1, 1, 0.001)); },
       "m thick, with a surface of"},
      {"rod of 1 to 40", [] { return surface(scaled(box(), 10, 0.5, 0.5)); }, "model"},
      {"bent sheet",
       [] {
         return surface(mapped(mesh::box_surface(Vec3(2, 1, 0.1), {24, 12, 2}), [](const Vec3& p) -> Vec3 {
           return {p.x(), p.y(), p.z() + 0.4 * std::sin(3 * p.x())};
         }));
       },
       "model"},
      {"thin cup: a shell of a hundredth",
       [] { return surface(together(ball(1.0, 8), turned(ball(0.97, 8)))); }, "model", false},
      {"cavity that nearly touches",
       [] { return surface(together(ball(1.0, 10), turned(ball(0.4, 6, Vec3(0, 0, 0.58))))); }, "model"},
      {"two bodies that nearly touch",
       [] { return surface(together(ball(1.0, 8), ball(1.0, 8, Vec3(2.0001, 0, 0)))); }, "separate bodies"},
      {"two bodies, the larger is wanted",
       [] { return surface(together(ball(1.0, 8), ball(0.5, 8, Vec3(1.6, 0, 0)))); }, "model", true, largest},
      {"slit that nearly closes",
       [] {
         return surface(
             mapped(boundary_of(mesh::box(Vec3(2, 1, 1), {7, 4, 4}),
                                [](const Vec3& p) { return std::abs(p.x()) > 1.0 / 7 || p.z() < 0; }),
                    [](const Vec3& p) -> Vec3 {
                      return {std::abs(p.x()) < 0.2 ? p.x() * 0.02 : p.x(), p.y(), p.z()};
                    }));
       },
       "model", false},
  };
}

/// Returns surfaces with defects, and in other units and places.
std::vector<Entry> defective_surfaces() {
  const auto hole = [](double z) { return without(ball(), [z](const Vec3& p) { return p.z() > z; }); };
  const auto strict = options([](model::Options& o) { o.repair.wrap = false; });
  return {
      {"boxes that share an edge", [] { return surface(boxes_sharing(true)); }, "model"},
      {"boxes that share a vertex", [] { return surface(boxes_sharing(false)); }, "model"},
      {"small hole", [hole] { return surface(hole(0.95)); }, "model"},
      {"many small holes",
       [] {
         return surface(without(ball(1.0, 12), [](const Vec3& p) {
           return std::cos(9 * p.x()) * std::cos(9 * p.y()) * std::cos(9 * p.z()) > 0.93;
         }));
       },
       "model"},
      {"half a ball", [hole] { return surface(hole(0.0)); }, "the surface has a hole"},
      {"sheet without thickness",
       [] { return surface(without(box(), [](const Vec3& p) { return p.z() < 0.49; })); },
       "the surface has a hole"},
      {"flat ball", [] { return surface(scaled(ball(), 1, 1, 0)); }, "the surface has a hole"},
      {"one-sided band", [] { return surface(mobius()); }, "test.obj"},
      {"a number that is none", [] { return surface(not_finite()); }, "is not a finite length"},
      {"doubled faces",
       [] {
         const TriMesh b = ball();
         return surface(with_faces(b, {{b.faces(0, 5), b.faces(1, 5), b.faces(2, 5)},
                                       {b.faces(1, 9), b.faces(0, 9), b.faces(2, 9)}}));
       },
       "model"},
      {"a fin of one face",
       [] {
         return surface(with_faces(ball(), {{0, 1, 300}}));
       },
       "model"},
      {"faces turned at random", [] { return surface(some_turned(ball(), 3)); }, "model"},
      {"inside out", [] { return surface(turned(ball())); }, "model"},
      {"loose triangles with rounding",
       [] {
         TriMesh mesh = loose(ball());
         for (Eigen::Index i = 0; i < mesh.vertices.size(); ++i)
           mesh.vertices.data()[i] = static_cast<float>(mesh.vertices.data()[i]);
         return surface(mesh);
       },
       "model"},
      {"two balls through each other",
       [] { return surface(together(ball(1.0, 8), ball(1.0, 8, Vec3(1, 0.02, 0.03)))); }, "model", false},
      {"the same, not to be wrapped",
       [] { return surface(together(ball(1.0, 8), ball(1.0, 8, Vec3(1, 0.02, 0.03)))); }, "others intersect",
       true, strict},
      {"a vertex through the other side",
       [] {
         TriMesh mesh = ball(1.0, 12);
         Eigen::Index top = 0;
         mesh.vertices.row(2).maxCoeff(&top);
         return surface(with_vertex(mesh, static_cast<int>(top), Vec3(0.12, 0.05, -1.3)));
       },
       "model"},
      {"crumpled", [] { return surface(noisy(ball(1.0, 12), 0.3)); }, "model", false},
      {"in millimetres, 1e-3", [] { return surface(scaled(noisy(ball(), 0.015), 1e-3, 1e-3, 1e-3)); },
       "model"},
      {"in kilometres, 1e3", [] { return surface(scaled(noisy(ball(), 0.015), 1e3, 1e3, 1e3)); }, "model"},
      {"far from the origin",
       [] { return surface(mapped(ball(), [](const Vec3& p) -> Vec3 { return p + Vec3(1e4, 0, 0); })); },
       "model"},
  };
}

/// Returns tetrahedra of users, and limits that are too small.
std::vector<Entry> tetrahedra_and_limits() {
  const auto remesh = options([](model::Options& o) { o.remesh = true; });
  const auto accept = options([](model::Options& o) { o.accept_angles = true; });
  const auto hurried = options([](model::Options& o) { o.tetrahedra.limits.seconds = 1e-6; });
  const auto few_points = options([](model::Options& o) { o.tetrahedra.limits.points = 250; });
  // enough for 1,500 tetrahedra, but not for the relief
  const auto too_few = options([](model::Options& o) {
    o.tetrahedra.limits.points = 600;
    o.creases = model::Creases::kNone;
  });
  return {
      {"fins that meet at poles", [] { return surface(fins()); }, "model", false, {}, 6000},
      {"the same with too few tetrahedra", [] { return surface(fins()); }, "outside the tetrahedra", false},
      {"tetrahedra of others, flat", [] { return tetrahedra(flattened(0.05)); }, "--remesh"},
      {"flat tetrahedra, taken", [] { return tetrahedra(flattened(0.05)); }, "model", true, accept},
      {"flat tetrahedra, filled anew", [] { return tetrahedra(flattened(0.05)); }, "model", true, remesh},
      {"inverted tetrahedra", [] { return tetrahedra(inverted()); }, "lie on the same side", true, accept},
      {"tetrahedra without volume", [] { return tetrahedra(flattened(0.0)); }, "test.msh", true, accept},
      {"inverted tetrahedra, filled anew", [] { return tetrahedra(inverted()); }, "model", true, remesh},
      {"no time", [] { return surface(ball()); }, "--limit-s", true, hurried},
      {"few points", [] { return surface(ball()); }, "have about 300 points, more than the limit of 250",
       true, few_points},
      {"points run out", [] { return surface(stellated(ball(1.0, 2), 0.6)); },
       "need more than 600 points, most of them around", true, too_few},
  };
}

}  // namespace

std::vector<Entry> entries() {
  std::vector<Entry> out = sound_surfaces();
  for (const auto& more : {defective_surfaces(), tetrahedra_and_limits()})
    out.insert(out.end(), more.begin(), more.end());
  return out;
}

}  // namespace broken
