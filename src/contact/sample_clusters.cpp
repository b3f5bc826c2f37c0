#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <span>

#include "contact/reduced_contact_model.h"

namespace palpate::contact {

// A cluster of samples j with areas a_j, normals n_j, arms r_j and gaps g_j becomes one point. Where they
// press it has their force and moment by the linear part of the law, k g a n:
//     gap g = sum a_j g_j / sum a_j,    F = sum a_j g_j n_j = g a n  gives area a and normal n,
//     arm r = mean of r_j by area + d,  r x F = sum a_j g_j r_j x n_j  gives d, across F,
//     modes P = mean of P_j by area + p n^T,  P F = sum a_j g_j P_j n_j  gives p.
// Tool and modes thus receive the loads of the samples, and bodies that are at rest under these are at rest
// under the points. (With modes averaged by area alone the bodies moved within each period until their
// stiffness balanced the difference, a force of 0.1 to 0.6 % too much, and back at its end.) A moment along F
// cannot be matched by an arm: the sum over clusters is distributed to their arms (complete_moment). Where
// samples do not press, n is their mean normal. Places, velocities and modes are otherwise means by area: the
// error is of second order in the ratio of the cluster's size to the contact's, and clusters are split where
// it is largest. Pressing samples are not clustered with others.
//
// A sticking point has a friction spring (friction_anchors.cpp) with the deflection
//     u = sum c_j u_j / c,    c_j its stiffness, mu times the pressure times a_j over tau v_r,
// with c the stiffness of the point, so that it has the samples' friction across n, at rest, by the linear
// part of the law. Its moment, and its load on the modes, follow from the point's arm and modes; the
// differences from those of the samples are passed on as constants. (Without them a block held between two
// tools crept by 4 um/s: each exchange moved the tools to where the points were in balance, by 1e-3 of the
// friction.)
namespace {

using Six = Eigen::Matrix<double, 6, 1>;
using ModesOfSamples = Eigen::Matrix<double, ReducedContactModel::kMostModes, Eigen::Dynamic>;
using MovedBy = Eigen::Matrix<double, ReducedContactModel::kMostModes, 3>;

/// Sample cluster: a range of the samples' order.
struct SampleCluster {
  int first, last;
  Six middle;  ///< Mean by area.
  Six spread;  ///< Sum of area times squared distance from the mean, per direction.
  double worst() const { return last - first > 1 ? spread.maxCoeff() : 0.0; }
};

/// Clustering of samples by recursive bisection at the mean of the direction of largest spread.
class SampleClustering {
 public:
  SampleClustering(const std::vector<ReducedSample>& samples, const Vec3& origin, std::vector<int> order)
      : samples_(samples), origin_(origin), order_(std::move(order)) {
    Vec3 mean = Vec3::Zero();
    double area = 0.0, square = 0.0;
    for (int j : order_) {
      const ReducedSample& s = sample(j);
      mean += s.area * (s.place - origin_);
      area += s.area;
    }
    mean /= area;
    for (int j : order_) square += sample(j).area * (sample(j).place - origin_ - mean).squaredNorm();
    reach_ = std::sqrt(square / area);
    coordinates_.resize(samples.size());
    for (int j : order_)
      coordinates_[static_cast<std::size_t>(j)] << sample(j).place - origin_, reach_ * sample(j).normal;
    if (!order_.empty()) bunches_.push_back(bunch(0, static_cast<int>(order_.size())));
  }

  /// Splits the cluster of largest spread until there are `count` clusters, or each is one sample.
  void split_to(int count) {
    while (static_cast<int>(bunches_.size()) < count) {
      const auto worst = std::max_element(
          bunches_.begin(), bunches_.end(),
          [](const SampleCluster& a, const SampleCluster& b) { return a.worst() < b.worst(); });
      if (worst == bunches_.end() || !(worst->worst() > 0.0)) return;
      Eigen::Index axis = 0;
      worst->spread.maxCoeff(&axis);
      const int first = worst->first, last = worst->last;
      const double middle = worst->middle[axis];
      const auto split = std::partition(order_.begin() + first, order_.begin() + last,
                                        [&](int j) { return coordinates(j)[axis] < middle; });
      const int at = static_cast<int>(split - order_.begin());
      if (at == first || at == last) return;  // Equal up to rounding.
      *worst = bunch(first, at);
      bunches_.push_back(bunch(at, last));
    }
  }

  const std::vector<SampleCluster>& all() const { return bunches_; }
  int member(int i) const { return order_[static_cast<std::size_t>(i)]; }

 private:
  const ReducedSample& sample(int j) const { return samples_[static_cast<std::size_t>(j)]; }
  const Six& coordinates(int j) const { return coordinates_[static_cast<std::size_t>(j)]; }
  Six mean(int first, int last) const {
    Six sum = Six::Zero();
    double area = 0.0;
    for (int i = first; i < last; ++i) {
      sum += sample(member(i)).area * coordinates(member(i));
      area += sample(member(i)).area;
    }
    return sum / area;
  }
  SampleCluster bunch(int first, int last) const {
    const Six middle = mean(first, last);
    Six spread = Six::Zero();
    for (int i = first; i < last; ++i)
      spread += sample(member(i)).area * (coordinates(member(i)) - middle).cwiseAbs2();
    return {first, last, middle, spread};
  }

  const std::vector<ReducedSample>& samples_;
  Vec3 origin_;
  double reach_ = 0.0;
  std::vector<int> order_;
  /// Per sample: position, and normal scaled by the contact's size, so that a rotation by one radian weighs
  /// as much as a displacement by that size.
  std::vector<Six> coordinates_;
  std::vector<SampleCluster> bunches_;
};

void write(const Vec3& from, std::array<double, 3>& to) { to = {from.x(), from.y(), from.z()}; }

/// Point of a cluster.
struct PointOfBunch {
  ReducedContactModel::Point point;
  double friction_stiffness = 0.0;  ///< Stiffness of its friction spring [N/m].
};

PointOfBunch point_of(const std::vector<ReducedSample>& samples, const ModesOfSamples& modes, const Mat3& R,
                      const Vec3& origin, const SampleClustering& bunches, const SampleCluster& bunch) {
  const bool presses = samples[static_cast<std::size_t>(bunches.member(bunch.first))].gap < 0.0;
  Vec3 along = Vec3::Zero(), moment = along, offset = along, slide = along, place = along, velocity = along,
       friction = along;
  double area = 0.0, gap = 0.0, friction_stiffness = 0.0, pressed = 0.0;
  // Samples of a cluster share nodes: weights are summed per node before the modes are.
  struct OfNode {
    int node;
    double area;  ///< Sum of area times weight.
    Vec3 push;    ///< Sum of force times weight.
  };
  std::vector<OfNode> of_nodes;
  for (int i = bunch.first; i < bunch.last; ++i) {
    const ReducedSample& s = samples[static_cast<std::size_t>(bunches.member(i))];
    const Vec3 push = (presses ? -s.area * s.gap : s.area) * s.normal;
    area += s.area;
    along += push;
    moment += (R * s.offset + s.slide).cross(push);
    gap += s.area * s.gap;
    offset += s.area * s.offset;
    slide += s.area * s.slide;
    place += s.area * s.place;
    velocity += s.area * s.velocity;
    friction += s.friction_stiffness * s.deflection;
    friction_stiffness += s.friction_stiffness;
    pressed += push.norm();
    for (std::size_t k = 0; k < static_cast<std::size_t>(s.count); ++k) {
      auto of_node = std::find_if(of_nodes.begin(), of_nodes.end(),
                                  [&](const OfNode& one) { return one.node == s.node[k]; });
      if (of_node == of_nodes.end())
        of_node = of_nodes.insert(of_nodes.end(), {s.node[k], 0.0, Vec3::Zero()});
      of_node->area += s.area * s.weight[k];
      of_node->push += push * s.weight[k];
    }
  }
  MovedBy moved = MovedBy::Zero();
  Eigen::Matrix<double, ReducedContactModel::kMostModes, 1> load = MovedBy::Zero().col(0);
  for (const OfNode& one : of_nodes) {
    moved += one.area * modes.middleCols<3>(3 * one.node);
    load += modes.middleCols<3>(3 * one.node) * one.push;
  }
  ReducedContactModel::Point out;
  out.pair = samples[static_cast<std::size_t>(bunches.member(bunch.first))].pair;
  const double size = along.norm();
  const Vec3 normal = along / size;
  gap /= area;
  offset /= area;
  slide /= area;
  place /= area;
  moved /= area;
  out.area = presses ? size / -gap : size;
  if (presses) moved += (load / size - moved * normal) * normal.transpose();
  // Samples that do not press yet are expected to press with uniform pressure: the arm matches its line.
  const Vec3 missing = moment - (R * offset + slide).cross(along);
  offset += R.transpose() * along.cross(missing) / (size * size);
  // The mean position does not reproduce the mean gap: it is corrected along the normal.
  place += normal * (normal.dot(origin + R * offset + slide - place) - gap);
  write(normal, out.normal);
  write(offset, out.offset);
  write(slide, out.slide);
  write(place, out.place);
  write(velocity / area, out.velocity);
  if (presses && friction_stiffness > 0.0) {
    friction_stiffness *= size / pressed;
    write(friction / friction_stiffness, out.deflection);
  }
  Eigen::Map<Eigen::Matrix<double, 3, ReducedContactModel::kMostModes>>(out.modes.data()) = moved.transpose();
  return {out, friction_stiffness};
}

// Arms that change by d_i = F_i x l change the moment by sum (F_i x l) x F_i = sum (|F_i|^2 - F_i F_i^T) l.
// If all forces have one direction, no moment is missing along it, and the sum is singular there.
/// Corrects the arms of the points of pressing samples so that their moment equals that of the samples. Their
/// forces do not change.
void complete_moment(const std::vector<ReducedSample>& samples, const std::vector<int>& members,
                     const Mat3& R, const Vec3& origin, std::span<ReducedContactModel::Point> points) {
  constexpr double kSameDirection = 1e-9;
  Vec3 missing = Vec3::Zero();
  Mat3 sum = Mat3::Zero();
  for (int j : members) {
    const ReducedSample& s = samples[static_cast<std::size_t>(j)];
    missing += (R * s.offset + s.slide).cross(-s.area * s.gap * s.normal);
  }
  const auto arm = [&](const ReducedContactModel::Point& p) {
    return Vec3(R * vec(p.offset) + vec(p.slide));
  };
  const auto force = [&](const ReducedContactModel::Point& p) -> Vec3 {
    const Vec3 n = vec(p.normal);
    return p.area * n.dot(vec(p.place) - origin - arm(p)) * n;
  };
  for (const ReducedContactModel::Point& p : points) {
    const Vec3 F = force(p);
    missing -= arm(p).cross(F);
    sum += F.squaredNorm() * Mat3::Identity() - F * F.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(sum);
  const Vec3& sizes = eigen.eigenvalues();
  Vec3 part = eigen.eigenvectors().transpose() * missing;
  for (Eigen::Index i = 0; i < 3; ++i)
    part[i] = sizes[i] > kSameDirection * sizes[2] ? part[i] / sizes[i] : 0.0;
  const Vec3 l = eigen.eigenvectors() * part;
  for (ReducedContactModel::Point& p : points)
    write(vec(p.offset) + R.transpose() * force(p).cross(l), p.offset);
}

/// Force of the friction springs at rest, of samples minus that of points: on the tool, and on the modes.
struct MissingFriction {
  const Mat3& R;
  Vec6 wrench = Vec6::Zero();
  Eigen::Matrix<double, ReducedContactModel::kMostModes, 1> load = decltype(load)::Zero();

  void add(const ReducedSample& s, const ModesOfSamples& modes) {
    const Vec3 force = -s.friction_stiffness * s.deflection;
    if (force.isZero(0.0)) return;
    add_wrench(R * s.offset + s.slide, force);
    for (std::size_t k = 0; k < static_cast<std::size_t>(s.count); ++k)
      load -= modes.middleCols<3>(3 * s.node[k]) * (s.weight[k] * force);
  }
  void take_away(const PointOfBunch& of) {
    const Vec3 n = vec(of.point.normal), u = vec(of.point.deflection);
    const Vec3 force = of.friction_stiffness * (u - n.dot(u) * n);
    add_wrench(R * vec(of.point.offset) + vec(of.point.slide), force);
    load -= Eigen::Map<const Eigen::Matrix<double, 3, ReducedContactModel::kMostModes>>(of.point.modes.data())
                .transpose() *
            force;
  }

 private:
  void add_wrench(const Vec3& arm, const Vec3& force) {
    wrench.head<3>() += arm.cross(force);
    wrench.tail<3>() += force;
  }
};

/// Returns the point of a cluster of held samples: their total stiffness between the means of their positions
/// and of their attachment points.
ReducedContactModel::Point held_point_of(const std::vector<ReducedSample>& samples,
                                         const ModesOfSamples& modes, const SampleClustering& bunches,
                                         const SampleCluster& bunch) {
  Vec3 normal = Vec3::Zero(), offset = normal, place = normal, velocity = normal;
  MovedBy moved = MovedBy::Zero();
  ReducedContactModel::Point out;
  for (int i = bunch.first; i < bunch.last; ++i) {
    const ReducedSample& s = samples[static_cast<std::size_t>(bunches.member(i))];
    out.held_stiffness += s.stiffness;
    out.held_damping += s.damping;
    out.area += s.area;
    out.pair = s.pair;
    normal += s.stiffness * s.normal;
    offset += s.stiffness * s.offset;
    place += s.stiffness * s.place;
    velocity += s.stiffness * s.velocity;
    for (std::size_t k = 0; k < static_cast<std::size_t>(s.count); ++k)
      moved += s.stiffness * s.weight[k] * modes.middleCols<3>(3 * s.node[k]);
  }
  write(normal.normalized(), out.normal);
  write(offset / out.held_stiffness, out.offset);
  write(place / out.held_stiffness, out.place);
  write(velocity / out.held_stiffness, out.velocity);
  Eigen::Map<Eigen::Matrix<double, 3, ReducedContactModel::kMostModes>>(out.modes.data()) =
      moved.transpose() / out.held_stiffness;
  return out;
}

/// Criterion of samples that may share a cluster: pressing, held, or neither, per contact pair.
struct Kind {
  int apart, held, pair;
  explicit Kind(const ReducedSample& s) : apart(!s.held && !(s.gap < 0.0)), held(s.held), pair(s.pair) {}
  auto operator<=>(const Kind&) const = default;
  /// Returns the share of the available points: candidates need fewer.
  int share() const { return apart ? 1 : 3; }
};

}  // namespace

void gather_points(const std::vector<ReducedSample>& samples, const Pose& pose, const ModesOfSamples& modes,
                   ReducedContactModel& out) {
  out.points = 0;
  const Quat& q = pose.rotation;
  const Vec3& x = pose.translation;
  out.tool = {q.w(), q.x(), q.y(), q.z(), x.x(), x.y(), x.z()};
  std::vector<Kind> kinds;
  for (const ReducedSample& s : samples)
    if (std::find(kinds.begin(), kinds.end(), Kind(s)) == kinds.end()) kinds.emplace_back(s);
  std::sort(kinds.begin(), kinds.end());
  std::vector<std::vector<int>> orders;
  for (const Kind& kind : kinds) {
    std::vector<int>& order = orders.emplace_back();
    for (std::size_t j = 0; j < samples.size(); ++j)
      if (Kind(samples[j]) == kind) order.push_back(static_cast<int>(j));
  }
  const Mat3 R = pose.rotation.toRotationMatrix();
  int room = ReducedContactModel::kMostPoints, shares = 0;
  for (const Kind& kind : kinds) shares += kind.share();
  MissingFriction friction{R};
  for (std::size_t k = 0; k < orders.size() && room > 0; ++k) {
    const int own = std::max(1, room * kinds[k].share() / shares);
    shares -= kinds[k].share();
    const int first = out.points;
    std::vector<double> friction_stiffness;
    SampleClustering bunches(samples, pose.translation, orders[k]);
    bunches.split_to(std::min(own, room));
    for (const SampleCluster& bunch : bunches.all()) {
      const PointOfBunch of = kinds[k].held ? PointOfBunch{held_point_of(samples, modes, bunches, bunch)}
                                            : point_of(samples, modes, R, pose.translation, bunches, bunch);
      if (room == 0 || !(of.point.area > 0.0)) continue;
      out.point[static_cast<std::size_t>(out.points++)] = of.point;
      friction_stiffness.push_back(of.friction_stiffness);
      --room;
    }
    if (kinds[k].apart || kinds[k].held) continue;
    const auto points =
        std::span(out.point).subspan(static_cast<std::size_t>(first), friction_stiffness.size());
    complete_moment(samples, orders[k], R, pose.translation, points);
    for (const int j : orders[k]) friction.add(samples[static_cast<std::size_t>(j)], modes);
    for (std::size_t i = 0; i < points.size(); ++i) friction.take_away({points[i], friction_stiffness[i]});
  }
  Eigen::Map<Vec6>(out.missing_wrench.data()) = friction.wrench;
  Eigen::Map<decltype(friction.load)>(out.missing_load.data()) = friction.load;
}

}  // namespace palpate::contact
