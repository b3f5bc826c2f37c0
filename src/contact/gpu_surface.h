#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "contact/image_side.h"
#include "gl/buffer.h"
#include "gl/mapped_buffer.h"

namespace palpate::contact {

/// Points in GPU memory from which the vertices of surfaces are interpolated: a body's nodes, or a rigid
/// surface's vertices, relative to an origin that was subtracted in double precision.
struct GpuPoints {
  std::uint32_t first = 0;     ///< Index in the buffer of all points.
  std::size_t count = 0;       ///< Number of points.
  Vec3 origin = Vec3::Zero();  ///< Origin in the points' axes [m].
  std::uint64_t sent = 0;      ///< Query of the last upload; 0: none.
};

/// Surface in GPU memory, uploaded once: the points and weights of each vertex, and the faces, in the
/// order of the patches from which regions are composed.
struct GpuSurface {
  gl::Buffer vertices, corners;
  gl::VertexArray layout;
  std::vector<int> place_of_face;  ///< Place of each face in `corners`.
  GpuPoints* points = nullptr;
};

/// Surfaces of all sides that a device has drawn. A query uploads its points once, and nothing else of the
/// surfaces.
class GpuSurfaces {
 public:
  void start_query() { ++query_; }
  /// Returns the surface of a side, created on first use.
  GpuSurface& at(const ImageSide& side);
  /// Uploads the present points of a surface unless the present query has done so. @pre no other side is
  /// added before they are drawn
  void send_points(const GpuSurface& surface, const ImageSide& side);
  void bind_points(unsigned index) const { buffer_.bind_storage(index); }
  std::size_t size() const { return surfaces_.size(); }
  std::size_t sent_bytes() const { return sent_bytes_; }  ///< Bytes of points uploaded since construction.

 private:
  GpuPoints& points_of(const ImageSide& side);

  std::vector<std::unique_ptr<GpuSurface>> surfaces_;
  std::vector<std::unique_ptr<GpuPoints>> points_;
  std::map<std::uint64_t, GpuSurface*> by_side_, by_content_;
  std::map<std::pair<int, std::size_t>, GpuPoints*> by_block_;  ///< By block and number of points.
  gl::MappedBuffer buffer_{gl::MappedBuffer::For::kUpload};     ///< x, y, z, 0 per point.
  std::size_t point_count_ = 0;
  std::uint64_t query_ = 1;
  std::size_t sent_bytes_ = 0;
};

}  // namespace palpate::contact
