#pragma once
#include <vector>

#include "contact/reduced_contact_model.h"
#include "contact/tangent.h"
#include "palpate/contact/frame_linearisation.h"
#include "palpate/contact/pressure.h"
#include "palpate/contact/tie.h"
#include "palpate/core/archive.h"
#include "palpate/dynamics/point_stiffness.h"
#include "palpate/dynamics/sparse_border.h"

namespace palpate::contact {

/// Point of a body held by a frame (grasp.cpp).
struct Bond {
  /// `pair` of a Tie, which carries no contact pressure and is never released.
  static constexpr int kTied = -1;
  SurfacePoint held;  ///< Held point, on nodes.
  int frame = 0;      ///< Holding frame.
  /// Attachment point and outward unit normal of the body, in the frame's axes; zero normal for a Tie.
  Vec3 anchor, normal;
  double stiffness, damping;  ///< Spring and damper [N/m, N s/m].
  double area;                ///< Area [m^2]; 1 for a Tie.
  int pair;
  bool frame_is_a;  ///< True: the frame is side a of the pair.
};

/// Force of a bond at a state, and its derivatives with respect to the relative motion at the held point.
struct BondForce {
  Vec3 elastic, force;         ///< Force on the frame, at the held point, without and with damping [N].
  Vec3 arm;                    ///< Vector from the frame's origin to the held point [m].
  Mat3 K, D;                   ///< Symmetric, positive semi-definite [N/m, N s/m].
  double energy, dissipation;  ///< Energy [J], dissipated power [W].
};
/// Computes the force of a bond.
/// @param stretch  u, from the held point to its attachment point [m]  @param normal  n, or zero for a Tie
/// @param arm  from the frame's origin to the held point [m]
/// @param relative  velocity of the frame's material at the held point relative to the body [m/s]
BondForce bond_force(const Vec3& stretch, const Vec3& normal, const Vec3& arm, const Vec3& relative,
                     double stiffness, double damping);

/// Returns the part of -dF of a bond in addition to Z^T K Z, Z = [-[r]x, I]: see grasp.cpp. Rows and columns
/// angular first.
inline Mat6 turning_part(const Vec3& elastic, const Vec3& arm) {
  const Mat3 F = cross_matrix(elastic);
  Mat6 out = Mat6::Zero();
  out.topLeftCorner<3, 3>() = cross_matrix(arm.cross(elastic)) + F * cross_matrix(arm);
  out.topRightCorner<3, 3>() = -F;
  out.bottomLeftCorner<3, 3>() = F;
  return out;
}

/// All bonds of a contact. @pre for all methods: `frames` are evaluated at the given state
class Bonds {
 public:
  bool empty() const { return bonds_.empty(); }
  /// Returns the number of held points, ties excluded, as in area().
  int count() const;
  int count_of(int frame) const;  ///< Held points of one frame, ties excluded.
  void archive(Archive& a);
  /// Returns the held area [m^2].
  double area() const;
  /// Holds the samples that press on a frame, each at its present position. @return their number
  int take(const std::vector<ContactSample>& samples, int frame, const std::vector<PressureLaw>& laws,
           const dynamics::StateView& state, const std::vector<FrameState>& frames);
  /// Releases the points held by a frame.
  void let_go(int frame);
  void tie(int frame, const std::vector<Tie>& ties);  ///< Adds ties. @pre nothing is held

  /// Adds the forces of all bonds.
  /// @param rows  offset of each frame's six velocities in f, -1: none
  void add_force(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                 const std::vector<int>& rows, VecX& f) const;
  /// Adds the resultants of held points per pair.
  /// @param on_a  one entry per pair: moment about the world's origin, and force, on its side a
  void add_resultants(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                      std::vector<Wrench>& on_a) const;
  void add_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames, double k_scale,
                   double d_scale, dynamics::BorderedMatrix& A) const;
  void apply_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames, double k_scale,
                     double d_scale, const VecX& x, VecX& y) const;
  /// Adds the tangent to a PointStiffness and, for frames in the State, to a SparseBorder.
  void add_points(const dynamics::StateView& state, const std::vector<FrameState>& frames, double k_scale,
                  double d_scale, dynamics::PointStiffness& C, dynamics::SparseBorder& border) const;
  double energy(const dynamics::StateView& state, const std::vector<FrameState>& frames) const;
  double dissipation(const dynamics::StateView& state, const std::vector<FrameState>& frames) const;
  Wrench wrench(const dynamics::StateView& state, const std::vector<FrameState>& frames, int frame) const;
  void linearise(const dynamics::StateView& state, const std::vector<FrameState>& frames, int frame,
                 FrameLinearisation& out) const;
  void append_reduced_samples(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                              int frame, std::vector<ReducedSample>& out,
                              std::vector<ReducedTangent>* tangents) const;

 private:
  BondForce force(const Bond& bond, const dynamics::StateView& state,
                  const std::vector<FrameState>& frames) const;

  std::vector<Bond> bonds_;
};

}  // namespace palpate::contact
