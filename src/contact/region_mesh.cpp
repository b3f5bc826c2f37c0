#include "contact/region_mesh.h"

namespace palpate::contact {

void RegionMesh::take(const ImageSide& whole, const std::vector<int>& faces,
                      const std::vector<int>& proxy_of_face, std::vector<int>& local) {
  constexpr int kMost = 32;  // faces of a chunk
  const Faces& all = whole.faces();
  if (local.empty()) local.assign(static_cast<std::size_t>(all.maxCoeff()) + 1, -1);
  surface_faces_ = faces;
  const int count = face_count();
  if (faces_.cols() < count) faces_.resize(3, count);
  taken_.clear();
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k) {
      const int vertex = all(k, faces[static_cast<std::size_t>(i)]);
      int& at = local[static_cast<std::size_t>(vertex)];
      if (at < 0) {
        at = static_cast<int>(taken_.size());
        taken_.push_back(vertex);
      }
      faces_(k, i) = at;
    }
  vertices_.resize(3, static_cast<Eigen::Index>(taken_.size()));
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    vertices_.col(static_cast<Eigen::Index>(i)) = whole.vertex(taken_[i]);
    local[static_cast<std::size_t>(taken_[i])] = -1;
  }
  chunks_.clear();
  for (int i = 0; i < count;) {
    Chunk chunk;
    chunk.first = i;
    chunk.proxy = proxy_of_face[static_cast<std::size_t>(faces[static_cast<std::size_t>(i)])];
    Vec3 low = vertices_.col(faces_(0, i)), high = low;
    for (; i < count && i < chunk.first + kMost &&
           proxy_of_face[static_cast<std::size_t>(faces[static_cast<std::size_t>(i)])] == chunk.proxy;
         ++i)
      for (int k = 0; k < 3; ++k) {
        low = low.cwiseMin(vertices_.col(faces_(k, i)));
        high = high.cwiseMax(vertices_.col(faces_(k, i)));
      }
    chunk.end = i;
    chunk.centre = 0.5 * (low + high);
    chunk.half = 0.5 * (high - low);
    chunks_.push_back(chunk);
  }
}

}  // namespace palpate::contact
