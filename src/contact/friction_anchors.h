#pragma once
#include <span>
#include <vector>

#include "contact/sample_math.h"
#include "palpate/core/archive.h"

namespace palpate::contact {

/// Deflections of the springs of friction between material points: what sticks stays (derivation in
/// friction_anchors.cpp).
class FrictionAnchors {
 public:
  FrictionAnchors() = default;
  /// @param retardation  tau, the springs' damping over their stiffness [s]  @param v_r  of the law [m/s]
  FrictionAnchors(double retardation, double v_r) : tau_(retardation), longest_(retardation * v_r) {}

  bool on() const { return tau_ > 0.0; }
  /// Moves the anchors of a query's samples to where these are, and sets the samples' deflections.
  /// @param points   number of each sample's material point, ascending; empty: they stand for none
  /// @param frames   at the query's state
  void renew(std::span<ContactSample> samples, std::span<const int> points, const dynamics::StateView& state,
             const std::vector<FrameState>& frames);
  /// Sets the deflections of samples that follow the state.  @pre those of the last renew(), in its order
  void follow(std::span<ContactSample> samples, const dynamics::StateView& state,
              const std::vector<FrameState>& frames) const;
  /// Keeps deflections; what is given back is taken by the next renew(), at the same state.
  void archive(Archive& a);

 private:
  /// A point of a body or frame as material that is carried along.
  struct Carried {
    SurfacePoint point;
    Vec3 local =
        Vec3::Zero();  ///< frames: in the frame's axes; nodes: what is beside the nodes, in their axes
  };
  struct Anchor {
    int point = 0;
    bool is_fresh = true;  ///< its points are those of the last query; else given back without them
    Carried a, b;
    Vec3 deflection = Vec3::Zero();           ///< in the axes of b [m]
    Vec3 deflection_at_query = Vec3::Zero();  ///< in the world's axes [m]
  };
  static Carried carried(const SurfacePoint& point, const dynamics::StateView& state,
                         const std::vector<FrameState>& frames);
  Vec3 deflection(const Anchor& anchor, const Vec3& normal, const dynamics::StateView& state,
                  const std::vector<FrameState>& frames) const;
  Vec3 shortened(const Vec3& u) const;

  double tau_ = 0.0, longest_ = 0.0;
  std::vector<Anchor> anchors_, before_;  ///< in the order of the samples
};

}  // namespace palpate::contact
