#pragma once
#include <array>
#include <memory>
#include <type_traits>
#include <vector>

#include "palpate/contact/sample.h"
#include "palpate/contact/spec.h"
#include "palpate/core/archive.h"
#include "palpate/core/pose.h"
#include "palpate/dynamics/linearised_contact.h"
#include "palpate/dynamics/rigid_body.h"

/// Reduced contact of soft bodies with a rigid tool, advanced by the tool's ticks between two exchanges.
namespace palpate::contact {

/// Returns the array as a vector.
inline Vec3 vec(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

/// Reduced contact model of one tool: the points at which the tool touches or may soon touch, and the
/// response of the bodies there, reduced to a few modes (docs/theory/haptic-loop.md). At the time tau after
/// `time` the bodies are displaced from their positions at `time` by
///     tau v + sum of q_k mode_k,       q'' + D q' + diag(stiffness) q = force + tau force_rate + contact,
/// with q = 0 and q' = 0 at `time`. v is the velocity of the nodes at `time` (for driven nodes the mean over
/// the coming period), and the modes are orthonormal with respect to the mass of the bodies. All members are
/// arrays, so that the model is trivially copyable.
struct ReducedContactModel {
  static constexpr int kMostPoints = 64, kMostModes = 16;
  /// One contact point: a sample, or a cluster of similar samples.
  struct Point {
    std::array<double, 3> offset{}, slide{};  ///< Point on the tool, as in SurfacePoint [m].
    /// Unit normal in world axes, along the force on the tool; for a held point in the tool's axes.
    std::array<double, 3> normal{};
    std::array<double, 3> place{};     ///< Position on the bodies at `time` [m].
    std::array<double, 3> velocity{};  ///< v at the point [m/s].
    /// Deflection of the friction spring, from the bodies' point to the tool's
    /// (src/contact/friction_anchors.cpp) [m].
    std::array<double, 3> deflection{};
    double area = 0.0;  ///< Area [m^2]; for springs per point their number.
    int pair = 0;       ///< Index of the scene's [[contact]] whose law applies.
    /// Spring and damper of a point held by the tool (ContactForce::set_grasp); otherwise 0 [N/m, N s/m].
    double held_stiffness = 0.0, held_damping = 0.0;
    /// Displacement of the point per unit of q, 3 x kMostModes, column-major [kg^-1/2].
    std::array<double, 3 * kMostModes> modes{};
  };
  double time = 0.0;                                ///< Time of the model [s].
  std::array<double, 7> tool{1, 0, 0, 0, 0, 0, 0};  ///< Pose of the tool at `time`: qw qx qy qz px py pz.
  int points = 0, modes = 0;
  int samples = 0;                                        ///< Number of samples under pressure at `time`.
  std::array<double, kMostModes> stiffness{};             ///< Modal stiffness, >= 0 [1/s^2].
  std::array<double, kMostModes * kMostModes> damping{};  ///< D, symmetric positive semi-definite [1/s].
  std::array<double, kMostModes> force{};       ///< Modal force without the tool's contact [N kg^-1/2].
  std::array<double, kMostModes> force_rate{};  ///< Rate of the modal force [N kg^-1/2 s^-1].
  /// Difference between the friction of the sticking samples at rest and that of the points: on the modes,
  /// and on the tool (moment, force). It is scaled by the ratio of the points' pressed volume to that at
  /// `time`, at most 1.
  std::array<double, kMostModes> missing_load{};  ///< Load on the modes [N kg^-1/2].
  std::array<double, 6> missing_wrench{};         ///< Wrench on the tool [N m, N].
  std::array<Point, kMostPoints> point{};
};
static_assert(std::is_trivially_copyable_v<ReducedContactModel>);

/// Sample between a frame and nodes, as seen from the frame.
struct ReducedSample {
  Vec3 offset, slide;            ///< Point on the frame, as in SurfacePoint [m].
  int count;                     ///< Number of nodes.
  std::array<int, 4> node;       ///< Nodes of the body.
  std::array<double, 4> weight;  ///< Weights of the nodes.
  Vec3 normal;                   ///< Unit normal along the force on the frame.
  Vec3 place, velocity;          ///< Position and velocity of the body's point [m, m/s].
  double area, gap;              ///< Area and gap [m^2, m].
  int pair;                      ///< Index of the contact pair.
  /// area times dp/ddepth of the sample, or of a candidate as if it pressed [N/m].
  double stiffness;
  Vec3 force;  ///< Force on the frame [N].
  /// Deflection of the friction spring, from the body's point to the frame's, and its stiffness [m, N/m].
  Vec3 deflection = Vec3::Zero();
  double friction_stiffness = 0.0;
  /// True for a point held by the frame (ContactForce::set_grasp): `offset` is its attachment point, and
  /// `gap` is measured along `normal`, which rotates with the frame.
  bool held = false;
  double damping = 0.0;  ///< Damping of a held point [N s/m].
};

/// K = -dF/dx_rel and D = -dF/dv_rel of a sample, as used in step matrices; zero for a sample without
/// pressure.
struct ReducedTangent {
  Mat3 K, D;  ///< Stiffness and damping [N/m, N s/m].
};

/// Reduces samples to the points of a model. Samples become points individually or, where there is not enough
/// room, in clusters of close positions and similar normals. The points of pressing samples have the same
/// force and the same stiffness as their samples together.
/// @param pose   pose of the tool
/// @param modes  kMostModes x (directions of nodes): displacement of each direction per mode, zero rows
///   beyond the model's modes
/// @param out    receives the points, the missing friction, and `tool`
void gather_points(const std::vector<ReducedSample>& samples, const Pose& pose,
                   const Eigen::Matrix<double, ReducedContactModel::kMostModes, Eigen::Dynamic>& modes,
                   ReducedContactModel& out);

/// Advances a ReducedContactModel tick by tick, together with a tool that is integrated elsewhere. Allocates
/// no memory after construction.
class ReducedContactStepper {
 public:
  /// @param contacts  contacts of the scene; ReducedContactModel::Point::pair refers to their laws
  explicit ReducedContactStepper(const std::vector<ContactSpec>& contacts);
  ~ReducedContactStepper();
  ReducedContactStepper(ReducedContactStepper&&) noexcept;

  /// Adopts a new model, at rest (q = q' = 0) at its time.
  void adopt(const ReducedContactModel& model);
  /// Linearises the contact at the end of a tick about the pose that the tool reaches with its present twist.
  /// The response of the bodies within the tick is included.
  /// @param t1  end of the tick [s]  @param h  its length [s]  @param tool  motion of the tool at its start
  dynamics::LinearisedContact linearise(double t1, double h, const dynamics::RigidMotion& tool);
  /// Returns whether a point with friction was in contact in the last linearisation.
  bool has_friction() const;
  /// Updates the friction guess with the motion of the tool at the tick's end to which the last record leads.
  /// Returns false if the friction of the record differs from the law at that end; relinearise() then returns
  /// an improved record.
  /// @param end  motion of the tool at the tick's end
  /// @param tolerance  accepted relative difference; 0: the default of a step (contact/friction.h)
  bool update_friction(const dynamics::RigidMotion& end, double tolerance = 0.0);
  /// Returns the record of the tick linearised last, with the present guess.
  dynamics::LinearisedContact relinearise();
  /// Advances the reduced bodies to the end of the tick, given the tool motion that the tick produced.
  void follow(const dynamics::RigidMotion& tool);
  /// Returns the number of points under pressure in the last linearisation.
  int pressing() const;
  /// Returns q' of the modes [kg^1/2 m/s].
  VecX rates() const;
  /// Saves or restores the state between two ticks.
  void archive(Archive& a);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::contact
