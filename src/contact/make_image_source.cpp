#include "contact/make_image_source.h"

#include "contact/image_source.h"
#include "palpate/contact/spec.h"
#include "palpate/core/error.h"

namespace palpate::contact {
namespace {

void check_arguments(const NodeSurface& surface, Eigen::Index other_faces, const ImageOptions& options) {
  if (!ContactRanges::pixels.holds(options.pixels))
    fail("contact in image space: pixels = {} {}", options.pixels, ContactRanges::pixels.demand());
  if (!(options.candidate_gap >= 0.0))
    fail("contact in image space: candidate gap = {} must not be negative", options.candidate_gap);
  if (!(options.look_ahead >= 0.0))
    fail("contact in image space: look-ahead = {} must not be negative", options.look_ahead);
  for (const double shift : {options.shift_u, options.shift_v})
    if (!(shift >= 0.0 && shift < 1.0))
      fail("contact in image space: grid shift = {} must lie in [0, 1)", shift);
  if (surface.faces.cols() == 0 || other_faces == 0)
    fail("contact in image space needs two surfaces with faces, got {} and {}", surface.faces.cols(),
         other_faces);
}

void check_arguments(const NodeSurface& surface, const TriMesh& rigid, const ImageOptions& options) {
  check_arguments(surface, rigid.faces.cols(), options);
  for (Eigen::Index f = 0; f < rigid.faces.cols(); ++f)
    PALPATE_CHECK(rigid.faces.col(f).minCoeff() >= 0 && rigid.faces.col(f).maxCoeff() < rigid.vertices.cols(),
                  "rigid surface: face {} has a vertex index out of range", f);
}

void check_proxies(const Faces& faces, const std::shared_ptr<proxy::ProxySet>& proxies) {
  PALPATE_CHECK(proxies, "a pruned image source needs proxies on both sides");
  PALPATE_CHECK(proxies->face_count() == faces.cols(), "proxies of {} faces for a surface of {}",
                proxies->face_count(), faces.cols());
}

void check_proxies(const NodeSurface& surface, const std::shared_ptr<proxy::ProxySet>& proxies) {
  PALPATE_CHECK(surface.node_of_vertex.empty(), "a pruned image source needs a skin");
  check_proxies(surface.faces, proxies);
}

}  // namespace

std::unique_ptr<SampleSource> make_image_source(NodeSurface surface, TriMesh rigid, int frame,
                                                std::shared_ptr<MovingFrame> motion,
                                                const ImageOptions& options) {
  check_arguments(surface, rigid, options);
  return make_whole_source(soft_side(std::move(surface)),
                           rigid_side(std::move(rigid), frame, std::move(motion)), options);
}

std::unique_ptr<SampleSource> make_image_source(NodeSurface surface, std::shared_ptr<proxy::ProxySet> proxies,
                                                TriMesh rigid, std::shared_ptr<proxy::ProxySet> proxies_rigid,
                                                int frame, std::shared_ptr<MovingFrame> motion,
                                                const ImageOptions& options) {
  check_arguments(surface, rigid, options);
  check_proxies(surface, proxies);
  check_proxies(rigid.faces, proxies_rigid);
  return make_pruned_source(soft_side(std::move(surface)), std::move(proxies),
                            rigid_side(std::move(rigid), frame, std::move(motion)), std::move(proxies_rigid),
                            options);
}

std::unique_ptr<SampleSource> make_image_source(NodeSurface a, NodeSurface b, const ImageOptions& options) {
  check_arguments(a, b.faces.cols(), options);
  PALPATE_CHECK(a.block_id != b.block_id, "contact between two soft bodies: both sides have block {}",
                a.block_id);
  if (b.block_id < a.block_id) return make_image_source(std::move(b), std::move(a), options);
  return make_whole_source(soft_side(std::move(a)), soft_side(std::move(b)), options);
}

std::unique_ptr<SampleSource> make_image_source(NodeSurface a, std::shared_ptr<proxy::ProxySet> proxies_a,
                                                NodeSurface b, std::shared_ptr<proxy::ProxySet> proxies_b,
                                                const ImageOptions& options) {
  check_arguments(a, b.faces.cols(), options);
  PALPATE_CHECK(a.block_id != b.block_id, "contact between two soft bodies: both sides have block {}",
                a.block_id);
  if (b.block_id < a.block_id)
    return make_image_source(std::move(b), std::move(proxies_b), std::move(a), std::move(proxies_a), options);
  check_proxies(a, proxies_a);
  check_proxies(b, proxies_b);
  return make_pruned_source(soft_side(std::move(a)), std::move(proxies_a), soft_side(std::move(b)),
                            std::move(proxies_b), options);
}

}  // namespace palpate::contact
