#include <algorithm>

#include "contact/place_squares.h"
#include "contact/sample_groups.h"
#include "palpate/core/error.h"

// Of one group, with n its normal, w_a the weights of a's nodes x_i, w_b those of b's, or side b a frame at
// (p, R) with twist (w, v) and its points o in the frame's axes, a sample is the eight numbers
//
//     y = (w_a, -w_b)   or   (w_a, -o, -1).
//
// With n . x of all these nodes, and of a frame (R^T n, n . p), in one vector x, and likewise n . v of the
// nodes, and (R^T (n x w), n . v) of a frame, as n . (w x r) = r . (n x w),
//
//     gap = y . x + c,    rate = y . v
//
// where c is what the points have beside nodes and frame along n.  With f = A p, k = -A dp/dgap,
// d = -A dp/drate of each sample, all that leaves the group are the sums
//
//     F = sum f y,   K = sum k y y^T,   D = sum d y y^T:
//
// forces are F_i n on node i, and on a frame F_8 n and the moment (R F_5..7) x n, since what slides is
// parallel to n.  The frame's map Z of a point's motion (tangent.h) and V of its velocity by a rotation with
// the twist held enter through n alone, both linear in o:
//
//     z = Z^T n = (R o x n, n) = E (o, 1),     E = (-[n]x R, 0; 0, n)        [6 x 4]
//     v = V^T n = -R o x (w x n) = M o,        M = [w x n]x R.
//
// So the blocks of the tangent are, with C = k_scale K + d_scale D, and b the last four numbers of y,
//
//     node i, node j       C_ij n n^T
//     node i, frame        n (E C_bi)^T + k_scale n (M D_oi)^T
//     frame, frame         E C_bb E^T + k_scale E D_bo M^T - k_scale [n]x [R F_o]x
//
// the last being the moment's change with its own arm (tangent.cpp).
//
// The samples of a cell are not y but the place q = (u, v, w_a, w_b, 1): y = Y q, and the sums are made of
// q, five numbers, and carried over as Y (sum f q), Y (sum k q q^T) Y^T.

namespace palpate::contact {
namespace {

struct PlaceMoments {
  PlaceSquares k, d;
  Vec4 f = Vec4::Zero();
  double f_one = 0.0;
  int touching = 0, pressed = 0;

  void add(const Vec4& p, double area, const Pressure& at) {
    ++touching;
    if (at.p != 0.0) ++pressed;
    f += area * at.p * p;
    f_one += area * at.p;
    k.add(-area * at.dp_dgap, p);
    if (at.dp_drate != 0.0) d.add(-area * at.dp_drate, p);
  }
};

struct SampleMoments {
  using Vec8 = Eigen::Matrix<double, 8, 1>;
  Vec8 f = Vec8::Zero();
  Eigen::Matrix<double, 8, 8> k, d;
  int touching = 0, pressed = 0;

  SampleMoments() {
    k.setZero();
    d.setZero();
  }
  void add(const Vec8& y, double area, const Pressure& at) {
    ++touching;
    if (at.p != 0.0) ++pressed;
    f += area * at.p * y;
    k.noalias() -= (area * at.dp_dgap * y) * y.transpose();
    if (at.dp_drate != 0.0) d.noalias() -= (area * at.dp_drate * y) * y.transpose();
  }
};

}  // namespace

SampleGroups::Motion SampleGroups::motion(const Group& group, const dynamics::StateView& state,
                                          const std::vector<FrameState>& frames) const {
  const Vec3& n = group.normal;
  Motion out;
  const auto add_nodes = [&](const std::array<int, 4>& nodes, int count, int at) {
    for (int i = 0; i < count; ++i) {
      out.x[at + i] = n.dot(state.position(nodes[static_cast<std::size_t>(i)]));
      out.v[at + i] = n.dot(state.velocity(nodes[static_cast<std::size_t>(i)]));
    }
  };
  add_nodes(group.a, group.count_a, 0);
  if (group.frame < 0) {
    add_nodes(group.b, group.count_b, 4);
  } else {
    const FrameState& frame = frames[static_cast<std::size_t>(group.frame)];
    out.x.tail<4>() << frame.R.transpose() * n, n.dot(frame.pose.translation);
    out.v.tail<4>() << frame.R.transpose() * n.cross(frame.twist.angular), n.dot(frame.twist.linear);
  }
  return out;
}

template <class Visit>
void SampleGroups::for_each_sample(const Group& group, const Motion& motion, Visit visit) const {
  for (int i = group.first; i < group.last; ++i) {
    const Sample& s = samples_[static_cast<std::size_t>(i)];
    visit(s.y, s.y.dot(motion.x) + s.shift, s.y.dot(motion.v), s.area);
  }
}

template <class Visit>
void SampleGroups::for_each_place(const Group& group, const PlaceMap& map, const Motion& motion,
                                  Visit visit) const {
  const ContactCell& cell = cells_->cells[static_cast<std::size_t>(group.cell)];
  const Vec5 gap = map.Y.transpose() * motion.x + map.beside, rate = map.Y.transpose() * motion.v;
  for (int i = group.first; i < group.last; ++i) {
    const SamplePlace& at = cells_->places[static_cast<std::size_t>(i)];
    const Vec4 p(at.u, at.v, at.w_a, at.w_b);
    visit(p, gap.head<4>().dot(p) + gap[4], rate.head<4>().dot(p) + rate[4], cells_->area(cell, i));
  }
}

PlaceMap::PlaceMap(const SampleCells& cells, int cell) {
  constexpr int kOfA[] = {0, 1, 2, 4}, kOfB[] = {0, 1, 3, 4};
  const ContactCell& at = cells.cells[static_cast<std::size_t>(cell)];
  const Carrier &a = cells.carriers[static_cast<std::size_t>(at.a)],
                &b = cells.carriers[static_cast<std::size_t>(at.b)];
  // places are counted from `at` of a
  Mat4 of_b = b.by_place;
  of_b.col(3) += b.by_place.leftCols<3>() * (a.at - b.at);
  Vec4 beside_b = b.beside;
  beside_b[3] += b.beside.head<3>().dot(a.at - b.at);
  for (int i = 0; i < 4; ++i) {
    Y.col(kOfA[i]).head<4>() += a.by_place.col(i);
    Y.col(kOfB[i]).tail<4>() -= of_b.col(i);
    beside[kOfA[i]] += a.beside[i];
    beside[kOfB[i]] -= beside_b[i];
  }
}

SampleGroups::Vec8 SampleGroups::sum_forces(const Group& group, const Motion& motion) const {
  const PressureLaw& law = law_of(group);
  Vec8 f = Vec8::Zero();
  if (group.cell < 0) {
    for_each_sample(group, motion, [&](const Vec8& y, double gap, double rate, double area) {
      if (gap < 0.0) f += area * pressure(law, gap, rate).p * y;
    });
    return f;
  }
  Vec4 of_places = Vec4::Zero();
  double of_one = 0.0;
  const PlaceMap map(*cells_, group.cell);
  for_each_place(group, map, motion, [&](const Vec4& p, double gap, double rate, double area) {
    if (gap >= 0.0) return;
    const double force = area * pressure(law, gap, rate).p;
    of_places += force * p;
    of_one += force;
  });
  return map.Y.leftCols<4>() * of_places + map.Y.col(4) * of_one;
}

bool SampleGroups::sum(const Group& group, const Motion& motion, Sums& out) const {
  const PressureLaw& law = law_of(group);
  const auto sum = [&](auto& moments) {
    return [&](const auto& at, double gap, double rate, double area) {
      if (gap < 0.0) moments.add(at, area, pressure(law, gap, rate));
    };
  };
  if (group.cell < 0) {
    SampleMoments m;
    for_each_sample(group, motion, sum(m));
    out = {m.f, m.k, m.d, m.pressed};
    return m.touching > 0;
  }
  PlaceMoments m;
  const PlaceMap map(*cells_, group.cell);
  for_each_place(group, map, motion, sum(m));
  if (m.touching == 0) return false;
  out.pressed = m.pressed;
  out.f = map.Y.leftCols<4>() * m.f + map.Y.col(4) * m.f_one;
  out.k.noalias() = map.Y * m.k.whole() * map.Y.transpose();
  if (law.d != 0.0)
    out.d.noalias() = map.Y * m.d.whole() * map.Y.transpose();
  else
    out.d.setZero();
  return true;
}

template <class Visit>
void SampleGroups::for_each_gap(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                                Visit visit) const {
  for (const Group& group : groups_) {
    const auto of_group = [&](const auto&, double gap, double rate, double area) {
      if (gap < 0.0) visit(group, gap, rate, area);
    };
    const Motion at = motion(group, state, frames);
    if (group.cell < 0)
      for_each_sample(group, at, of_group);
    else
      for_each_place(group, PlaceMap(*cells_, group.cell), at, of_group);
  }
}

double SampleGroups::energy(const dynamics::StateView& state, const std::vector<FrameState>& frames) const {
  double sum = 0.0;
  for_each_gap(state, frames, [&](const Group& group, double gap, double rate, double area) {
    sum += area * pressure(law_of(group), gap, rate).energy_density;
  });
  return sum;
}

double SampleGroups::dissipation(const dynamics::StateView& state,
                                 const std::vector<FrameState>& frames) const {
  double sum = 0.0;
  for_each_gap(state, frames, [&](const Group& group, double gap, double rate, double area) {
    sum += area * damping_power(law_of(group), gap, rate);
  });
  return sum;
}

}  // namespace palpate::contact
