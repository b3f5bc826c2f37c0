#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "contact/image_side.h"
#include "palpate/gl/buffer.h"
#include "palpate/gl/mapped_buffer.h"

namespace palpate::contact {

/// What the vertices of surfaces are means of, in the GPU's memory: a body's nodes, or a rigid surface's
/// vertices, about an origin that was taken off in double precision.
struct GpuPoints {
  std::uint32_t first = 0;  ///< in the buffer of all points
  std::size_t count = 0;
  Vec3 origin = Vec3::Zero();  ///< in the points' axes
  std::uint64_t sent = 0;      ///< the query that they are of; 0: none
};

/// A surface in the GPU's memory, sent once: which points carry each vertex, by which weights, and the faces,
/// in the order of the patches that regions are made of.
struct GpuSurface {
  gl::Buffer vertices, corners;
  gl::VertexArray layout;
  std::vector<int> place_of_face;  ///< in `corners`
  GpuPoints* points = nullptr;
};

/// The surfaces of all sides that a device has met.  A query sends its nodes once, and nothing else of it.
class GpuSurfaces {
 public:
  void start_query() { ++query_; }
  /// That of a side: made where it is not there yet.
  GpuSurface& at(const ImageSide& side);
  /// Its points as they are now, where the query under way has not sent them.  @pre no other side comes new
  /// before they are drawn
  void send_points(const GpuSurface& surface, const ImageSide& side);
  void bind_points(unsigned index) const { buffer_.bind_storage(index); }
  std::size_t size() const { return surfaces_.size(); }
  std::size_t sent_bytes() const { return sent_bytes_; }  ///< of points, since it was made

 private:
  GpuPoints& points_of(const ImageSide& side);

  std::vector<std::unique_ptr<GpuSurface>> surfaces_;
  std::vector<std::unique_ptr<GpuPoints>> points_;
  std::map<std::uint64_t, GpuSurface*> by_side_, by_content_;
  std::map<std::pair<int, std::size_t>, GpuPoints*> by_block_;  ///< and how many they are
  gl::MappedBuffer buffer_{gl::MappedBuffer::For::kUpload};     ///< x, y, z, 0
  std::size_t point_count_ = 0;
  std::uint64_t query_ = 1;
  std::size_t sent_bytes_ = 0;
};

}  // namespace palpate::contact
