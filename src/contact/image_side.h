#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "contact/surface_state.h"
#include "palpate/contact/frame.h"
#include "proxy/proxy_set.h"

namespace palpate::contact {

/// One of the two surfaces of an image: the surface of a soft body, or a rigid one in a frame.
class ImageSide {
 public:
  ImageSide();
  virtual ~ImageSide() = default;
  std::uint64_t number() const { return number_; }  ///< Identifier, unique in this process.
  /// Evaluates the surface at a state.
  virtual void update(const dynamics::StateView& state) = 0;
  /// Mean velocity and spread of the surface. @pre updated
  virtual proxy::ProxyMotion motion(const dynamics::StateView& state) const = 0;
  virtual const Faces& faces() const = 0;
  virtual const Points& positions() = 0;      ///< World positions of all vertices [m].
  virtual Vec3 vertex(int vertex) const = 0;  ///< World position of one vertex [m].
  /// Updates proxies of this surface to its present configuration.
  virtual void update(proxy::ProxySet& proxies) const = 0;
  /// Sets the motion of the proxies to the velocities of the state.
  virtual void set_motion(proxy::ProxySet& proxies, const dynamics::StateView& state) const = 0;

  // Displacement since the surface was last kept.
  virtual void keep() = 0;               ///< Keeps the present configuration.
  virtual proxy::ProxyMotion way() = 0;  ///< Mean displacement and spread since keep() [m].
  virtual void set_motion(
      proxy::ProxySet& proxies) = 0;               ///< Sets this displacement as the motion of proxies.
  virtual Vec3 kept_vertex(int vertex) const = 0;  ///< Position of a vertex when kept [m].
  /// Returns the frame of a rigid surface, now and when it was kept; for a soft surface the world frame.
  virtual Pose frame() const { return {}; }
  virtual Pose kept_frame() const { return {}; }
  /// Returns the carrier with this number (numbered by SurfaceState).
  virtual Carrier carrier(int number, const ContactAxes& axes) const = 0;  ///< @pre updated
  /// Returns the point of a face with these barycentric weights, at x, on its present carrier.
  /// @param normal  direction along which the carrier may miss x  @pre updated
  virtual CarriedPoint carried(int face, const Vec3& weights, const Vec3& x, const Vec3& normal) const = 0;
  /// Returns the point at x on one carrier. @param number  as in carrier()
  CarriedPoint carried_by(int number, const Vec3& x, const Vec3& normal) const {
    const ContactAxes axes(x, normal);
    const Carrier by = carrier(number, axes);
    return {point_of(by, axes.in_axes(x) - by.at, axes.normal()), number};
  }

  /// The following functions serve devices with separate memory. Each vertex is a weighted mean of some of
  /// these points: a body's nodes, or the vertices themselves.
  virtual const Points& points() const = 0;        ///< Points [m]; for a soft side at the present state.
  virtual Pose points_pose() const { return {}; }  ///< Pose of the points' axes in the world, now.
  virtual int block_id() const { return -1; }      ///< Block of the nodes; -1 for a rigid surface.
  virtual int vertex_count() const = 0;
  /// Points and weights of one vertex.
  struct Carriers {
    std::array<int, 4> point{};
    std::array<double, 4> weight{1.0, 0.0, 0.0, 0.0};
  };
  virtual Carriers carriers(int vertex) const = 0;
  /// Sets the order in which the faces are stored, so that regions contain long contiguous ranges.
  void set_face_order(std::vector<int> order) { face_order_ = std::move(order); }
  int face_at(int place) const {
    return face_order_.empty() ? place : face_order_[static_cast<std::size_t>(place)];
  }

  /// Returns the state of a soft surface, which couples nodes of this side; null for a rigid one.
  virtual const SurfaceState* soft() const { return nullptr; }

 private:
  std::uint64_t number_;
  std::vector<int> face_order_;
};

std::unique_ptr<ImageSide> soft_side(NodeSurface surface);
std::unique_ptr<ImageSide> rigid_side(TriMesh surface, int frame, std::shared_ptr<MovingFrame> motion);

}  // namespace palpate::contact
