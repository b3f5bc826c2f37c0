#include <algorithm>
#include <cmath>
#include <random>

#include "a_reference_image.h"
#include "b_bodies.h"
#include "cases.h"
#include "images.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"

// Problem: the depth field is a property of two surfaces and must not depend on the order in which their
// triangles are listed, nor on which body is named first.
//
// Exact answer: identical fields. (a) The pixels of one pair are compared bitwise, as listed by the
// generators and with the triangles of both bodies shuffled. Where two triangles meet at a pixel centre the
// image may select either; the resulting depths are compared, not the selected triangles. (b) Swapping the
// names of two soft bodies changes nothing, as the order of the sides follows the positions of the bodies in
// the State. Samples are compared bitwise.
//
// (c) Swapping the positions of the bodies in the State reverses the normal, mirrors the image and starts the
// pixel grid at another corner of the window. A vertex at the border of the overlap may then lie in a pixel
// that shows the other body, or in one that does not, so the overlap volumes agree only to the limit 1e-4.

namespace palpate::validation {
namespace {

constexpr double kDistance = 1.5;

struct Mesh {
  TriMesh a, b;
};

Mesh spheres() {
  Mesh out{mesh::sphere(1.0, 24), mesh::sphere(0.8, 20)};
  out.a.vertices =
      (Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix() * out.a.vertices).eval();
  out.a.vertices.colwise() += Vec3(0.05, 0.02, kDistance);
  return out;
}

TriMesh shuffled(TriMesh mesh, unsigned seed) {
  std::mt19937 random(seed);
  for (Eigen::Index i = mesh.faces.cols() - 1; i > 0; --i) {
    const auto j = static_cast<Eigen::Index>(random() % static_cast<unsigned>(i + 1));
    mesh.faces.col(i).swap(mesh.faces.col(j));
  }
  return mesh;
}

contact::ImageOptions image_options() {
  contact::ImageOptions options;
  options.pixels = 200;
  options.candidate_gap = 0.01;
  return options;
}

struct Pixel {
  Vec3 at;
  double gap;
};

/// Depth field of a pair. Fault "first-come": each depth is changed by 1e-9 depending on the triangle listed
/// first.
std::vector<Pixel> field(const Mesh& mesh, const std::string& fault) {
  SurfaceBody body(mesh.a);
  const auto source =
      contact::make_image_source(body.surface, mesh.b, 0, contact::fixed_frame(), image_options());
  std::vector<Pixel> out;
  for (const auto& s : pixels_of(*source, body.state.view())) out.push_back({s.b.offset, s.gap});
  if (fault == "first-come")
    for (Pixel& pixel : out) pixel.gap += 1e-9 * static_cast<double>(mesh.b.faces(0, 0) % 7);
  return out;
}

struct TwoSoft {
  dynamics::State state;
  contact::NodeSurface a, b;
};

TwoSoft two_soft(const TriMesh& first, const TriMesh& second) {
  TwoSoft out;
  dynamics::State& state = out.state;
  const auto add = [&](const TriMesh& mesh) {
    dynamics::BlockSpec nodes;
    nodes.name = "surface";
    nodes.q_size = nodes.u_size = static_cast<int>(mesh.vertices.size());
    contact::NodeSurface surface;
    surface.block_id = state.insert(nodes, mesh.vertices.reshaped(), VecX::Zero(nodes.u_size));
    for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i)
      surface.node_of_vertex.push_back(static_cast<int>(i));
    surface.faces = mesh.faces;
    return surface;
  };
  out.a = add(first);
  out.b = add(second);
  return out;
}

/// Samples of two soft bodies. Fault "as-named": the samples are ordered as the sides are named.
std::vector<contact::ContactSample> samples_of_two_soft(const TwoSoft& bodies, bool b_first,
                                                        const std::string& fault) {
  const contact::ImageOptions options = image_options();
  std::vector<contact::ContactSample> samples;
  (b_first ? contact::make_image_source(bodies.b, bodies.a, options)
           : contact::make_image_source(bodies.a, bodies.b, options))
      ->query(bodies.state.view(), samples);
  if (b_first && fault == "as-named") std::reverse(samples.begin(), samples.end());
  return samples;
}

bool is_same(const contact::SurfacePoint& p, const contact::SurfacePoint& q) {
  return p.frame == q.frame && p.count == q.count && p.node == q.node && p.weight == q.weight &&
         p.offset == q.offset;
}

bool is_same(const contact::ContactSample& s, const contact::ContactSample& t) {
  return is_same(s.a, t.a) && is_same(s.b, t.b) && s.normal == t.normal && s.area == t.area && s.gap == t.gap;
}

Measurement sides_swapped(const TwoSoft& bodies, const std::string& fault) {
  const auto plain = samples_of_two_soft(bodies, false, fault),
             swapped = samples_of_two_soft(bodies, true, fault);
  long different = std::abs(static_cast<long>(plain.size()) - static_cast<long>(swapped.size()));
  for (std::size_t i = 0; i < std::min(plain.size(), swapped.size()); ++i)
    different += !is_same(plain[i], swapped[i]);
  return {.quantity = "samples that differ with the sides swapped [count]",
          .computed = static_cast<double>(different),
          .error = plain.size() > 100 ? static_cast<double>(different) : std::nan(""),
          .bar = 0.0,
          .note = fmt::format("{} samples, bitwise: nodes, weights, normal, area and gap", plain.size())};
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  const Mesh mesh = spheres();
  if (images_work()) {
    const std::vector<Pixel> plain = field(mesh, fault);
    int different = 0;
    double largest = 0.0;
    for (const unsigned seed : {1u, 2u, 3u, 4u}) {
      const std::vector<Pixel> other = field({shuffled(mesh.a, seed), shuffled(mesh.b, 10 + seed)}, fault);
      different +=
          static_cast<int>(std::abs(static_cast<long>(other.size()) - static_cast<long>(plain.size())));
      for (std::size_t i = 0; i < std::min(plain.size(), other.size()); ++i) {
        different += plain[i].gap != other[i].gap || plain[i].at != other[i].at;
        largest = std::max(largest, std::abs(plain[i].gap - other[i].gap));
      }
    }
    out.push_back({.quantity = "pixels that differ with the triangles shuffled [count]",
                   .computed = static_cast<double>(different),
                   .error = plain.size() > 10000 ? static_cast<double>(different) : std::nan(""),
                   .bar = 0.0,
                   .note = fmt::format("{} pixels, 4 orders, bitwise; largest difference {:.1e} R",
                                       plain.size(), largest)});
    const TwoSoft bodies = two_soft(mesh.a, mesh.b), exchanged = two_soft(mesh.b, mesh.a);
    out.push_back(sides_swapped(bodies, fault));
    const double ab = overlap_volume(samples_of_two_soft(bodies, false, fault)),
                 ba = overlap_volume(samples_of_two_soft(exchanged, false, fault));
    out.push_back({.quantity = "overlap volume by vertices with the order of the bodies swapped [m^3]",
                   .computed = ba,
                   .exact = ab,
                   .error = std::abs(ba / ab - 1.0),
                   .bar = 1e-4,
                   .note = "the pixel grid differs"});
  }
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase order_independence() {
  return {
      .name = "order-independence",
      .section = "A",
      .summary = "bitwise equal pixels for shuffled triangles, and bitwise equal samples for swapped sides",
      .why =
          "a result that depends on how a mesh file lists its triangles cannot be reproduced, and two "
          "bodies must agree on how far they overlap",
      .quick = true,
      .run = run,
      .faults = {{"first-come", "shuffled"}, {"as-named", "sides swapped"}}};
}

}  // namespace palpate::validation
