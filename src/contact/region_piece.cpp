#include "contact/region_piece.h"

#include <algorithm>

namespace palpate::contact {

void RegionPiece::take(const ImageSide& whole, const std::vector<int>& wanted, std::vector<int>& local,
                       const std::vector<int>& others) {
  const Faces& all = whole.faces();
  if (local.empty()) local.assign(static_cast<std::size_t>(all.maxCoeff()) + 1, -1);
  taken_.clear();
  wanted_ = wanted;
  own_ = wanted.size();
  wanted_.insert(wanted_.end(), others.begin(), others.end());
  corners_.resize(3, static_cast<Eigen::Index>(wanted_.size()));
  for (std::size_t i = 0; i < wanted_.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const int vertex = all(k, wanted_[i]);
      int& at = local[static_cast<std::size_t>(vertex)];
      if (at < 0) {
        at = static_cast<int>(taken_.size());
        taken_.push_back(vertex);
      }
      corners_(k, static_cast<Eigen::Index>(i)) = at;
    }
  world_.resize(3, static_cast<Eigen::Index>(taken_.size()));
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    world_.col(static_cast<Eigen::Index>(i)) = whole.vertex(taken_[i]);
    local[static_cast<std::size_t>(taken_[i])] = -1;
  }
}

void RegionPiece::see(const ContactAxes& axes, double side, Patch& patch) {
  axes.to_axes(world_, patch.uvw);
  face_of_.clear();
  numbers_.clear();
  faces_.resize(3, corners_.cols());
  away_.resize(3, corners_.cols());
  Eigen::Index away = 0;
  for (Eigen::Index i = 0; i < corners_.cols(); ++i) {
    const auto at = [&](int k) { return patch.uvw.col(corners_(k, i)).head<2>(); };
    const Eigen::Vector2d e = at(1) - at(0), f = at(2) - at(0);
    if (side * (e.x() * f.y() - e.y() * f.x()) <= 0.0) {
      away_.col(away++) = corners_.col(i);
      continue;
    }
    if (i >= static_cast<Eigen::Index>(own_)) continue;
    faces_.col(static_cast<Eigen::Index>(face_of_.size())) = corners_.col(i);
    face_of_.push_back(wanted_[static_cast<std::size_t>(i)]);
    numbers_.push_back(static_cast<int>(i));
  }
  faces_.conservativeResize(3, static_cast<Eigen::Index>(face_of_.size()));
  away_.conservativeResize(3, away);
  patch.faces = &faces_;
  patch.away = &away_;
}

}  // namespace palpate::contact
