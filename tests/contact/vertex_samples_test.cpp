// Samples at vertices of whole bodies, through contact sources.
#include "grid_proxies.h"
#include "images.h"
#include "surfaces.h"

using namespace contact_tests;

namespace {

/// A soft unit sphere pressed 0.1 deep into a rigid slab, in a rotated and moved frame.
struct OnSlab {
  Pose pose{quaternion_of(Vec3(0.5, 1.1, -0.4)), Vec3(2, -1, 5)};
  TriMesh slab;
  SurfaceWorld soft;

  explicit OnSlab(int rings) : soft(sphere(pose * Vec3(0.1, -0.2, 0.9), 1.0, rings)) {
    slab.vertices.resize(3, 8);
    for (int i = 0; i < 8; ++i)
      slab.vertices.col(i) = Vec3(i & 1 ? 4.0 : -4.0, i & 2 ? 4.0 : -4.0, i & 4 ? 0.0 : -3.0);
    slab.faces.resize(3, 12);
    slab.faces << 4, 4, 0, 0, 0, 0, 2, 2, 0, 0, 1, 1,  //
        5, 7, 3, 2, 1, 5, 7, 3, 6, 2, 3, 7,            //
        7, 6, 1, 3, 5, 4, 6, 7, 4, 6, 7, 5;
  }
  std::vector<contact::ContactSample> samples(int pixels) {
    const auto source = contact::make_image_source(soft.surface, slab, 0, contact::fixed_frame(pose),
                                                   image_options(pixels, 0.02));
    std::vector<contact::ContactSample> out;
    source->query(soft.state.view(), out);
    return out;
  }
};

}  // namespace

// Every vertex below the slab's face gives a sample, none is missed and none is extra; each has the exact
// depth, and a third of its triangles' projected area.
TEST(VertexSamples, AreTheVerticesBelowAFace) {
  OnSlab scene(40);
  const Pose inverse = scene.pose.inverse();
  for (const int pixels : {64, 256}) {
    const auto samples = scene.samples(pixels);
    ASSERT_FALSE(samples.empty());
    const Vec3 n = samples[0].normal;
    const auto view = scene.soft.state.view();
    const int count = static_cast<int>(scene.soft.surface.node_of_vertex.size());
    std::vector<double> area(static_cast<std::size_t>(count), 0.0);
    for (const auto f : scene.soft.surface.faces.colwise()) {
      const Vec3 p = view.position(2 + f[0]), q = view.position(2 + f[1]), r = view.position(2 + f[2]);
      const double one = -0.5 * (q - p).cross(r - p).dot(n);
      for (int k = 0; k < 3 && one > 0.0; ++k) area[static_cast<std::size_t>(f[k])] += one / 3.0;
    }
    std::vector<int> seen(static_cast<std::size_t>(count), 0);
    for (const auto& s : samples) {
      int heaviest = 0;
      for (int k = 1; k < s.a.count; ++k)
        if (s.a.weight[static_cast<std::size_t>(k)] > s.a.weight[static_cast<std::size_t>(heaviest)])
          heaviest = k;
      // affine in the position: rounding grows with the ratio of patch size to triangle size, 100 at the pole
      EXPECT_NEAR(s.a.weight[static_cast<std::size_t>(heaviest)], 1.0, 1e-14);
      const int vertex = s.a.node[static_cast<std::size_t>(heaviest)] - 2;
      ++seen[static_cast<std::size_t>(vertex)];
      const Vec3 local = inverse * Vec3(view.position(vertex + 2));
      EXPECT_NEAR(s.gap, local.z() / (inverse.rotation * n).z(), 1e-12);
      EXPECT_NEAR(s.area, area[static_cast<std::size_t>(vertex)], 1e-12);
    }
    int below = 0;
    for (int v = 0; v < count; ++v) {
      const double z = (inverse * Vec3(view.position(v + 2))).z();
      if (z < 0.0) {
        ++below;
        EXPECT_EQ(seen[static_cast<std::size_t>(v)], 1) << v << " at " << z;
      } else if (z > 0.03) {
        EXPECT_EQ(seen[static_cast<std::size_t>(v)], 0) << v << " at " << z;
      }
    }
    EXPECT_GT(below, 100);
  }
}

// The sum of depth x area converges to the volume of the overlap, pi d^2 (3 - d)/3.
TEST(VertexSamples, SumToTheOverlapVolume) {
  const double volume = kPi * 0.01 * (3.0 - 0.1) / 3.0;
  std::vector<double> errors;
  for (const int rings : {20, 40, 80}) {
    OnSlab scene(rings);
    double sum = 0.0;
    for (const auto& s : scene.samples(256)) sum -= std::min(s.gap, 0.0) * s.area;
    errors.push_back(std::abs(sum / volume - 1.0));
  }
  EXPECT_LT(errors[0], 0.2);
  EXPECT_LT(errors[2], 0.015);
  EXPECT_LT(errors[2], 0.2 * errors[0]);
}

// A box flat on a slab, with walls along the normal up to rounding: the vertices on its rim are corners of
// walls, and a line through one may miss the box. Each is a sample, carried by the face below.
TEST(VertexSamples, OfABoxHangOnTheFaceThatIsSeen) {
  constexpr int kCellsX = 5, kCellsY = 4;
  for (int turn = 0; turn < 16; ++turn) {
    const Pose pose{quaternion_of(Vec3(0.3 + 0.7 * turn, 1.1, -0.4)), Vec3(2, -1, 0.3 * turn)};
    TriMesh box = mesh::box_surface(Vec3(1.0, 0.8, 0.6), {kCellsX, kCellsY, 3});
    const auto slab = mesh::box_surface(Vec3(3.0, 3.0, 1.0), {3, 3, 1});
    for (auto x : box.vertices.colwise()) x = pose * Vec3(x + Vec3(0.05, -0.02, 0.3 + 0.5 - 0.01));
    if (turn % 2 == 1) box.faces = box.faces.rowwise().reverse().eval();  // walls come after the face below
    SurfaceWorld soft(box);
    std::vector<contact::ContactSample> samples;
    contact::make_image_source(soft.surface, slab, 0, contact::fixed_frame(pose), image_options(128, 0.02))
        ->query(soft.state.view(), samples);
    EXPECT_EQ(samples.size(), static_cast<std::size_t>((kCellsX + 1) * (kCellsY + 1))) << turn;
    double area = 0.0;
    for (const auto& s : samples) {
      area += s.area;
      EXPECT_NEAR(s.gap, -0.01, 1e-12);
      for (int i = 0; i < s.a.count; ++i) {
        const double weight = s.a.weight[static_cast<std::size_t>(i)];
        EXPECT_NEAR(weight, std::round(weight), 1e-12) << "turn " << turn;  // 1 at the vertex, else 0
      }
    }
    EXPECT_NEAR(area, 1.0 * 0.8, 1e-12) << turn;
  }
}
