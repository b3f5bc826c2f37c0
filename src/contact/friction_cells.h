#pragma once
#include <vector>

#include "contact/friction.h"
#include "contact/pressure.h"
#include "contact/sample_cells.h"
#include "contact/sample_groups.h"
#include "contact/sample_math.h"
#include "palpate/contact/contact_force.h"
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/point_stiffness.h"

namespace palpate::contact {

/// Cells with friction, as SampleGroups has those without: side a of nodes, side b of nodes or of a frame
/// that is not in the State.
///
/// In a step whose friction is that of its end (friction.cpp) every sample has a guess of its own, in two
/// directions across its cell's normal.  How it moves is affine in its place, and what leaves a cell are sums
/// over its samples, made once a guess (friction_cells.cpp).
class FrictionCells {
 public:
  void clear();
  /// Appends the cells first <= cell < last, all of one pair.  Keeps references to them until `clear`.
  void append(const SampleCells& cells, std::size_t first, std::size_t last, const PressureLaw& law);
  bool empty() const { return cells_.empty(); }

  /// The law's forces, outside a step; as SampleGroups::add_force.
  void add_force(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                 const std::vector<int>& frame_row, VecX& f, std::vector<Wrench>& on_a) const;
  /// Whether some sample presses that slides no faster than the regularisation's speed.
  bool sticks(const dynamics::StateView& state, const std::vector<FrameState>& frames) const;

  /// Makes the first guesses.  @return whether anything presses
  bool begin_step(const dynamics::StateView& state, const std::vector<FrameState>& frames);
  std::span<FrictionGuess2> guesses() { return guesses_; }

  /// Records the end of a solve.  With a given frame: of the cells on that frame alone.
  /// @param moved, change, given  as of ContactForce::improve_step
  /// @param error  by pair (ContactCell::pair): is added to
  void end_solve(const VecX& moved, const VecX& change, const FrameStep& given,
                 const std::vector<FrameState>& frames, std::vector<FrictionError>& error);
  /// @return the lines of all samples of a pair in the current step, in the order of their places; zero where
  /// nothing presses
  std::vector<FrictionLine> lines_of(int pair) const;
  /// The guesses have changed.
  void forget_sums() { summed_ = false; }

  // of the step under way, affine about the guesses: as of SampleGroups
  void add_step_force(VecX& f);
  void apply_tangent(double k_scale, double d_scale, const VecX& x, VecX& y);
  void add_tangent(double k_scale, double d_scale, dynamics::BorderedMatrix& A);
  void add_stiffness(double k_scale, double d_scale, dynamics::PointStiffness& C);

 private:
  using Vec8 = Eigen::Matrix<double, 8, 1>;
  using Mat85 = Eigen::Matrix<double, 8, 5>;
  using Mat8 = Eigen::Matrix<double, 8, 8>;
  /// Along the normal and the two directions across it.
  using Three = Eigen::Matrix<double, 8, 3>;
  struct Cell {
    int cell = 0, pair = 0, law = 0;
    int frame = -1;  ///< of side b; -1: nodes
    int count = 0;   ///< of nodes, both sides
    std::array<int, 8> node{};
    std::array<int, 8> at{};  ///< their entries in y
    Mat3 axes;                ///< columns: the normal, and two across it
    Mat85 Y;
    Vec5 beside;              ///< of the gap, what it has beside y; as of PlaceMap
    Vec5 beside_a;            ///< of side a alone
    int first = 0, last = 0;  ///< of pressing_, in a step
    /// Over its samples: forces along each axis; stiffness and damping along the normal, and friction's
    /// damping, of directions (1, 1), (2, 2) and (1, 2).
    Three f;
    Mat8 k, d, d11, d22, d12;
  };
  /// A sample that presses where the step begins.
  struct Pressing {
    int number;  ///< of its place in the cell
    Vec4 place;
    double force, k, d;  ///< along the normal: A p [N], and its derivatives by depth and by its rate
    Vec2 v;              ///< across [m/s]
  };

  const PressureLaw& law_of(const Cell& cell) const { return laws_[static_cast<std::size_t>(cell.law)]; }
  /// By which y gives what the samples do along the axes: positions along the normal, and velocities.
  Vec8 positions(const Cell& cell, const dynamics::StateView& state,
                 const std::vector<FrameState>& frames) const;
  Three velocities(const Cell& cell, const dynamics::StateView& state,
                   const std::vector<FrameState>& frames) const;
  /// visit(number in the cell, place, pressure, velocity across, area) of all samples that touch.
  template <class Visit>
  void for_each_touching(const Cell& cell, const Vec8& x, const Three& v, const Visit& visit) const;
  static Three on_nodes(const Cell& cell, const VecX& x);
  void sum();
  void sum_normal(Cell& cell);
  void sum_friction(Cell& cell);

  const SampleCells* source_ = nullptr;
  std::vector<Cell> cells_;
  std::vector<PressureLaw> laws_;
  std::vector<Pressing> pressing_;
  std::vector<FrictionGuess2> guesses_;  ///< of each of these
  bool summed_ = false;
};

}  // namespace palpate::contact
