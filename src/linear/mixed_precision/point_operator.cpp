#include "linear/mixed_precision/point_operator.h"

#include <algorithm>

// The share of one sum, with t_i = n . p_i and q_i += s_i n,
//     s = G t,    p . C p = t . s;
// of a point, with d = sum w_i p_i and q_i += w_i f,
//     f = C d,    p . C p = d . f.
// `relative` sums do not change when all p_i move by the same: t and d are then taken from p_i - p_0, so that
// rounding has to do with the nodes' differences alone, as in the rows of the matrix beside it.

namespace palpate::linear {
namespace {

template <class Real>
using Three = Eigen::Matrix<Real, 3, 1>;

template <class Real>
Three<Real> at(const Real* v, int place) {
  return Eigen::Map<const Three<Real>>(v + 4 * static_cast<std::ptrdiff_t>(place));
}

template <class Real>
void add_to(Real* v, int place, const Three<Real>& what) {
  Eigen::Map<Three<Real>>(v + 4 * static_cast<std::ptrdiff_t>(place)) += what;
}

}  // namespace

void PointOperator::clear() {
  along_.clear();
  points_.clear();
  doubles_.clear();
  for (const Diagonal& own : diagonal_) diagonal_of_node_[static_cast<std::size_t>(own.node)] = -1;
  diagonal_.clear();
}

PointOperator::Nodes PointOperator::placed(const dynamics::PointStiffness::Nodes& nodes,
                                           const std::vector<int>& place_of_node) const {
  Nodes out{};
  out.count = nodes.count;
  out.relative = nodes.relative;
  for (int i = 0; i < nodes.count; ++i)
    out.place[i] = place_of_node[static_cast<std::size_t>(nodes.node[static_cast<std::size_t>(i)])];
  return out;
}

void PointOperator::take(const dynamics::PointStiffness& points, const std::vector<int>& place_of_node,
                         const NodeOrder& order, double scale) {
  clear();
  if (points.empty()) return;
  doubles_ = points;
  diagonal_of_node_.resize(place_of_node.size(), -1);
  for (auto& one : doubles_.along) {
    Along out{};
    out.nodes = placed(one.nodes, place_of_node);
    out.normal = one.normal.cast<float>();
    for (int i = 0; i < kMost; ++i)
      for (int j = 0; j < kMost; ++j) out.G[kMost * i + j] = static_cast<float>(scale * one.G(i, j));
    std::copy_n(out.nodes.place, out.nodes.count, one.nodes.node.begin());
    along_.push_back(out);
  }
  for (auto& one : doubles_.points) {
    Point out{};
    out.nodes = placed(one.nodes, place_of_node);
    for (int i = 0; i < kMost; ++i) out.weight[i] = static_cast<float>(one.weight[i]);
    out.C = (scale * one.C).cast<float>();
    std::copy_n(out.nodes.place, out.nodes.count, one.nodes.node.begin());
    points_.push_back(out);
  }
  find_parts(order);
  sum_diagonal();
}

void PointOperator::find_parts(const NodeOrder& order) {
  const auto parts = static_cast<std::size_t>(order.parts());
  first_node_.resize(parts + 1);
  for (std::size_t p = 0; p <= parts; ++p) first_node_[p] = order.first_node(p);
  const auto list = [&](auto& of_part, const auto& sums) {
    of_part.resize(parts);
    for (auto& own : of_part) own.clear();
    for (std::size_t s = 0; s < sums.size(); ++s)
      for (int i = 0; i < sums[s].nodes.count; ++i) {
        const auto part = static_cast<std::size_t>(
            std::upper_bound(first_node_.begin(), first_node_.end() - 1, sums[s].nodes.place[i]) -
            first_node_.begin() - 1);
        if (of_part[part].empty() || of_part[part].back() != static_cast<int>(s))
          of_part[part].push_back(static_cast<int>(s));
      }
  };
  list(along_of_part_, along_);
  list(points_of_part_, points_);
}

void PointOperator::sum_diagonal() {
  for_each_block([&](int i, int j, const Eigen::Matrix3f& block) {
    if (i != j) return;
    int& index = diagonal_of_node_[static_cast<std::size_t>(i)];
    if (index < 0) {
      index = static_cast<int>(diagonal_.size());
      diagonal_.push_back({i, Eigen::Matrix3f::Zero()});
    }
    diagonal_[static_cast<std::size_t>(index)].block += block;
  });
}

double PointOperator::product(std::size_t part, const float* p, float* q) const {
  const int first = first_node_[part], last = first_node_[part + 1];
  const auto mine = [&](int place) { return place >= first && place < last; };
  double share = 0.0;
  for (const int index : along_of_part_[part]) {
    const Along& a = along_[static_cast<std::size_t>(index)];
    const Nodes& nodes = a.nodes;
    float t[kMost] = {}, s[kMost] = {};
    for (int i = 0; i < nodes.count; ++i) t[i] = a.normal.dot(at(p, nodes.place[i]));
    const float shift = nodes.relative ? t[0] : 0.0f;
    for (int i = 0; i < nodes.count; ++i) t[i] -= shift;
    for (int j = 0; j < kMost; ++j)
      for (int i = 0; i < kMost; ++i) s[i] += a.G[kMost * j + i] * t[j];
    for (int i = 0; i < nodes.count; ++i) {
      if (!mine(nodes.place[i])) continue;
      add_to<float>(q, nodes.place[i], s[i] * a.normal);
      share += static_cast<double>(s[i]) * (t[i] + shift);
    }
  }
  for (const int index : points_of_part_[part]) {
    const Point& a = points_[static_cast<std::size_t>(index)];
    const Nodes& nodes = a.nodes;
    const Eigen::Vector3f origin = nodes.relative ? at(p, nodes.place[0]) : Eigen::Vector3f::Zero();
    Eigen::Vector3f d = Eigen::Vector3f::Zero();
    for (int i = 0; i < nodes.count; ++i) d += a.weight[i] * (at(p, nodes.place[i]) - origin);
    const Eigen::Vector3f f = a.C * d;
    for (int i = 0; i < nodes.count; ++i) {
      if (!mine(nodes.place[i])) continue;
      const Eigen::Vector3f own = a.weight[i] * f;
      add_to<float>(q, nodes.place[i], own);
      share += own.dot(at(p, nodes.place[i]));
    }
  }
  return share;
}

void PointOperator::product(std::size_t part, const double* x, double* y) const {
  const int first = first_node_[part], last = first_node_[part + 1];
  const auto mine = [&](int place) { return place >= first && place < last; };
  for (const int index : along_of_part_[part]) {
    const auto& a = doubles_.along[static_cast<std::size_t>(index)];
    dynamics::PointStiffness::Weights t = dynamics::PointStiffness::Weights::Zero();
    for (int i = 0; i < a.nodes.count; ++i)
      t[i] = a.normal.dot(at(x, a.nodes.node[static_cast<std::size_t>(i)]));
    if (a.nodes.relative) t.head(a.nodes.count).array() -= double{t[0]};
    const dynamics::PointStiffness::Weights s = a.G * t;
    for (int i = 0; i < a.nodes.count; ++i)
      if (const int place = a.nodes.node[static_cast<std::size_t>(i)]; mine(place))
        add_to<double>(y, place, s[i] * a.normal);
  }
  for (const int index : points_of_part_[part]) {
    const auto& a = doubles_.points[static_cast<std::size_t>(index)];
    const Vec3 origin = a.nodes.relative ? at(x, a.nodes.node[0]) : Vec3::Zero();
    Vec3 d = Vec3::Zero();
    for (int i = 0; i < a.nodes.count; ++i)
      d += a.weight[i] * (at(x, a.nodes.node[static_cast<std::size_t>(i)]) - origin);
    const Vec3 f = a.C * d;
    for (int i = 0; i < a.nodes.count; ++i)
      if (const int place = a.nodes.node[static_cast<std::size_t>(i)]; mine(place))
        add_to<double>(y, place, a.weight[i] * f);
  }
}

}  // namespace palpate::linear
