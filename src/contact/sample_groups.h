#pragma once
#include <array>
#include <span>
#include <vector>

#include "contact/pressure.h"
#include "contact/sample_math.h"
#include "palpate/contact/contact_force.h"
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/point_stiffness.h"

namespace palpate::contact {

/// Samples without friction that hang on the same nodes on side a, on the same nodes or the same frame on
/// side b, and share a normal, one after the other.
///
/// Thousands of samples share few nodes.  Without friction each force is p A n and each stiffness a multiple
/// of n n^T, so what a group adds to forces and matrices are sums of numbers over its samples, times n or
/// n n^T; only these sums meet nodes and frames (sample_groups.cpp).
class SampleGroups {
 public:
  /// Samples of one pair, appended.
  /// @pre side a is of nodes
  void append(std::span<const ContactSample> samples, const PressureLaw& law);
  void clear();

  /// @param frame_row  first of the six rows of a frame in f, by its index; -1: it has none
  /// @param on_a  by pair (ContactSample::source): its resultant on side a is added, about the world's origin
  void add_force(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                 const std::vector<int>& frame_row, VecX& f, std::vector<Wrench>* on_a = nullptr);
  void add_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames, double k_scale,
                   double d_scale, dynamics::BorderedMatrix& A);
  /// k_scale K + d_scale D on nodes, of frames that are not in the State.
  void add_stiffness(const dynamics::StateView& state, const std::vector<FrameState>& frames, double k_scale,
                     double d_scale, dynamics::PointStiffness& C);
  void apply_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames, double k_scale,
                     double d_scale, const VecX& x, VecX& y);
  void linearise(const dynamics::StateView& state, const std::vector<FrameState>& frames, int frame,
                 FrameLinearisation& out);

 private:
  static constexpr int kNodes = 4;
  struct Group {
    int first = 0, last = 0;  ///< samples
    int pair = 0;
    int frame = -1;  ///< of side b; -1: nodes
    int count_a = 0, count_b = 0;
    std::array<int, kNodes> a{}, b{};
    Vec3 normal = Vec3::Zero();
    PressureLaw law;
  };
  struct Sample {
    Eigen::Vector4d a;  ///< weights of a's nodes
    Eigen::Vector4d b;  ///< of b's nodes; or x, y, z in the frame's axes [m], and 0
    double area;        ///< [m^2]
    double shift;       ///< what the gap has beside nodes and frame [m]
  };
  /// Of one sample: A p, -A dp/dgap, -A dp/drate.
  struct Response {
    double force, k, d;
  };

  bool belongs(const Group& group, const ContactSample& sample) const;
  int group_of(const ContactSample& sample, const PressureLaw& law, std::size_t first_of_run);
  void fill(std::span<const ContactSample> samples, std::size_t first_group);
  /// visit(sample, response) of those that press.
  template <class Visit>
  void for_each_pressed(const Group& group, const dynamics::StateView& state,
                        const std::vector<FrameState>& frames, Visit visit) const;
  std::vector<Group> groups_;
  std::vector<Sample> samples_;               ///< by group
  std::vector<int> table_, group_of_sample_;  // scratch of append
};

}  // namespace palpate::contact
