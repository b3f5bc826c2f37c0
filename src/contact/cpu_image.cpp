#include <algorithm>
#include <limits>

#include "contact/depth_image.h"
#include "contact/raster_kernels.h"
#include "palpate/core/clock.h"
#include "palpate/core/counters.h"
#include "palpate/core/instructions.h"

namespace palpate::contact {

namespace baseline {
extern const RasterKernels kRaster;
}
#ifdef PALPATE_X86_KERNELS
namespace avx2 {
extern const RasterKernels kRaster;
}
namespace avx512 {
extern const RasterKernels kRaster;
}
#endif

const RasterKernels& best_raster_kernels() {
#ifdef PALPATE_X86_KERNELS
  const Instructions set = best_instructions();
  if (set == Instructions::kAvx512) return avx512::kRaster;
  if (set == Instructions::kAvx2) return avx2::kRaster;
#endif
  return baseline::kRaster;
}

namespace {

/// Floats or integers that start on a line of the cache.
template <class T>
class Aligned {
 public:
  T* resized(std::size_t count) {
    if (count > size_) {
      data_ = std::unique_ptr<T[], Free>(
          static_cast<T*>(::operator new (count * sizeof(T), std::align_val_t{64})));
      size_ = count;
    }
    return data_.get();
  }

 private:
  struct Free {
    void operator()(T* p) const { ::operator delete (p, std::align_val_t{64}); }
  };
  std::unique_ptr<T[], Free> data_;
  std::size_t size_ = 0;
};

class CpuImage final : public DepthImage {
 public:
  CpuImage() { counters::count("contact.cpu_image"); }

  void answer(std::span<DepthRequest* const> requests) override {
    times_ = {};
    for (DepthRequest* request : requests) answer(*request);
  }

 private:
  void answer(DepthRequest& request) {
    const ContactCamera& camera = request.camera;
    std::vector<FacePair>& pairs = request.pairs;
    pairs.clear();
    request.layered.clear();
    if (!camera.sees_something()) return;
    const RasterTarget above = draw(a_, *request.a, camera, 1.0), below = draw(b_, *request.b, camera, -1.0);
    const ScopedTimer timer(times_.gather);
    const auto size = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
    if (found_.size() < size) found_.resize(size);
    // The depths are single precision: the exact gap decides later.
    const double slack = 1e-5 * (camera.far - camera.near);
    const int count =
        kernels_.pair(above, below, static_cast<float>(request.candidate_gap + slack), found_.data());
    pairs.resize(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      pairs[i] = {found_[i].pixel, found_[i].a, found_[i].b};
      if (found_[i].layered) request.layered.push_back(found_[i].pixel);
    }
  }

  struct Surface {
    Aligned<float> depth;
    Aligned<std::int32_t> triangle;
    std::vector<float> vertices;
    std::vector<std::int32_t> corners;
  };

  // Of w in single precision, with slopes that are wild in slivers; a body is thicker than that.
  static constexpr double kLayerGap = 1e-4;  // of the slab

  /// Draws with `side` w as depth, w counted from the middle of the slab: a, which faces down, with 1.
  RasterTarget draw(Surface& surface, const Patch& patch, const ContactCamera& camera, double side) {
    load(surface, patch, camera, side);
    const ScopedTimer timer(times_.passes);
    RasterTarget target;
    target.width = camera.width;
    target.height = camera.height;
    target.stride = (camera.width + kRasterLanes - 1) / kRasterLanes * kRasterLanes;
    const auto size = static_cast<std::size_t>(target.stride) * static_cast<std::size_t>(target.height);
    target.depth = surface.depth.resized(size);
    target.triangle = surface.triangle.resized(size);
    std::fill_n(target.depth, size, std::numeric_limits<float>::infinity());
    std::fill_n(target.triangle, size, -1);
    kernels_.draw(surface.vertices.data(), surface.corners.data(), static_cast<int>(patch.visible.size()),
                  static_cast<float>(-side), static_cast<float>(kLayerGap * (camera.far - camera.near)),
                  target);
    return target;
  }

  /// The patch in pixels, in single precision.
  void load(Surface& surface, const Patch& patch, const ContactCamera& camera, double side) {
    const ScopedTimer timer(times_.upload);
    surface.vertices.resize(static_cast<std::size_t>(patch.uvw.size()));
    const double scale = 1.0 / camera.pixel, middle = 0.5 * (camera.near + camera.far);
    for (Eigen::Index i = 0; i < patch.uvw.cols(); ++i) {
      float* to = surface.vertices.data() + 3 * i;
      to[0] = static_cast<float>(scale * (patch.uvw(0, i) - camera.u0));
      to[1] = static_cast<float>(scale * (patch.uvw(1, i) - camera.v0));
      to[2] = static_cast<float>(side * (patch.uvw(2, i) - middle));
    }
    surface.corners.resize(3 * patch.visible.size());
    for (std::size_t f = 0; f < patch.visible.size(); ++f)
      for (int k = 0; k < 3; ++k)
        surface.corners[3 * f + static_cast<std::size_t>(k)] = (*patch.faces)(k, patch.visible[f]);
  }

  const RasterKernels& kernels_ = best_raster_kernels();
  Surface a_, b_;
  std::vector<RasterPair> found_;
};

}  // namespace

std::unique_ptr<DepthImage> make_cpu_image() { return std::make_unique<CpuImage>(); }

}  // namespace palpate::contact
