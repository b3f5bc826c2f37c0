#pragma once
#include "grid_proxies.h"
#include "images.h"
#include "proxy/decompose.h"
#include "surfaces.h"

namespace contact_tests {

/// A soft ball and a slab that is soft or rigid, with or without proxies.
namespace ball_and_slab {

/// A soft ball in a State: a skin embedded in tetrahedra, with proxies.
inline LayeredModel ball(double radius) {
  LayeredModel out;
  out.name = "ball";
  out.tets = mesh::ball(radius, 0.4 * radius);
  out.skin = mesh::sphere(radius, 10);
  out.embedding = mesh::embed(out.tets, out.skin.vertices);
  out.proxies = proxy::decompose(out, {.count = 12});
  return out;
}

/// A slab with its faces at z = +-thickness / 2.
inline LayeredModel slab(double width, double thickness, int cells) {
  LayeredModel out;
  out.name = "slab";
  out.tets = mesh::box(Vec3(width, width, thickness), {cells, cells, 1});
  out.skin = mesh::box_surface(Vec3(width, width, thickness), {cells, cells, 1});
  out.embedding = mesh::embed(out.tets, out.skin.vertices);
  out.proxies = proxy::decompose(out, {.count = 12});
  return out;
}

struct Body {
  LayeredModel model;
  contact::NodeSurface surface;
  int u_offset = 0;

  Body(LayeredModel m, dynamics::State& state) : model(std::move(m)) {
    dynamics::BlockSpec nodes;
    nodes.name = model.name;
    nodes.q_size = nodes.u_size = static_cast<int>(model.tets.nodes.size());
    surface.block_id =
        state.insert(nodes, Eigen::Map<const VecX>(model.tets.nodes.data(), model.tets.nodes.size()),
                     VecX::Zero(model.tets.nodes.size()));
    surface.faces = model.skin.faces;
    surface.embedding = model.embedding;
    surface.tets = model.tets.tets;
    u_offset = state.layout().find(surface.block_id)->u_offset;
  }
  std::shared_ptr<proxy::ProxySet> proxies() const { return std::make_shared<proxy::ProxySet>(model); }
  void place(dynamics::State& state, const Vec3& at) const {
    const Points x = model.tets.nodes.colwise() + at;
    state.q().segment(u_offset, x.size()) = Eigen::Map<const VecX>(x.data(), x.size());
  }
  void move(dynamics::State& state, const Vec3& velocity) const {
    const Points v = velocity.replicate(1, model.tets.nodes.cols());
    state.u().segment(u_offset, v.size()) = Eigen::Map<const VecX>(v.data(), v.size());
  }
};

inline constexpr double kRadius = 0.05, kThickness = 0.01;

/// A ball and a slab, for every kind of body pair.
struct Pair {
  dynamics::State state;
  Body thrown;
  Body target;
  TriMesh rigid = mesh::box_surface(Vec3(0.4, 0.4, kThickness), {8, 8, 1});
  std::shared_ptr<contact::TrajectoryFrame> frame = std::make_shared<contact::TrajectoryFrame>();

  Pair() : thrown(ball(kRadius), state), target(slab(0.4, kThickness, 8), state) {
    frame->append(0.0, Pose{}, Twist{});
  }
  std::unique_ptr<contact::SampleSource> source(bool soft, bool pruned, double look_ahead) const {
    contact::ImageOptions options = image_options(64, 1e-3);
    options.look_ahead = look_ahead;
    if (soft && pruned)
      return contact::make_image_source(thrown.surface, thrown.proxies(), target.surface, target.proxies(),
                                        options);
    if (soft) return contact::make_image_source(thrown.surface, target.surface, options);
    if (pruned)
      return contact::make_image_source(thrown.surface, thrown.proxies(), rigid, proxies_of(rigid), 0, frame,
                                        options);
    return contact::make_image_source(thrown.surface, rigid, 0, frame, options);
  }
  std::vector<contact::ContactSample> query(contact::SampleSource& source, const Vec3& at) {
    std::vector<contact::ContactSample> samples;
    thrown.place(state, at);
    source.query(state.view(), samples);
    return samples;
  }
};

}  // namespace ball_and_slab
}  // namespace contact_tests
