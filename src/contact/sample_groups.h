#pragma once
#include <array>
#include <span>
#include <vector>

#include "contact/pressure.h"
#include "contact/sample_cells.h"
#include "contact/sample_math.h"
#include "palpate/contact/contact_force.h"
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/point_stiffness.h"

namespace palpate::contact {

using Vec5 = Eigen::Matrix<double, 5, 1>;

/// From the places (u, v, w_a, w_b, 1) of a cell to the eight numbers y of a sample (group_sums.cpp), and
/// what the gap has beside y.
struct PlaceMap {
  Eigen::Matrix<double, 8, 5> Y = Eigen::Matrix<double, 8, 5>::Zero();
  Vec5 beside = Vec5::Zero();
  PlaceMap(const SampleCells& cells, int cell);
};

/// Samples without friction that hang on the same nodes on side a, on the same nodes or the same frame on
/// side b, and share a normal, one after the other.
///
/// Thousands of samples share few nodes.  Without friction each force is p A n and each stiffness a multiple
/// of n n^T, so what a group adds to forces and matrices are sums of numbers over its samples, times n or
/// n n^T; only these sums meet nodes and frames (group_sums.cpp).
class SampleGroups {
 public:
  /// Samples of one pair, appended.
  /// @pre side a is of nodes
  void append(std::span<const ContactSample> samples, const PressureLaw& law);
  /// Cells of one pair, appended: first <= cell < last; they stay where they are until `clear`.
  void append(const SampleCells& cells, std::size_t first, std::size_t last, const PressureLaw& law);
  void clear();
  std::size_t bytes() const {  ///< of all that is kept
    return groups_.size() * sizeof(Group) + samples_.size() * sizeof(Sample);
  }

  /// @param frame_row  first of the six rows of a frame in f, by its index; -1: it has none
  /// @param on_a  by pair (ContactSample::source): its resultant on side a is added, about the world's origin
  void add_force(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                 const std::vector<int>& frame_row, VecX& f, std::vector<Wrench>* on_a = nullptr) const;
  void add_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames, double k_scale,
                   double d_scale, dynamics::BorderedMatrix& A) const;
  void apply_tangent(const dynamics::StateView& state, const std::vector<FrameState>& frames, double k_scale,
                     double d_scale, const VecX& x, VecX& y) const;
  /// As ContactForce::add_step and add_step_force are: f += force - K shift (- D change), and
  /// k_scale K + d_scale D on nodes, of frames that are not in the State.
  void add_step(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                const std::vector<int>& frame_row, const VecX& shift, double k_scale, double d_scale, VecX& f,
                dynamics::PointStiffness& C) const;
  void add_step_force(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                      const std::vector<int>& frame_row, const VecX& shift, const VecX& change,
                      VecX& f) const;
  void linearise(const dynamics::StateView& state, const std::vector<FrameState>& frames, int frame,
                 FrameLinearisation& out) const;
  /// On one frame, about its origin.
  Wrench wrench(const dynamics::StateView& state, const std::vector<FrameState>& frames, int frame) const;
  double energy(const dynamics::StateView& state, const std::vector<FrameState>& frames) const;       ///< [J]
  double dissipation(const dynamics::StateView& state, const std::vector<FrameState>& frames) const;  ///< [W]

 private:
  struct Group {
    int first = 0, last = 0;  ///< of `samples_`, or of the cells' places
    int cell = -1;            ///< of the cells; -1: samples of its own
    int pair = 0;
    int frame = -1;  ///< of side b; -1: nodes
    int count_a = 0, count_b = 0;
    std::array<int, 4> a{}, b{};
    Vec3 normal = Vec3::Zero();
    int law = 0;  ///< of `laws_`
  };
  using Vec8 = Eigen::Matrix<double, 8, 1>;
  using Mat8 = Eigen::Matrix<double, 8, 8>;
  struct Sample {
    Vec8 y;        ///< group_sums.cpp
    double area;   ///< [m^2]
    double shift;  ///< what the gap has beside nodes and frame [m]
  };
  /// By which y gives the gap and its rate.
  struct Motion {
    Vec8 x = Vec8::Zero(), v = Vec8::Zero();
  };
  /// Over a group's samples: F, K and D.
  struct Sums {
    Vec8 f;
    Mat8 k, d;
    int pressed = 0;  ///< samples with pressure
  };

  bool belongs(const Group& group, const ContactSample& sample) const;
  int group_of(const ContactSample& sample, std::size_t first_of_run);
  void fill(std::span<const ContactSample> samples, std::size_t first_group);

  const PressureLaw& law_of(const Group& group) const { return laws_[static_cast<std::size_t>(group.law)]; }
  Motion motion(const Group& group, const dynamics::StateView& state,
                const std::vector<FrameState>& frames) const;
  /// visit(y, gap, rate, area), or with the place of a cell's sample instead of y.
  template <class Visit>
  void for_each_sample(const Group& group, const Motion& motion, Visit visit) const;
  template <class Visit>
  void for_each_place(const Group& group, const PlaceMap& map, const Motion& motion, Visit visit) const;
  /// visit(group, gap, rate, area) of all samples that touch.
  template <class Visit>
  void for_each_gap(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                    Visit visit) const;
  template <class Visit>
  static void for_each_node(const Group& group, Visit visit);
  Vec8 sum_forces(const Group& group, const Motion& motion) const;
  /// False, and nothing in `out`, where no sample has a gap < 0.
  bool sum(const Group& group, const Motion& motion, Sums& out) const;
  static void add_force(const Group& group, const Vec8& f, const std::vector<FrameState>& frames,
                        const std::vector<int>& frame_row, VecX& out);
  static void apply(const Group& group, const Sums& sums, const std::vector<FrameState>& frames,
                    double k_scale, double d_scale, const VecX& x, VecX& y);
  static void add_stiffness(const Group& group, const Sums& sums, double k_scale, double d_scale,
                            dynamics::PointStiffness& C);
  static Vec6 on_frame(const Group& group, const Vec8& f, const FrameState& frame);  ///< moment, force

  std::vector<Group> groups_;
  std::vector<Sample> samples_;  ///< by group
  std::vector<PressureLaw> laws_;
  const SampleCells* cells_ = nullptr;
  std::vector<int> table_, group_of_sample_;  // scratch of append
};

}  // namespace palpate::contact
