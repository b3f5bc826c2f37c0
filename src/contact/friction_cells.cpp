#include "contact/friction_cells.h"

#include <algorithm>

#include "contact/place_squares.h"
#include "palpate/core/error.h"

// With the names of group_sums.cpp, and e_0 = n, e_1, e_2 the axes of a cell: a sample at the place q = (u,
// v, w_a, w_b, 1) has y = Y q, and moves along e by y . (e . x of the nodes).  Within a step its force is
//     f n + (c - D s),   c - D s  in the plane of e_1, e_2
// with the line of its guess (friction.cpp) and its velocity s across the normal; so a cell adds to matrices
//     K n n^T,   D n n^T,   D_ab e_a e_b^T,      D_ab = Y (sum D_ab q q^T) Y^T.
// The first two and the samples' s stay from solve to solve, as the state does that the step begins with.

namespace palpate::contact {

void FrictionCells::clear() {
  source_ = nullptr;
  cells_.clear();
  laws_.clear();
}

void FrictionCells::append(const SampleCells& cells, std::size_t first, std::size_t last,
                           const PressureLaw& law) {
  source_ = &cells;
  laws_.push_back(law);
  for (std::size_t c = first; c < last; ++c) {
    const ContactCell& from = cells.cells[c];
    const Carrier &a = cells.carriers[static_cast<std::size_t>(from.a)],
                  &b = cells.carriers[static_cast<std::size_t>(from.b)];
    PALPATE_CHECK(a.frame < 0, "a contact cell has a frame on its first side");
    Cell& to = cells_.emplace_back();
    to.cell = static_cast<int>(c);
    to.pair = from.pair;
    to.law = static_cast<int>(laws_.size()) - 1;
    to.frame = b.frame;
    const auto take = [&](const Carrier& carrier, int at) {
      for (int i = 0; carrier.frame < 0 && i < carrier.count; ++i) {
        const auto next = static_cast<std::size_t>(to.count++);
        to.node[next] = carrier.node[static_cast<std::size_t>(i)];
        to.at[next] = at + i;
      }
    };
    take(a, 0);
    take(b, 4);
    const PlaceMap map(cells, to.cell);
    to.Y = map.Y;
    to.beside = map.beside;
    to.beside_a << a.beside[0], a.beside[1], a.beside[2], 0.0, a.beside[3];
    const Vec3& n = from.normal;
    to.axes << n, n.unitOrthogonal(), n.cross(n.unitOrthogonal());
  }
}

FrictionCells::Vec8 FrictionCells::positions(const Cell& cell, const dynamics::StateView& state,
                                             const std::vector<FrameState>& frames) const {
  const Vec3 n = cell.axes.col(0);
  Vec8 out = Vec8::Zero();
  for (std::size_t i = 0; i < static_cast<std::size_t>(cell.count); ++i)
    out[cell.at[i]] = n.dot(state.position(cell.node[i]));
  if (cell.frame < 0) return out;
  const FrameState& frame = frames[static_cast<std::size_t>(cell.frame)];
  out.tail<4>() << frame.R.transpose() * n, n.dot(frame.pose.translation);
  return out;
}

FrictionCells::Three FrictionCells::velocities(const Cell& cell, const dynamics::StateView& state,
                                               const std::vector<FrameState>& frames) const {
  Three out = Three::Zero();
  for (std::size_t i = 0; i < static_cast<std::size_t>(cell.count); ++i)
    out.row(cell.at[i]) = state.velocity(cell.node[i]).transpose() * cell.axes;
  if (cell.frame < 0) return out;
  const FrameState& frame = frames[static_cast<std::size_t>(cell.frame)];
  for (int k = 0; k < 3; ++k) {
    const Vec3 e = cell.axes.col(k);
    out.col(k).tail<4>() << frame.R.transpose() * e.cross(frame.twist.angular), e.dot(frame.twist.linear);
  }
  return out;
}

template <class Visit>
void FrictionCells::for_each_touching(const Cell& cell, const Vec8& x, const Three& v,
                                      const Visit& visit) const {
  const ContactCell& from = source_->cells[static_cast<std::size_t>(cell.cell)];
  const Vec5 gaps = cell.Y.transpose() * x + cell.beside;
  const Eigen::Matrix<double, 5, 3> rates = cell.Y.transpose() * v;
  const Vec4 gaps_4 = gaps.head<4>(), rates_4 = rates.col(0).head<4>(), s1 = rates.col(1).head<4>(),
             s2 = rates.col(2).head<4>();
  for (int i = from.first; i < from.last; ++i) {
    const SamplePlace& at = source_->places[static_cast<std::size_t>(i)];
    const Vec4 p(at.u, at.v, at.w_a, at.w_b);
    const double gap = gaps_4.dot(p) + gaps[4];
    if (gap >= 0.0) continue;
    const Pressure of = pressure(law_of(cell), gap, rates_4.dot(p) + rates(4, 0));
    visit(i - from.first, p, of, Vec2(s1.dot(p) + rates(4, 1), s2.dot(p) + rates(4, 2)),
          source_->area(from, i));
  }
}

void FrictionCells::add_force(const dynamics::StateView& state, const std::vector<FrameState>& frames,
                              const std::vector<int>& frame_row, VecX& f, std::vector<Wrench>& on_a) const {
  for (const Cell& cell : cells_) {
    const PressureLaw& law = law_of(cell);
    Eigen::Matrix<double, 4, 3> of_places = Eigen::Matrix<double, 4, 3>::Zero();
    Vec3 of_one = Vec3::Zero();
    for_each_touching(cell, positions(cell, state, frames), velocities(cell, state, frames),
                      [&](int, const Vec4& p, const Pressure& at, const Vec2& v, double area) {
                        const Vec2 across = friction_force(law.friction * area * at.p, v, law.regularisation);
                        const Vec3 force(area * at.p, across.x(), across.y());
                        of_places += p * force.transpose();
                        of_one += force;
                      });
    if (of_one[0] == 0.0) continue;
    Eigen::Matrix<double, 5, 3> sums;
    sums << of_places, of_one.transpose();
    const Three out = cell.Y * sums;
    Vec3 moment = Vec3::Zero();
    for (std::size_t i = 0; i < static_cast<std::size_t>(cell.count); ++i) {
      const Vec3 force = cell.axes * out.row(cell.at[i]).transpose();
      f.segment<3>(3 * cell.node[i]) += force;
      if (cell.at[i] < 4) moment += Vec3(state.position(cell.node[i])).cross(force);
    }
    const Vec3 resultant = cell.axes * of_one,
               beside = cell.axes * (sums.transpose() * cell.beside_a);  // these points' own moment
    on_a[static_cast<std::size_t>(cell.pair)] += Wrench{moment + cell.axes.col(0).cross(beside), resultant};
    if (cell.frame < 0) continue;
    const FrameState& frame = frames[static_cast<std::size_t>(cell.frame)];
    if (const int row = frame_row[static_cast<std::size_t>(cell.frame)]; row >= 0)
      for (int k = 0; k < 3; ++k) {
        const Vec3 e = cell.axes.col(k);
        f.segment<3>(row) += (frame.R * out.col(k).segment<3>(4)).cross(e);
        f.segment<3>(row + 3) += out(7, k) * e;
      }
  }
}

bool FrictionCells::sticks(const dynamics::StateView& state, const std::vector<FrameState>& frames) const {
  bool out = false;
  for (const Cell& cell : cells_)
    for_each_touching(cell, positions(cell, state, frames), velocities(cell, state, frames),
                      [&](int, const Vec4&, const Pressure&, const Vec2& v, double) {
                        out = out || v.norm() <= law_of(cell).regularisation;
                      });
  return out;
}

bool FrictionCells::begin_step(const dynamics::StateView& state, const std::vector<FrameState>& frames) {
  pressing_.clear();
  guesses_.clear();
  summed_ = false;
  for (Cell& cell : cells_) {
    const PressureLaw& law = law_of(cell);
    cell.first = static_cast<int>(pressing_.size());
    for_each_touching(
        cell, positions(cell, state, frames), velocities(cell, state, frames),
        [&](int number, const Vec4& p, const Pressure& at, const Vec2& v, double area) {
          if (at.p == 0.0) return;
          pressing_.push_back({number, p, area * at.p, -area * at.dp_dgap, -area * at.dp_drate, v});
          FrictionGuess2& guess = guesses_.emplace_back();
          guess.limit = law.friction * area * at.p;
          guess.v_r = law.regularisation;
          guess.v = v;
        });
    cell.last = static_cast<int>(pressing_.size());
    sum_normal(cell);
  }
  return !pressing_.empty();
}

void FrictionCells::sum_normal(Cell& cell) {
  if (cell.first == cell.last) return;
  PlaceSquares k, d;
  Vec4 f = Vec4::Zero();
  double f_one = 0.0;
  for (int i = cell.first; i < cell.last; ++i) {
    const Pressing& at = pressing_[static_cast<std::size_t>(i)];
    f += at.force * at.place;
    f_one += at.force;
    k.add(at.k, at.place);
    d.add(at.d, at.place);
  }
  cell.f.col(0) = cell.Y.leftCols<4>() * f + cell.Y.col(4) * f_one;
  cell.k = cell.Y * k.whole() * cell.Y.transpose();
  cell.d = cell.Y * d.whole() * cell.Y.transpose();
}

void FrictionCells::sum_friction(Cell& cell) {
  if (cell.first == cell.last) return;
  PlaceSquares d11, d22, d12;
  Vec4 f1 = Vec4::Zero(), f2 = Vec4::Zero();
  Vec2 f_one = Vec2::Zero();
  for (int i = cell.first; i < cell.last; ++i) {
    const Pressing& at = pressing_[static_cast<std::size_t>(i)];
    const FrictionLineOf<Vec2> line = friction_line(guesses_[static_cast<std::size_t>(i)]);
    const Vec2 force = line.constant - line.D * at.v;
    f1 += force[0] * at.place;
    f2 += force[1] * at.place;
    f_one += force;
    d11.add(line.D(0, 0), at.place);
    d22.add(line.D(1, 1), at.place);
    d12.add(line.D(0, 1), at.place);
  }
  cell.f.col(1) = cell.Y.leftCols<4>() * f1 + cell.Y.col(4) * f_one[0];
  cell.f.col(2) = cell.Y.leftCols<4>() * f2 + cell.Y.col(4) * f_one[1];
  cell.d11 = cell.Y * d11.whole() * cell.Y.transpose();
  cell.d22 = cell.Y * d22.whole() * cell.Y.transpose();
  cell.d12 = cell.Y * d12.whole() * cell.Y.transpose();
}

void FrictionCells::sum() {
  if (summed_) return;
  for (Cell& cell : cells_) sum_friction(cell);
  summed_ = true;
}

FrictionCells::Three FrictionCells::on_nodes(const Cell& cell, const VecX& x) {
  Three out = Three::Zero();
  for (std::size_t i = 0; i < static_cast<std::size_t>(cell.count); ++i)
    out.row(cell.at[i]) = x.segment<3>(3 * cell.node[i]).transpose() * cell.axes;
  return out;
}

// A frame that turns by t with its twist held moves a point by t x R o, and changes its velocity by w x (t x
// R o) besides (tangent.h).
void FrictionCells::end_solve(const VecX& moved, const VecX& change, const FrameStep& given,
                              const std::vector<FrameState>& frames, std::vector<FrictionError>& errors) {
  for (const Cell& cell : cells_) {
    if (cell.first == cell.last || (given.frame >= 0 && given.frame != cell.frame)) continue;
    Three by = on_nodes(cell, moved), by_change = on_nodes(cell, change);
    if (given.frame >= 0) {
      const FrameState& frame = frames[static_cast<std::size_t>(given.frame)];
      const Vec3 turn = given.moved.head<3>();
      for (int k = 0; k < 3; ++k) {
        const Vec3 e = cell.axes.col(k);
        by.col(k).tail<4>() << frame.R.transpose() * e.cross(turn), e.dot(given.moved.tail<3>());
        by_change.col(k).tail<4>() << frame.R.transpose() * (e.cross(given.change.head<3>()) +
                                                             e.cross(frame.twist.angular).cross(turn)),
            e.dot(given.change.tail<3>());
      }
    }
    const Vec5 depth = cell.Y.transpose() * by.col(0);
    const Eigen::Matrix<double, 5, 3> rates = cell.Y.transpose() * by_change;
    const Vec4 depth_4 = depth.head<4>(), rate_4 = rates.col(0).head<4>(), s1 = rates.col(1).head<4>(),
               s2 = rates.col(2).head<4>();
    const PressureLaw& law = law_of(cell);
    FrictionErrorOf<Vec2> sum;
    for (int i = cell.first; i < cell.last; ++i) {
      const Pressing& at = pressing_[static_cast<std::size_t>(i)];
      FrictionGuess2& guess = guesses_[static_cast<std::size_t>(i)];
      const double force = at.force - at.k * (depth_4.dot(at.place) + depth[4]) -
                           at.d * (rate_4.dot(at.place) + rates(4, 0)),
                   limit = law.friction * std::max(force, 0.0);
      const Vec2 v = at.v + Vec2(s1.dot(at.place) + rates(4, 1), s2.dot(at.place) + rates(4, 2));
      const FrictionLineOf<Vec2> line = friction_line(guess);
      const Vec2 taken = line.constant - line.D * v;
      sum.add(taken, limit, v, law.regularisation);
      contact::end_solve(guess, limit, v, taken);
    }
    FrictionError& error = errors[static_cast<std::size_t>(cell.pair)];
    error.difference += sum.difference;
    error.limit += sum.limit;
    error.left_out += cell.axes.rightCols<2>() * sum.left_out;
    error.friction += cell.axes.rightCols<2>() * sum.friction;
  }
}

std::vector<FrictionLine> FrictionCells::lines_of(int pair) const {
  std::vector<FrictionLine> out;
  for (const Cell& cell : cells_) {
    if (cell.pair != pair) continue;
    const ContactCell& from = source_->cells[static_cast<std::size_t>(cell.cell)];
    const std::size_t begin = out.size();
    out.resize(begin + static_cast<std::size_t>(from.last - from.first));
    const auto across = cell.axes.rightCols<2>();
    for (int i = cell.first; i < cell.last; ++i) {
      const FrictionLineOf<Vec2> line = friction_line(guesses_[static_cast<std::size_t>(i)]);
      out[begin + static_cast<std::size_t>(pressing_[static_cast<std::size_t>(i)].number)] = {
          across * line.constant, across * line.D * across.transpose()};
    }
  }
  return out;
}

}  // namespace palpate::contact
