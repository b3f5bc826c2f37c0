// The images of a contact region: what a rasteriser sees is what lines in double precision meet.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>
#include <random>

#include "backends.h"
#include "sheets.h"

using namespace palpate;
using namespace palpate::contact;
using namespace contact_tests;

ON_EACH_BACKEND(DepthImages);

// Each pixel that both sheets cover is seen once, whatever the triangles: none is lost between two of them.
TEST_P(DepthImages, NothingIsLostBetweenTriangles) {
  for (const int n : {3, 17, 90}) {
    Sheet a(n, 0.0, -1.0, 5), b(n + 4, 0.3, 1.0, 7);
    ContactCamera camera;
    const auto pairs = pairs_of(*image_of(GetParam()), a.seen(), b.seen(), 0.05, 128, &camera);
    std::vector<int> seen(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
    for (const FacePair& pair : pairs) ++seen[pair.at];
    long covered = 0;
    for (int row = 0; row < camera.height; ++row)
      for (int column = 0; column < camera.width; ++column) {
        const double u = std::abs(camera.u(column)), v = std::abs(camera.v(row));
        if (std::max(u, v) < 1.0 - 1e-3 * camera.pixel) {
          ++covered;
          EXPECT_EQ(seen[static_cast<std::size_t>(row * camera.width + column)], 1) << n << " " << row;
        }
      }
    EXPECT_GT(covered, 15000);
  }
}

// Edges that run through the middles of pixels: such a pixel belongs to one of both triangles, or to both.
TEST_P(DepthImages, MiddlesOnEdgesAreSeen) {
  // A fan of needles about a pixel's middle, to points on a wide circle on lines with small whole slopes:
  // each edge runs through many middles, none of which single precision meets exactly.
  constexpr int kPixels = 201, kMiddle = 100;
  std::vector<Eigen::Vector2d> ends;
  for (int p = -12; p <= 12; ++p)
    for (int q = -12; q <= 12; ++q)
      if (std::gcd(p, q) == 1) ends.emplace_back(p, q);
  std::sort(ends.begin(), ends.end(), [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return std::atan2(a.y(), a.x()) < std::atan2(b.y(), b.x());
  });
  ContactCamera camera;
  camera.pixel = 1.0 / 300.0;
  camera.u0 = 0.123;
  camera.v0 = -0.077;
  camera.width = camera.height = kPixels;
  camera.near = -1.0;
  camera.far = 1.0;
  const Vec3 middle(camera.u(kMiddle), camera.v(kMiddle), 0.0);
  const auto count = static_cast<Eigen::Index>(ends.size());
  Points vertices(3, count + 1);
  Faces up(3, count), down(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector2d end = 90.37 * ends[static_cast<std::size_t>(i)].normalized();
    vertices.col(i) = middle + camera.pixel * Vec3(end.x(), end.y(), 0.0);
    up.col(i) =
        Eigen::Vector3i(static_cast<int>(i), static_cast<int>((i + 1) % count), static_cast<int>(count));
    down.col(i) = Eigen::Vector3i(up(1, i), up(0, i), up(2, i));
  }
  vertices.col(count) = middle;
  Patch a, b;
  a.uvw = b.uvw = vertices;
  b.uvw.row(2).array() += 0.1;
  a.faces = &down;
  b.faces = &up;
  fit_window(a, b, 1.0);  // all that there is
  std::vector<int> seen(static_cast<std::size_t>(kPixels * kPixels));
  for (const FacePair& pair : seen_in(*image_of(GetParam()), a, b, camera, 0.01).pairs) ++seen[pair.at];
  int lost = 0;
  for (int row = 0; row < kPixels; ++row)
    for (int column = 0; column < kPixels; ++column)
      if (std::hypot(row - kMiddle, column - kMiddle) < 85.0)
        lost += seen[static_cast<std::size_t>(row * kPixels + column)] != 1;
  EXPECT_EQ(lost, 0);
}

// The same triangles as the lines in double meet; where two triangles are equally near, within the rounding
// of single precision, either may be seen.
TEST_P(DepthImages, TheSameTrianglesAsLinesMeet) {
  Sheet a(60, 0.02, -1.0, 1), b(47, 0.0, 1.0, 2);
  const auto expected = pairs_of(*make_exact_image(), a.seen(), b.seen(), 0.03, 200),
             pairs = pairs_of(*image_of(GetParam()), a.seen(), b.seen(), 0.03, 200);
  std::map<std::uint32_t, FacePair> by_pixel;
  for (const FacePair& pair : expected) by_pixel[pair.at] = pair;
  long same = 0, other = 0, missing = 0;
  for (const FacePair& pair : pairs) {
    const auto at = by_pixel.find(pair.at);
    if (at == by_pixel.end())
      ++missing;
    else
      ++(at->second.a == pair.a && at->second.b == pair.b ? same : other);
  }
  ASSERT_GT(expected.size(), 20000u);
  EXPECT_GE(pairs.size(), expected.size());  // some a little farther than the gap
  EXPECT_LT(static_cast<double>(missing), 2e-3 * static_cast<double>(expected.size()));
  EXPECT_LT(static_cast<double>(other), 2e-3 * static_cast<double>(expected.size()));
  EXPECT_GT(static_cast<double>(same), 0.997 * static_cast<double>(expected.size()));
}

// A shelf of two boards over one of two: each overlap is seen where lines tell layers apart; an image sees
// the lowest and the highest alone.
TEST(ExactImage, SeesEveryLayer) {
  // boards of b reach up to 0 and 1, those of a down to -0.1 and 0.95
  const auto sheets = [](double low, double high, double side) {
    Sheet first(2, low, side, 3), second(2, high, side, 3);
    Sheet out = first;
    for (Sheet* s : {&first, &second}) s->vertices.row(2).setConstant(s == &first ? low : high);
    out.vertices.resize(3, first.vertices.cols() + second.vertices.cols());
    out.vertices << first.vertices, second.vertices;
    out.faces.resize(3, first.faces.cols() + second.faces.cols());
    out.faces << first.faces, (second.faces.array() + static_cast<int>(first.vertices.cols())).matrix();
    out.patch.uvw = out.vertices;
    return out;
  };
  Sheet a = sheets(-0.1, 0.95, -1.0), b = sheets(0.0, 1.0, 1.0);
  std::vector<std::uint32_t> layered;
  const auto depth_sum = [&](DepthImage& image, std::size_t* count) {
    ContactCamera camera;
    const auto pairs = pairs_of(image, a.seen(), b.seen(), 0.01, 32, &camera, &layered);
    double sum = 0.0;
    for (const FacePair& pair : pairs)
      sum += b.vertices(2, b.faces(0, b.patch.visible[pair.b])) -
             a.vertices(2, a.faces(0, a.patch.visible[pair.a]));
    *count = pairs.size();
    return sum / (camera.width * camera.height);
  };
  std::size_t exact = 0, image = 0;
  const auto lines = make_exact_image(), raster = make_cpu_image();
  const double layers = depth_sum(*lines, &exact);
  EXPECT_TRUE(layered.empty());
  const double one = depth_sum(*raster, &image);
  EXPECT_EQ(layered.size(), image);  // and says that it does not see all
  EXPECT_EQ(exact, 2 * image);
  EXPECT_NEAR(layers / one, (0.1 + 0.05) / 1.1, 1e-12);
}

// Every instruction set sees the same triangle at each pixel, but where its middle is on an edge.
TEST(CpuImage, DoesNotDependOnTheInstructions) {
  Sheet a(60, 0.02, -1.0, 1), b(47, 0.0, 1.0, 2);
  std::vector<std::vector<FacePair>> seen;
  for (const char* set : {"baseline", "avx2", "avx512"}) {
    setenv("PALPATE_INSTRUCTIONS", set, 1);
    try {
      seen.push_back(pairs_of(*make_cpu_image(), a.seen(), b.seen(), 0.03, 200));
    } catch (const std::exception&) {}  // this processor does not have it
    unsetenv("PALPATE_INSTRUCTIONS");
  }
  ASSERT_FALSE(seen.empty());
  std::map<std::uint32_t, FacePair> by_pixel;
  for (const FacePair& pair : seen[0]) by_pixel[pair.at] = pair;
  ASSERT_GT(by_pixel.size(), 20000u);
  for (const auto& pairs : seen) {  // contracted products round otherwise
    std::size_t same = 0;
    for (const FacePair& pair : pairs) {
      const auto at = by_pixel.find(pair.at);
      same += at != by_pixel.end() && at->second.a == pair.a && at->second.b == pair.b;
    }
    EXPECT_GE(same + 40, std::max(pairs.size(), seen[0].size()));
  }
}
