#pragma once
#include <span>
#include <vector>

#include "contact/sample_math.h"
#include "palpate/core/archive.h"

namespace palpate::contact {

/// Deflections of the friction springs between material points, which keep sticking contacts in place
/// (derivation in friction_anchors.cpp).
class FrictionAnchors {
 public:
  FrictionAnchors() = default;
  /// @param retardation  tau, the springs' damping over their stiffness [s]  @param v_r  regularisation
  ///   speed of the law [m/s]
  FrictionAnchors(double retardation, double v_r) : tau_(retardation), longest_(retardation * v_r) {}

  /// Returns whether there are friction springs.
  bool on() const { return tau_ > 0.0; }
  /// Moves the anchors to the samples of a new query, and sets the samples' deflections.
  /// @param points   index of each sample's material point, ascending; empty: samples represent none
  /// @param frames   frames at the query's state
  void renew(std::span<ContactSample> samples, std::span<const int> points, const dynamics::StateView& state,
             const std::vector<FrameState>& frames);
  /// Sets the deflections of samples that follow the state. @pre the samples of the last renew(), in its
  /// order
  void follow(std::span<ContactSample> samples, const dynamics::StateView& state,
              const std::vector<FrameState>& frames) const;
  /// Saves or restores deflections; restored ones are used by the next renew(), at the same state.
  void archive(Archive& a);

 private:
  /// Point of a body or frame as material that moves with its carrier.
  struct Carried {
    SurfacePoint point;
    /// Frame: point in the frame's axes. Nodes: offset from the weighted nodes, in the axes of the nodes'
    /// triangle.
    Vec3 local = Vec3::Zero();
  };
  struct Anchor {
    int point = 0;
    bool is_fresh = true;  ///< True: the points are those of the last query. False: restored without points.
    Carried a, b;
    Vec3 deflection = Vec3::Zero();           ///< In the axes of b [m].
    Vec3 deflection_at_query = Vec3::Zero();  ///< In world axes [m].
  };
  static Carried carried(const SurfacePoint& point, const dynamics::StateView& state,
                         const std::vector<FrameState>& frames);
  Vec3 deflection(const Anchor& anchor, const Vec3& normal, const dynamics::StateView& state,
                  const std::vector<FrameState>& frames) const;
  Vec3 shortened(const Vec3& u) const;

  double tau_ = 0.0, longest_ = 0.0;
  std::vector<Anchor> anchors_, before_;  ///< In the order of the samples.
};

}  // namespace palpate::contact
