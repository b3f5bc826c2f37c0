#include "contact/region_mesh.h"

namespace palpate::contact {

void RegionMesh::take(const ImageSide& whole, const std::vector<int>& faces, std::vector<int>& local) {
  const Faces& all = whole.faces();
  if (local.empty()) local.assign(static_cast<std::size_t>(all.maxCoeff()) + 1, -1);
  surface_faces_ = faces;
  faces_.resize(3, static_cast<Eigen::Index>(faces.size()));
  taken_.clear();
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const int vertex = all(k, faces[i]);
      int& at = local[static_cast<std::size_t>(vertex)];
      if (at < 0) {
        at = static_cast<int>(taken_.size());
        taken_.push_back(vertex);
      }
      faces_(k, static_cast<Eigen::Index>(i)) = at;
    }
  vertices_.resize(3, static_cast<Eigen::Index>(taken_.size()));
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    vertices_.col(static_cast<Eigen::Index>(i)) = whole.vertex(taken_[i]);
    local[static_cast<std::size_t>(taken_[i])] = -1;
  }
}

}  // namespace palpate::contact
