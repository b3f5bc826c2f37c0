#pragma once
#include "grid_proxies.h"
#include "images.h"
#include "surfaces.h"

namespace contact_tests {

/// A ball of tetrahedra, and above it a second one, rotated, larger and pressed into it; both with fine skins
/// and velocities.
struct TwoBalls {
  struct Body {
    LayeredModel model;
    contact::NodeSurface surface;
    std::shared_ptr<proxy::ProxySet> proxies;
  };
  dynamics::State state;
  Body a, b;

  struct Skins {
    unsigned order = 0;  ///< order of the triangles: 0 as generated, else the seed of a shuffle
    int subdivisions = 12;
    double bumps = 0.0;  ///< height of the bumps
    int cells = 3;       ///< proxy grid cells along an edge
  };
  TwoBalls() : TwoBalls(Skins{}) {}
  explicit TwoBalls(const Skins& skins)
      : a(body(Pose{}, 1.0, skins, skins.order)),
        b(body({quaternion_of(Vec3(0.4, -0.7, 0.2)), Vec3(0.35, -0.2, -1.95)}, 1.2, skins, 2 * skins.order)) {
  }

  Body body(const Pose& pose, double scale, const Skins& skins, unsigned order) {
    Body out;
    out.model.tets = mesh::ball(1.0, 0.45);
    out.model.skin = mesh::sphere(1.0, skins.subdivisions);
    for (auto x : out.model.skin.vertices.colwise()) x *= 1.0 + skins.bumps * (9.0 * x).array().sin().prod();
    std::mt19937 random(order);
    for (Eigen::Index f = out.model.skin.faces.cols() - 1; order > 0 && f > 0; --f)
      out.model.skin.faces.col(f).swap(out.model.skin.faces.col(random() % static_cast<unsigned>(f + 1)));
    for (Points* points : {&out.model.tets.nodes, &out.model.skin.vertices})
      for (auto x : points->colwise()) x = pose * Vec3(scale * x);
    out.surface.faces = out.model.skin.faces;
    out.surface.embedding = mesh::embed(out.model.tets, out.model.skin.vertices);
    out.surface.tets = out.model.tets.tets;
    out.proxies = proxies_of(out.model.tets, out.model.skin, out.surface.embedding, skins.cells);
    dynamics::BlockSpec nodes;
    nodes.name = "ball";
    nodes.q_size = nodes.u_size = static_cast<int>(out.model.tets.nodes.size());
    VecX speeds(nodes.u_size);
    for (Eigen::Index i = 0; i < speeds.size(); ++i)
      speeds[i] = 0.1 * std::sin(1.0 + static_cast<double>(i) + scale);
    out.surface.block_id =
        state.insert(nodes, Eigen::Map<const VecX>(out.model.tets.nodes.data(), nodes.q_size), speeds);
    return out;
  }

  int pixels = 96;
  contact::ImageOptions options() const { return image_options(pixels, 0.02); }
  std::unique_ptr<contact::SampleSource> swapped() const {
    return contact::make_image_source(b.surface, b.proxies, a.surface, a.proxies, options());
  }
  std::unique_ptr<contact::SampleSource> source(bool pruned) const { return source(pruned, options()); }
  std::unique_ptr<contact::SampleSource> source(bool pruned, const contact::ImageOptions& requested) const {
    return pruned ? contact::make_image_source(a.surface, a.proxies, b.surface, b.proxies, requested)
                  : contact::make_image_source(a.surface, b.surface, requested);
  }
  int nodes_of_a() const { return static_cast<int>(a.model.tets.nodes.cols()); }
};

}  // namespace contact_tests
