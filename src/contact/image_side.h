#pragma once
#include <memory>

#include "contact/surface_state.h"
#include "palpate/contact/frame.h"
#include "palpate/proxy/proxy_set.h"

namespace palpate::contact {

/// Velocities of a surface: all of its points' lie within `spread` of `mean` [m/s].
struct SurfaceMotion {
  Vec3 mean = Vec3::Zero();
  double spread = 0.0;
};

/// One of the two surfaces of an image: a soft body's, or a rigid one in a frame.
class ImageSide {
 public:
  virtual ~ImageSide() = default;
  virtual void update(const dynamics::StateView& state) = 0;
  virtual SurfaceMotion motion(const dynamics::StateView& state) const = 0;  ///< @pre updated
  virtual const Faces& faces() const = 0;
  virtual const Points& positions() = 0;                    ///< of all vertices [m], world
  virtual Vec3 vertex(int vertex) const = 0;                ///< of one
  virtual void update(proxy::ProxySet& proxies) const = 0;  ///< proxies of this surface, as it stands now
  /// A point of a face as a side of a sample with this normal, by its corners' weights and where that is.
  virtual SurfacePoint point(int face, const Vec3& weights, const Vec3& world, const Vec3& normal) const = 0;
  /// What couples nodes of this side alone; null of a rigid one.
  virtual const SurfaceState* soft() const { return nullptr; }
};

std::unique_ptr<ImageSide> soft_side(NodeSurface surface);
std::unique_ptr<ImageSide> rigid_side(TriMesh surface, int frame, std::shared_ptr<MovingFrame> motion);

}  // namespace palpate::contact
