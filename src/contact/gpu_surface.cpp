#include "contact/gpu_surface.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace palpate::contact {
namespace {

struct Vertex {
  std::array<std::uint32_t, 4> carriers;
  std::array<float, 4> weights;
};

std::vector<Vertex> vertices_of(const ImageSide& side) {
  std::vector<Vertex> out(static_cast<std::size_t>(side.vertex_count()));
  for (std::size_t v = 0; v < out.size(); ++v) {
    const ImageSide::Carriers of = side.carriers(static_cast<int>(v));
    for (std::size_t k = 0; k < 4; ++k) {
      out[v].carriers[k] = static_cast<std::uint32_t>(of.point[k]);
      out[v].weights[k] = static_cast<float>(of.weight[k]);
    }
  }
  return out;
}

std::vector<std::uint32_t> corners_of(const ImageSide& side) {
  const Faces& faces = side.faces();
  std::vector<std::uint32_t> out;
  out.reserve(static_cast<std::size_t>(faces.size()));
  for (Eigen::Index i = 0; i < faces.cols(); ++i) {
    const int face = side.face_at(static_cast<int>(i));
    for (int k = 0; k < 3; ++k) out.push_back(static_cast<std::uint32_t>(faces(k, face)));
  }
  return out;
}

/// FNV-1a hash, 64 bits.
class Hash {
 public:
  template <class T>
  void add(const T* values, std::size_t count) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values);
    for (std::size_t i = 0; i < count * sizeof(T); ++i) value_ = (value_ ^ bytes[i]) * 0x100000001b3;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325;
};

}  // namespace

GpuSurface& GpuSurfaces::at(const ImageSide& side) {
  GpuSurface*& found = by_side_[side.number()];
  if (!found) {
    const std::vector<Vertex> vertices = vertices_of(side);
    const std::vector<std::uint32_t> corners = corners_of(side);
    const int block = side.block_id();
    Hash hash;
    hash.add(&block, 1);
    hash.add(vertices.data(), vertices.size());
    hash.add(corners.data(), corners.size());
    if (block < 0) hash.add(side.points().data(), static_cast<std::size_t>(side.points().size()));
    GpuSurface*& same = by_content_[hash.value()];
    if (!same) {
      surfaces_.push_back(std::make_unique<GpuSurface>());
      same = surfaces_.back().get();
      same->vertices.upload(vertices);
      same->corners.upload(corners);
      same->layout.attribute_unsigned(0, same->vertices, 4, sizeof(Vertex), offsetof(Vertex, carriers));
      same->layout.attribute(1, same->vertices, 4, sizeof(Vertex), offsetof(Vertex, weights));
      same->layout.indices(same->corners);
      same->place_of_face.resize(corners.size() / 3);
      for (std::size_t i = 0; i < same->place_of_face.size(); ++i)
        same->place_of_face[static_cast<std::size_t>(side.face_at(static_cast<int>(i)))] =
            static_cast<int>(i);
      same->points = &points_of(side);
    }
    found = same;
  }
  return *found;
}

/// Returns the points of a side. The nodes of a soft body are shared by all surfaces carried by them; skins
/// and surfaces whose vertices are nodes are kept separate.
GpuPoints& GpuSurfaces::points_of(const ImageSide& side) {
  const auto count = static_cast<std::size_t>(side.points().cols());
  GpuPoints** known = side.block_id() >= 0 ? &by_block_[{side.block_id(), count}] : nullptr;
  if (known && *known) return **known;
  GpuPoints& made = *points_.emplace_back(std::make_unique<GpuPoints>());
  made.first = static_cast<std::uint32_t>(point_count_);
  made.count = count;
  point_count_ += count;
  if (known) *known = &made;
  return made;
}

void GpuSurfaces::send_points(const GpuSurface& surface, const ImageSide& side) {
  GpuPoints& points = *surface.points;
  if (const std::size_t bytes = 4 * sizeof(float) * point_count_; bytes > buffer_.capacity()) {
    buffer_.reserve(bytes);
    for (const auto& other : points_) other->sent = 0;
  }
  const bool moves = side.block_id() >= 0;  // The points of a rigid surface are constant in its frame.
  if (points.sent == query_ || (points.sent != 0 && !moves)) return;
  const Points& x = side.points();
  points.origin = 0.5 * (x.rowwise().minCoeff() + x.rowwise().maxCoeff());
  auto* out = reinterpret_cast<float*>(buffer_.data()) + 4 * static_cast<std::size_t>(points.first);
  for (Eigen::Index i = 0; i < x.cols(); ++i, out += 4) {
    for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(x(k, i) - points.origin[k]);
    out[3] = 0.0f;
  }
  sent_bytes_ += 4 * sizeof(float) * points.count;
  points.sent = query_;
}

}  // namespace palpate::contact
