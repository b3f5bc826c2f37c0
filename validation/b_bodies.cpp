#include "b_bodies.h"

#include <cmath>

namespace palpate::validation {

SurfaceBody::SurfaceBody(const TriMesh& mesh) {
  dynamics::BlockSpec nodes;
  nodes.name = "surface";
  nodes.q_size = nodes.u_size = static_cast<int>(3 * mesh.vertices.cols());
  surface.block_id = state.insert(nodes, Eigen::Map<const VecX>(mesh.vertices.data(), mesh.vertices.size()),
                                  VecX::Zero(nodes.u_size));
  surface.node_of_vertex.resize(static_cast<std::size_t>(mesh.vertices.cols()));
  for (std::size_t i = 0; i < surface.node_of_vertex.size(); ++i)
    surface.node_of_vertex[i] = static_cast<int>(i);
  surface.faces = mesh.faces;
}

double volume_below_plane(const TriMesh& mesh) {
  double sum = 0.0;
  for (const auto& face : mesh.faces.colwise()) {
    std::vector<Vec3> below;
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = mesh.vertices.col(face[k]), q = mesh.vertices.col(face[(k + 1) % 3]);
      if (p.z() <= 0.0) below.push_back(p);
      if ((p.z() < 0.0) != (q.z() < 0.0)) below.push_back(p + p.z() / (p.z() - q.z()) * (q - p));
    }
    for (std::size_t k = 1; k + 1 < below.size(); ++k)
      sum += 0.5 * (below[k] - below[0]).cross(below[k + 1] - below[0]).z() *
             (below[0].z() + below[k].z() + below[k + 1].z()) / 3.0;
  }
  return sum;
}

void PointMass::add_mass(const dynamics::StateView& state, double scale, dynamics::BorderedMatrix& A) const {
  const dynamics::Block& block = *state.layout->find(block_id_);
  for (int i = block.u_offset / 3; i < (block.u_offset + block.u_size) / 3; ++i)
    A.body.add(A.body.slot(i, i), scale * mass_ * Mat3::Identity());
}

void PointMass::apply(const dynamics::StateView& state, const VecX& x, VecX& y) const {
  const dynamics::Block& block = *state.layout->find(block_id_);
  y.segment(block.u_offset, block.u_size) += mass_ * x.segment(block.u_offset, block.u_size);
}

namespace {

class PunchSource final : public contact::SampleSource {
 public:
  PunchSource(int node, double area, int across, int frame)
      : SampleSource({.name = "punch"}), node_(node), area_(area), across_(across), frame_(frame) {}
  void add_pattern(dynamics::PatternBuilder&) const override {}

  void query(const dynamics::StateView& state, std::vector<contact::ContactSample>& samples) override {
    const Vec3 x = state.position(node_);
    const double edge = std::sqrt(area_), cell = edge / across_;
    for (int i = 0; i < across_; ++i)
      for (int j = 0; j < across_; ++j) {
        contact::ContactSample sample;
        sample.a.count = 1;
        sample.a.node[0] = node_;
        sample.a.weight[0] = 1.0;
        sample.a.offset = Vec3((i + 0.5) * cell - 0.5 * edge, (j + 0.5) * cell - 0.5 * edge, 0.0);
        sample.b.frame = frame_;
        sample.b.offset = Vec3(x.x() + sample.a.offset.x(), x.y() + sample.a.offset.y(), 0.0);
        sample.area = cell * cell;
        sample.gap = x.z();
        samples.push_back(sample);
      }
  }

 private:
  int node_;
  double area_;
  int across_, frame_;
};

}  // namespace

std::unique_ptr<contact::SampleSource> make_punch_source(int node, double area, int across, int frame) {
  return std::make_unique<PunchSource>(node, area, across, frame);
}

}  // namespace palpate::validation
