#pragma once
#include <array>
#include <memory>
#include <type_traits>
#include <vector>

#include "palpate/contact/sample.h"
#include "palpate/contact/spec.h"
#include "palpate/core/archive.h"
#include "palpate/core/pose.h"
#include "palpate/dynamics/exchange.h"
#include "palpate/dynamics/rigid_body.h"

/// Contact of soft bodies with a rigid tool as the tool's own ticks carry it on between two exchanges.
namespace palpate::contact {

inline Vec3 vec(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

/// The points at which the tool touches or may soon touch, and how the bodies answer there, reduced to a few
/// modes (docs/design.md, 4.5).  The bodies' displacement from where they were at `time`, tau later, is
///     tau v + sum of q_k mode_k,       q'' + D q' + diag(stiffness) q = force + tau force_rate + contact,
/// with q = 0 and q' = 0 at `time`: v is the velocity that nodes had then (of driven ones the mean of the
/// coming period), and modes are orthonormal in the bodies' mass.  Arrays, so that it can be copied whole.
struct TouchModel {
  static constexpr int kMostPoints = 64, kMostModes = 16;
  /// One touching sample, or many that are alike.
  struct Point {
    std::array<double, 3> offset{}, slide{};  ///< on the tool, as SurfacePoint has them [m]
    std::array<double, 3> normal{};           ///< unit, world: pushes the tool; of a held one in its axes
    std::array<double, 3> place{};            ///< on the bodies, at `time` [m]
    std::array<double, 3> velocity{};         ///< v there [m/s]
    /// of friction's spring, the tool's point from the bodies' (src/contact/friction_anchors.cpp) [m]
    std::array<double, 3> deflection{};
    double area = 0.0;  ///< [m^2]; of springs at points, their number
    int pair = 0;       ///< whose law holds: index of the scene's [[contact]]
    /// of one that the tool holds (ContactForce::set_grasp); else 0 [N/m, N s/m]
    double held_stiffness = 0.0, held_damping = 0.0;
    /// 3 x kMostModes by columns: its displacement by q [kg^-1/2]
    std::array<double, 3 * kMostModes> modes{};
  };
  double time = 0.0;                                ///< [s]
  std::array<double, 7> tool{1, 0, 0, 0, 0, 0, 0};  ///< its pose then: qw qx qy qz px py pz
  int points = 0, modes = 0;
  int samples = 0;                                        ///< that pressed at `time`
  std::array<double, kMostModes> stiffness{};             ///< >= 0 [1/s^2]
  std::array<double, kMostModes * kMostModes> damping{};  ///< D, symmetric, >= 0 [1/s]
  std::array<double, kMostModes> force{};                 ///< without the tool's contact [N kg^-1/2]
  std::array<double, kMostModes> force_rate{};            ///< [N kg^-1/2 s^-1]
  /// What points lack of the friction of samples that stick, at rest: on the modes, and on the tool (moment,
  /// force).  It acts in the measure in which the points press as at `time`, at most.
  std::array<double, kMostModes> missing_load{};  ///< [N kg^-1/2]
  std::array<double, 6> missing_wrench{};         ///< [N m, N]
  std::array<Point, kMostPoints> point{};
};
static_assert(std::is_trivially_copyable_v<TouchModel>);

/// One sample of a frame on nodes, seen from the frame.
struct TouchSample {
  Vec3 offset, slide;       ///< on the frame, as SurfacePoint has them
  int count;                ///< of nodes
  std::array<int, 4> node;  ///< of the body
  std::array<double, 4> weight;
  Vec3 normal;           ///< pushes the frame
  Vec3 place, velocity;  ///< on the body [m, m/s]
  double area, gap;      ///< [m^2, m]
  int pair;
  /// area times dp/ddepth [N/m]: of one that presses, or would
  double stiffness;
  Vec3 force;  ///< on the frame [N]
  /// of friction's spring, the frame's point from the body's, and its stiffness [m, N/m]
  Vec3 deflection = Vec3::Zero();
  double friction_stiffness = 0.0;
  /// of one that the frame holds (ContactForce::set_grasp): `offset` is where it is held, `gap` that along
  /// `normal`, which turns with the frame
  bool held = false;
  double damping = 0.0;  ///< of one that is held [N s/m]
};

/// K = -dF/dx_rel and D = -dF/dv_rel of a sample, as step matrices have them; zero where it does not press.
struct TouchTangent {
  Mat3 K, D;  ///< [N/m, N s/m]
};

/// Gathers samples into the points of a model: those that press by themselves, as they are or, where they are
/// more than there is room for, in bunches of near places and like normals, which press with the same force
/// and answer with the same stiffness as their samples together.
/// @param pose   of the tool
/// @param modes  kMostModes x (directions of nodes): what moves each direction, zeros behind the model's
/// modes
/// @param out    points, what they lack, and `tool` are written
void gather_points(const std::vector<TouchSample>& samples, const Pose& pose,
                   const Eigen::Matrix<double, TouchModel::kMostModes, Eigen::Dynamic>& modes,
                   TouchModel& out);

/// Carries a TouchModel on, tick by tick, together with a tool that somebody else integrates.  Takes no
/// memory once made.
class TouchTicks {
 public:
  /// @param contacts  the scene's, whose laws the points have
  explicit TouchTicks(const std::vector<ContactSpec>& contacts);
  ~TouchTicks();
  TouchTicks(TouchTicks&&) noexcept;

  /// Another model: at rest in it at its time.
  void adopt(const TouchModel& model);
  /// The contact at the tick's end, linear about where the tool comes by then with the twist that it has; the
  /// bodies' answer within the tick is in it.
  /// @param t1  end of the tick [s]  @param h  its length [s]  @param tool  at its start
  dynamics::LinearisedContact linearise(double t1, double h, const dynamics::RigidMotion& tool);
  /// Whether a point with friction touches, in the last linearisation.
  bool rubs() const;
  /// Takes the tool's end of the tick, as the last record leads to it, for the next guess of friction.
  /// False: the record's friction is not the law's at that end, and again() gives a better one.
  /// @param tolerance  of its difference from the law's, relative; 0: that of a step (contact/friction.h)
  bool improve(const dynamics::RigidMotion& end, double tolerance = 0.0);
  /// The record of the tick last linearised, with the guess as it is now.
  dynamics::LinearisedContact again();
  /// The tool came there at the end of the tick that was linearised: so do the bodies.
  void follow(const dynamics::RigidMotion& tool);
  /// Points that pressed in the last linearisation.
  int pressing() const;
  /// q' of the modes now [kg^1/2 m/s]
  VecX rates() const;
  /// Between two ticks.
  void archive(Archive& a);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::contact
