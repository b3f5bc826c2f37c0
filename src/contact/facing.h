#pragma once
#include <optional>

#include "contact/depth_image.h"
#include "contact/image_side.h"

namespace palpate::contact {

/// Two triangles at a pixel.
struct Facing {
  double u, v, w_a, w_b;      ///< [m]
  Vec3 weights_a, weights_b;  ///< of their corners
  double gap() const { return w_a - w_b; }
};

/// The image said which triangles; the gap is theirs at the pixel's own (u, v), in double.  Nothing where one
/// of them is seen edge-on there.
std::optional<Facing> facing_at(const PixelPair& pair, const ContactCamera& camera, const Patch& a,
                                int face_a, const Patch& b, int face_b);

/// The sample of a pixel; the faces are those of the whole sides.
ContactSample sample_of(const Facing& at, const ImageSide& a, int face_a, const ImageSide& b, int face_b,
                        const ContactCamera& camera, const ContactAxes& axes);

}  // namespace palpate::contact
