#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "contact/surface_state.h"
#include "palpate/contact/frame.h"
#include "palpate/proxy/proxy_set.h"

namespace palpate::contact {

/// One of the two surfaces of an image: a soft body's, or a rigid one in a frame.
class ImageSide {
 public:
  ImageSide();
  virtual ~ImageSide() = default;
  std::uint64_t number() const { return number_; }  ///< no other side of this process has it
  virtual void update(const dynamics::StateView& state) = 0;
  virtual proxy::ProxyMotion motion(const dynamics::StateView& state) const = 0;  ///< @pre updated
  virtual const Faces& faces() const = 0;
  virtual const Points& positions() = 0;                    ///< of all vertices [m], world
  virtual Vec3 vertex(int vertex) const = 0;                ///< of one
  virtual void update(proxy::ProxySet& proxies) const = 0;  ///< proxies of this surface, as it stands now
  /// How they move: with the velocities of the state.
  virtual void set_motion(proxy::ProxySet& proxies, const dynamics::StateView& state) const = 0;

  // The way since the surface was last kept.
  virtual void keep() = 0;  ///< as it is now
  virtual proxy::ProxyMotion way() = 0;
  virtual void set_way(proxy::ProxySet& proxies) = 0;  ///< as their motion
  virtual Vec3 kept_vertex(int vertex) const = 0;
  /// The frame that a rigid surface is in, now and when it was kept; of a soft one the world's.
  virtual Pose frame() const { return {}; }
  virtual Pose kept_frame() const { return {}; }
  /// Returns the carrier of this number (SurfaceState counts them).
  virtual Carrier carrier(int number, const ContactAxes& axes) const = 0;  ///< @pre updated
  /// The point of a face with these weights of its corners, at x, on what carries it now.
  /// @param normal  along which a carrier may miss it  @pre updated
  virtual CarriedPoint carried(int face, const Vec3& weights, const Vec3& x, const Vec3& normal) const = 0;
  /// The point at x on one carrier.  @param number  as of carrier()
  CarriedPoint carried_by(int number, const Vec3& x, const Vec3& normal) const {
    const ContactAxes axes(x, normal);
    const Carrier by = carrier(number, axes);
    return {point_of(by, axes.in_axes(x) - by.at, axes.normal()), number};
  }

  /// For a device that has surfaces in memory of its own.  Each vertex is a mean of some of these points: a
  /// body's nodes, or the vertices themselves.
  virtual const Points& points() const = 0;        ///< [m]; of a soft side as they are now
  virtual Pose points_pose() const { return {}; }  ///< of their axes in the world, now
  virtual int block_id() const { return -1; }      ///< whose nodes they are; -1 of a rigid surface
  virtual int vertex_count() const = 0;
  struct Carriers {
    std::array<int, 4> point{};
    std::array<double, 4> weight{1.0, 0.0, 0.0, 0.0};
  };
  virtual Carriers carriers(int vertex) const = 0;
  /// The order that its faces are kept in, so that regions hold long ranges of them.
  void set_face_order(std::vector<int> order) { face_order_ = std::move(order); }
  int face_at(int place) const {
    return face_order_.empty() ? place : face_order_[static_cast<std::size_t>(place)];
  }

  /// What couples nodes of this side alone; null of a rigid one.
  virtual const SurfaceState* soft() const { return nullptr; }

 private:
  std::uint64_t number_;
  std::vector<int> face_order_;
};

std::unique_ptr<ImageSide> soft_side(NodeSurface surface);
std::unique_ptr<ImageSide> rigid_side(TriMesh surface, int frame, std::shared_ptr<MovingFrame> motion);

}  // namespace palpate::contact
