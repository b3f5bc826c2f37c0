#pragma once
#include <vector>

#include "contact/pressure.h"
#include "contact/tangent.h"
#include "palpate/contact/touch_model.h"
#include "palpate/core/archive.h"
#include "palpate/dynamics/point_stiffness.h"

namespace palpate::contact {

/// A point of a body that a frame holds (grasp.cpp).
struct Bond {
  static constexpr int kTied = -1;  ///< `pair` of a Tie: nothing presses there, and it is not let go
  SurfacePoint held;                ///< on nodes
  int frame = 0;                    ///< that holds it
  /// in the frame's axes: where it is held, and outward from the body, unit; of a Tie zero
  Vec3 anchor, normal;
  double stiffness, damping;  ///< [N/m, N s/m]
  double area;                ///< [m^2]; of a Tie 1
  int pair;
  bool frame_is_a;  ///< of the pair's sides
};

/// The pull of a bond at its state, and its derivatives by the relative motion at the held point.
struct BondForce {
  Vec3 elastic, force;  ///< on the frame, at the held point, without and with damping [N]
  Vec3 arm;             ///< from the frame's origin to the held point [m]
  Mat3 K, D;            ///< symmetric, positive semi-definite [N/m, N s/m]
  double energy, dissipation;
};
/// @param relative  velocity of the frame's material at the held point from that of the body
BondForce bond_force(const Vec3& stretch, const Vec3& normal, const Vec3& arm, const Vec3& relative,
                     double stiffness, double damping);

/// -dF of a bond beside Z^T K Z, Z = [-[r]x, I]: see grasp.cpp.  Rows and columns angular first.
inline Mat6 turning_part(const Vec3& elastic, const Vec3& arm) {
  const Mat3 F = cross_matrix(elastic);
  Mat6 out = Mat6::Zero();
  out.topLeftCorner<3, 3>() = cross_matrix(arm.cross(elastic)) + F * cross_matrix(arm);
  out.topRightCorner<3, 3>() = -F;
  out.bottomLeftCorner<3, 3>() = F;
  return out;
}

/// All bonds of a contact.  @pre of all methods: `frames` are at the state given
class Bonds {
 public:
  bool empty() const { return bonds_.empty(); }
  /// Of grasps, without ties, as area() is.
  int count() const;
  int count_of(int frame) const;  ///< likewise
  void archive(Archive& a);
  double area() const;
  /// Holds what presses on a frame, each point as it is.
  /// @return how many
  int take(const std::vector<ContactSample>& samples, int frame, const std::vector<PressureLaw>& laws,
           const dynamics::StateView& state, const std::vector<FrameState>& frames);
  void let_go(int frame);
  void tie(int frame, const std::vector<Tie>& ties);  ///< before anything is held

  /// @param rows  of each frame's six velocities in f, -1: none
  void add_force(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                 const std::vector<int>& rows, VecX& f) const;
  /// @param on_a  one entry a pair: moment about the world's origin, and force, on its side a
  void add_resultants(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                      std::vector<Wrench>& on_a) const;
  void add_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames, double k_scale,
                   double d_scale, dynamics::BorderedMatrix& A) const;
  void apply_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames, double k_scale,
                     double d_scale, const VecX& x, VecX& y) const;
  void add_points(const dynamics::StateView& state, const std::vector<FrameState>& frames, double k_scale,
                  double d_scale, dynamics::PointStiffness& C) const;
  double energy(const dynamics::StateView& state, const std::vector<FrameState>& frames) const;
  double dissipation(const dynamics::StateView& state, const std::vector<FrameState>& frames) const;
  Wrench wrench(const dynamics::StateView& state, const std::vector<FrameState>& frames, int frame) const;
  void linearise(const dynamics::StateView& state, const std::vector<FrameState>& frames, int frame,
                 FrameLinearisation& out) const;
  void append_touch_samples(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                            int frame, std::vector<TouchSample>& out,
                            std::vector<TouchTangent>* tangents) const;

 private:
  BondForce force(const Bond& bond, const dynamics::StateView& state,
                  const std::vector<FrameState>& frames) const;

  std::vector<Bond> bonds_;
};

}  // namespace palpate::contact
