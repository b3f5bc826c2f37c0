#include "contact/frame_vertices.h"

#include "palpate/core/error.h"

namespace palpate::contact {

FrameVertices::FrameVertices(FrameSurface surface) : surface_(std::move(surface)) {
  PALPATE_CHECK(surface_.motion, "a rigid contact surface needs a frame");
  const TriMesh& mesh = surface_.mesh;
  areas_.setZero(3, mesh.vertices.cols());
  double edges = 0.0;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const auto corner = mesh.faces.col(f);
    PALPATE_CHECK(corner.minCoeff() >= 0 && corner.maxCoeff() < mesh.vertices.cols(),
                  "rigid contact surface: face {} has a vertex index out of range", f);
    const Vec3 a = mesh.vertices.col(corner[0]), b = mesh.vertices.col(corner[1]),
               c = mesh.vertices.col(corner[2]);
    const Vec3 third = (b - a).cross(c - a) / 6.0;
    for (int k = 0; k < 3; ++k) areas_.col(corner[k]) += third;
    edges += (b - a).norm() + (c - b).norm() + (a - c).norm();
  }
  if (mesh.faces.cols() > 0) mean_edge_ = edges / static_cast<double>(3 * mesh.faces.cols());
}

void FrameVertices::update(const dynamics::StateView& state) {
  pose_ = surface_.motion->pose(state);
  twist_ = surface_.motion->twist(state);
  R_ = pose_.rotation.toRotationMatrix();
  positions_.noalias() = R_ * surface_.mesh.vertices;
  positions_.colwise() += pose_.translation;
  PALPATE_CHECK(positions_.allFinite(),
                "contact query at t = {}: the position of a rigid surface is not finite", state.time);
}

SurfacePoint FrameVertices::vertex_point(int vertex) const {
  SurfacePoint point;
  point.frame = surface_.frame;
  point.offset = surface_.mesh.vertices.col(vertex);
  return point;
}

void FrameVertices::area_vectors(const std::vector<char>& requested, Points& areas) const {
  areas.setZero(3, areas_.cols());
  for (Eigen::Index v = 0; v < areas_.cols(); ++v)
    if (requested[static_cast<std::size_t>(v)]) areas.col(v).noalias() = R_ * areas_.col(v);
}

}  // namespace palpate::contact
