// Regions that are no height field along their normal: layers and walls.  Whatever the image, their samples
// are those of exact lines.
#include "backends.h"
#include "prism.h"
#include "surfaces.h"

using namespace contact_tests;

namespace {

TriMesh board(double half_length, double half_width, double low, double high) {
  return prism({{-half_length, low}, {half_length, low}, {half_length, high}, {-half_length, high}},
               {{0, 1, 2}, {0, 2, 3}}, half_width);
}

TriMesh both(const TriMesh& a, const TriMesh& b) {
  TriMesh out;
  out.vertices.resize(3, a.vertices.cols() + b.vertices.cols());
  out.vertices << a.vertices, b.vertices;
  out.faces.resize(3, a.faces.cols() + b.faces.cols());
  out.faces << a.faces, (b.faces.array() + static_cast<int>(a.vertices.cols())).matrix();
  return out;
}

TriMesh moved(TriMesh mesh, const Pose& pose) {
  for (auto x : mesh.vertices.colwise()) x = pose * Vec3(x);
  return mesh;
}

double signed_volume(const TriMesh& mesh) {
  double sum = 0.0;
  for (const auto f : mesh.faces.colwise())
    sum +=
        Vec3(mesh.vertices.col(f[0])).dot(Vec3(mesh.vertices.col(f[1])).cross(Vec3(mesh.vertices.col(f[2]))));
  return sum / 6.0;
}

struct Query {
  std::vector<contact::ContactSample> samples;
  long lines = 0;
};

Query query(const TriMesh& soft, const TriMesh& rigid, const Pose& pose, contact::SampleRule rule) {
  SurfaceWorld world(soft);
  contact::ImageOptions options = image_options(202, 0.02);
  options.samples = rule;
  const auto source =
      contact::make_image_source(world.surface, rigid, 0, contact::fixed_frame(pose), options);
  Query out;
  source->query(world.state.view(), out.samples);
  out.lines = source->stages()->lines;
  return out;
}

constexpr double kFaces = 1e-9;  // of the length: libccd's normal of two faces

}  // namespace

ON_EACH_BACKEND(Layers);

// A rack of two boards in one of two: each pair of boards has its own overlap, 0.1 and 0.05 deep, over
// 4 x 4.  The lowest and the highest surface alone would be 1.1 deep.
TEST_P(Layers, EachHasItsOwnDepth) {
  const TriMesh above = both(board(2.0, 2.0, -0.1, 0.5), board(2.0, 2.0, 0.95, 2.0)),
                below = both(board(5.0, 5.0, -1.0, 0.0), board(5.0, 5.0, 0.6, 1.0));
  ASSERT_NEAR(signed_volume(above), 16.0 * 1.65, 1e-12);  // closed, outward
  const Pose pose{quaternion_of(Vec3(0.3, -0.8, 0.5)), Vec3(1, 2, 3)};
  const Query found = query(moved(above, pose), below, pose, contact::SampleRule::kPixel);
  double volume = 0.0;
  long deep = 0, shallow = 0, none = 0;
  for (const auto& s : found.samples) {
    volume -= s.gap * s.area;
    ++(std::abs(s.gap + 0.1) < kFaces ? deep : std::abs(s.gap + 0.05) < kFaces ? shallow : none);
  }
  EXPECT_GT(deep, 8000);
  EXPECT_NEAR(static_cast<double>(deep), static_cast<double>(shallow), 10.0);  // the rim's rounding
  EXPECT_EQ(none, 0);
  EXPECT_NEAR(volume, 0.15 * 16.0, 0.03 * 0.15 * 16.0);  // a row of pixels at the rim
  if (GetParam() == contact::DepthBackend::kExact) {
    EXPECT_EQ(found.lines, 0);
  } else {
    EXPECT_GE(found.lines, shallow);
  }
}

// A board below another board, as a tooth of one gear lies between two of the other: along the normal, which
// the blocks beside them define, the lower one is left before the upper one is entered.  They do not touch;
// from the lowest to the highest surface it would be 0.9.
TEST_P(Layers, AToothBelowAToothDoesNotTouchIt) {
  const auto block = [](double x0, double x1, double low, double high) {
    return prism({{x0, low}, {x1, low}, {x1, high}, {x0, high}}, {{0, 1, 2}, {0, 2, 3}}, 2.0);
  };
  const TriMesh above = block(-2.0, 2.0, 0.1, 0.5),
                below = both(block(-2.0, -1.0, -3.0, 0.12), block(-2.0, 2.0, 0.7, 1.0));
  const Pose pose{quaternion_of(Vec3(0.3, -0.8, 0.5)), Vec3(1, 2, 3)};
  const Query found = query(moved(above, pose), below, pose, contact::SampleRule::kPixel);
  double volume = 0.0;
  for (const auto& s : found.samples) {
    if (s.gap >= 0.0) continue;
    volume -= s.gap * s.area;
    EXPECT_NEAR(s.gap, -0.02, kFaces);
    EXPECT_LT(s.b.offset.x(), -1.0 + kFaces);  // on the block, in its frame
  }
  EXPECT_NEAR(volume, 0.02 * 4.0, 0.05 * 0.02 * 4.0);  // a row of pixels at the rim
}

// Vertices of the upper rack: its corners, on both boards.
TEST_P(Layers, VerticesOfEach) {
  const TriMesh above = both(board(2.0, 2.0, -0.1, 0.5), board(2.0, 2.0, 0.95, 2.0)),
                below = both(board(5.0, 5.0, -1.0, 0.0), board(5.0, 5.0, 0.6, 1.0));
  const Query found = query(above, below, Pose{}, contact::SampleRule::kVertex);
  double force = 0.0;
  int deep = 0, shallow = 0;
  for (const auto& s : found.samples) {
    force -= s.gap * s.area;
    ++(std::abs(s.gap + 0.1) < kFaces ? deep : shallow);
  }
  EXPECT_EQ(deep, 4);
  EXPECT_EQ(shallow, 4);
  EXPECT_NEAR(force, 0.15 * 16.0, 1e-6);  // a uniform depth: corners sum to the overlap volume
}

// A flat block on a step with a flank 87 degrees steep: on the flank, single precision in (u, v) would be
// twenty times as wrong in depth.
TEST_P(Layers, WallsAreExact) {
  const TriMesh step = prism({{-3.0, -2.0}, {3.0, -2.0}, {3.0, 1.0}, {0.05, 1.0}, {0.0, 0.0}, {-3.0, 0.0}},
                             {{0, 1, 4}, {0, 4, 5}, {1, 3, 4}, {1, 2, 3}}, 2.0);
  ASSERT_NEAR(signed_volume(step), 4.0 * (6.0 * 2.0 + 3.0 - 0.025), 1e-12);
  const TriMesh block = board(1.0, 1.0, 0.9, 2.5);
  const Pose pose{quaternion_of(Vec3(-0.2, 0.9, 0.4)), Vec3(-3, 1, 2)};
  const Query found = query(moved(block, pose), step, pose, contact::SampleRule::kPixel);
  const Pose inverse = pose.inverse();
  long on_flank = 0, on_top = 0;
  for (const auto& s : found.samples) {
    const Vec3 x = s.b.offset;  // on the step, in its frame
    const double top = x.x() > 0.05 ? 1.0 : 20.0 * x.x();
    EXPECT_NEAR(x.z(), top, 2e-8);  // the normal's own rounding, twenty times
    EXPECT_NEAR(s.gap, 0.9 - top, 2e-8);
    ++(x.x() > 0.05 ? on_top : on_flank);
  }
  EXPECT_NEAR(std::abs((inverse.rotation * found.samples.at(0).normal).z()), 1.0, 1e-12);
  EXPECT_GT(on_top, 4000);
  EXPECT_GT(on_flank, 40);
  if (GetParam() != contact::DepthBackend::kExact) { EXPECT_GE(found.lines, on_flank); }
}

// Two spheres are height fields: nothing is left to lines, but for what the rounding of OpenGL's sub-pixel
// grid (a 256th) puts on the wrong side of an edge.
TEST_P(Layers, HeightFieldsHaveNone) {
  const Query found = query(sphere(Vec3(0, 0, 1.7), 1.0, 50), sphere(Vec3::Zero(), 0.8, 40), Pose{},
                            contact::SampleRule::kPixel);
  EXPECT_GT(found.samples.size(), 1000u);
  EXPECT_LT(found.lines, GetParam() == contact::DepthBackend::kGpu ? 100 : 3);
}
