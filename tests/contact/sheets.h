#pragma once
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "contact/depth_image.h"
#include "contact/image_side.h"
#include "contact/sources.h"

/// Patches in contact axes, for tests of src/contact internals.
namespace contact_tests {

using namespace palpate;
using namespace palpate::contact;

/// A bumpy sheet over [-1, 1]^2, with random diagonals and vertex positions; `side` +1: it faces up.
struct Sheet {
  Points vertices;
  Faces faces;
  Patch patch;

  Sheet(int n, double height, double side, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-0.3, 0.3);
    vertices.resize(3, (n + 1) * (n + 1));
    faces.resize(3, 2 * n * n);
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) {
        const bool inside = i > 0 && j > 0 && i < n && j < n;
        const double x = -1.0 + 2.0 * (i + (inside ? uniform(random) : 0.0)) / n,
                     y = -1.0 + 2.0 * (j + (inside ? uniform(random) : 0.0)) / n;
        vertices.col(i * (n + 1) + j) =
            Vec3(x, y, height + 0.1 * std::sin(3.0 * x + seed) * std::cos(4.0 * y));
      }
    Eigen::Index f = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const int a = i * (n + 1) + j, b = a + n + 1, c = b + 1, d = a + 1;
        const bool flip = random() % 2 == 0;
        faces.col(f++) = flip ? Eigen::Vector3i(a, b, c) : Eigen::Vector3i(a, b, d);
        faces.col(f++) = flip ? Eigen::Vector3i(a, c, d) : Eigen::Vector3i(b, c, d);
      }
    if (side < 0.0) faces.row(1).swap(faces.row(2));
    patch.uvw = vertices;
  }
  Patch& seen() {
    patch.faces = &faces;
    return patch;
  }
};

/// Result of an image of two patches.
struct Seen {
  std::vector<FacePair> pairs;
  ContactCamera camera;
};

inline Seen seen_in(DepthImage& image, const Patch& a, const Patch& b, const ContactCamera& camera,
                    double gap) {
  const auto surface = [](const Patch& patch) {
    return rigid_side({patch.uvw, *patch.faces}, 0, fixed_frame());
  };
  const auto side_a = surface(a), side_b = surface(b);
  std::vector<int> faces(static_cast<std::size_t>(std::max(a.faces->cols(), b.faces->cols())));
  std::iota(faces.begin(), faces.end(), 0);
  const auto first = [&](const Patch& patch) {
    return std::span(faces).first(static_cast<std::size_t>(patch.faces->cols()));
  };
  DepthRequest request;
  request.a = &a;
  request.b = &b;
  request.camera = camera;
  request.candidate_gap = gap;
  request.from_a = {side_a.get(), first(a)};
  request.from_b = {side_b.get(), first(b)};
  DepthRequest* const one = &request;
  image.start_query();
  image.answer({&one, 1});
  return {request.pairs, request.camera};
}

inline std::vector<FacePair> pairs_of(DepthImage& image, Patch& a, Patch& b, double gap, int pixels,
                                      ContactCamera* camera = nullptr) {
  Seen seen = seen_in(image, a, b, fit_camera(a, b, gap, pixels, {0.0, 0.0}), gap);
  if (camera) *camera = seen.camera;
  return seen.pairs;
}

}  // namespace contact_tests
