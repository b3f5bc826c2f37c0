#pragma once
#include <memory>

#include "contact/image_options.h"
#include "palpate/contact/sample_source.h"
#include "palpate/contact/side.h"
#include "palpate/mesh/mesh.h"
#include "proxy/proxy_set.h"

namespace palpate::contact {

/// Makes an image-space contact (Galoppo et al. 2007, docs/theory/image-contact.md) with one region whose
/// plane is found by libccd. OpenGL rasterises both surfaces along its normal. Each vertex of the soft skins
/// that the image shows yields one sample for a third of its triangles' projected area (half of that if both
/// bodies are soft); the gap to the triangle that the image shows opposite is computed in double precision.
/// The first query opens the GL context.
/// @throws Error (the first query) where no EGL device can be opened, with the package that provides it
std::unique_ptr<SampleSource> make_image_source(NodeSurface surface, TriMesh rigid, int frame,
                                                std::shared_ptr<MovingFrame> motion,
                                                const ImageOptions& options);

/// Makes an image-space contact with convex proxies of both sides (docs/theory/image-contact.md). Only skin
/// that may be near the other side is evaluated, in regions with separate planes and images, so that bodies
/// that are not a height field as a whole are seen from all sides on which they are touched. Each face of the
/// first skin belongs to at most one region.
/// @param proxies  proxies of `surface`, a skin, with the same faces; may be shared by several sources
/// @param proxies_rigid  proxies of `rigid`, in its frame, from proxy::rigid_proxies; may be shared by
///   several sources
std::unique_ptr<SampleSource> make_image_source(NodeSurface surface, std::shared_ptr<proxy::ProxySet> proxies,
                                                TriMesh rigid, std::shared_ptr<proxy::ProxySet> proxies_rigid,
                                                int frame, std::shared_ptr<MovingFrame> motion,
                                                const ImageOptions& options);

/// Makes an image-space contact of two soft bodies: both points of a sample are interpolated from nodes, so
/// the force acts on both bodies, equal and opposite, and the tangent couples them. The pattern has blocks
/// between the nodes of the two bodies where samples were found, and grows with the contact
/// (pattern_version). Side a of the samples is the body whose block is older, in whichever order they are
/// given: the pixel grid and its normal are bitwise the same.
std::unique_ptr<SampleSource> make_image_source(NodeSurface a, NodeSurface b, const ImageOptions& options);
std::unique_ptr<SampleSource> make_image_source(NodeSurface a, std::shared_ptr<proxy::ProxySet> proxies_a,
                                                NodeSurface b, std::shared_ptr<proxy::ProxySet> proxies_b,
                                                const ImageOptions& options);

}  // namespace palpate::contact
