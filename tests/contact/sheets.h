#pragma once
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "contact/depth_image.h"
#include "palpate/contact/sources.h"

/// Patches in contact axes, for what stands under src/contact.
namespace contact_tests {

using namespace palpate;
using namespace palpate::contact;

/// A bumpy sheet over [-1, 1]^2, its triangles' diagonals and the places of its vertices at random; `side`
/// +1: it faces up.
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

inline std::vector<FacePair> pairs_of(DepthImage& image, Patch& a, Patch& b, double gap, int pixels,
                                      ContactCamera* camera = nullptr,
                                      std::vector<std::uint32_t>* layered = nullptr) {
  const ContactCamera at = fit_camera(a, b, gap, pixels, {0.0, 0.0});
  std::vector<FacePair> out;
  std::vector<std::uint32_t> layers;
  image.find_pairs(a, b, at, gap, out, layered ? *layered : layers);
  if (camera) *camera = at;
  return out;
}

inline std::unique_ptr<DepthImage> image_of(DepthBackend backend, int pixels) {
  if (backend == DepthBackend::kGpu) return make_gpu_image(pixels);
  return backend == DepthBackend::kCpu ? make_cpu_image() : make_exact_image();
}

}  // namespace contact_tests
