#include "contact_loads.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace palpate::loop {

using contact::ReducedSample;
using contact::ReducedTangent;

namespace {

using Mat36 = Eigen::Matrix<double, 3, 6>;

/// Tolerance for squared loads: an omitted load is below a thousandth of the largest.
constexpr double kAlikeLoads = 1e-6;

/// Returns the predicted depth of each sample at the end of the period, at constant velocities [m]. If no
/// sample is predicted to press, depths are measured from the smallest gap plus a tenth of the range of gaps,
/// so that the nearest samples have positive depths. Held samples, which act already, have none.
VecX coming_depths(const std::vector<ReducedSample>& samples, const Twist& tool, const Mat3& R, double H) {
  VecX gaps = VecX::Constant(static_cast<Eigen::Index>(samples.size()), HUGE_VAL);
  double nearest = HUGE_VAL, farthest = -HUGE_VAL;
  for (std::size_t j = 0; j < samples.size(); ++j) {
    const ReducedSample& s = samples[j];
    if (s.held) continue;
    const Vec3 v = tool.at(R * s.offset + s.slide) - s.velocity;
    const double gap = gaps[static_cast<Eigen::Index>(j)] = s.gap + H * s.normal.dot(v);
    nearest = std::min(nearest, gap);
    farthest = std::max(farthest, gap);
  }
  if (nearest > farthest) return VecX::Zero(gaps.size());
  const double reach = nearest < 0.0 ? 0.0 : nearest + 0.1 * (farthest - nearest);
  return (reach - gaps.array()).cwiseMax(0.0);
}

}  // namespace

std::vector<int> number_nodes(std::vector<ReducedSample>& samples) {
  std::vector<int> out;
  for (const ReducedSample& s : samples) out.insert(out.end(), s.node.begin(), s.node.begin() + s.count);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  for (ReducedSample& s : samples)
    for (auto node = s.node.begin(); node != s.node.begin() + s.count; ++node)
      *node = static_cast<int>(std::lower_bound(out.begin(), out.end(), *node) - out.begin());
  return out;
}

MatX load_patterns(const dynamics::RigidMotion& tool, bool friction,
                   const std::vector<ReducedSample>& samples, const std::vector<ReducedTangent>& tangents,
                   std::size_t nodes, double H, Eigen::Index most) {
  const bool pressed = std::any_of(samples.begin(), samples.end(), presses);
  const Mat3 R = tool.pose.rotation.toRotationMatrix();
  const VecX depths = coming_depths(samples, tool.twist, R, H);
  bool more = !pressed;
  for (std::size_t j = 0; j < samples.size(); ++j)
    more = more || (!presses(samples[j]) && depths[static_cast<Eigen::Index>(j)] > 0.0);
  const Eigen::Index count = friction ? 12 : 6;
  MatX all = MatX::Zero(3 * static_cast<Eigen::Index>(nodes), count),
       coming = MatX::Zero(all.rows(), more ? 3 : 0);
  for (std::size_t j = 0; j < samples.size(); ++j) {
    const ReducedSample& s = samples[j];
    const double depth = depths[static_cast<Eigen::Index>(j)];
    Mat36 Z;
    Z << -cross_matrix(R * s.offset + s.slide), Mat3::Identity();
    // A held sample is tied across the normal, and along the normal unless it presses.
    const Mat3 along = s.normal * s.normal.transpose(),
               nn = !s.held ? along : Mat3(Mat3::Identity() - (s.gap < 0.0 ? along : Mat3(Mat3::Zero())));
    // Where friction sticks, nodes follow the tool, the more the harder they are pressed. Where it slides,
    // nodes respond only to tool motion across the sliding direction. Loads weighted by anything but the
    // friction tangent would make one kind move like the other. (The remaining constant force, along the
    // sliding direction, is part of the last load.)
    const Mat3 across = Mat3::Identity() - along,
               friction_damping = s.held ? Mat3(Mat3::Zero()) : Mat3(across * tangents[j].D * across);
    Eigen::Matrix<double, 3, 12> load;
    load << s.stiffness * nn * Z, friction_damping * Z;
    for (std::size_t k = 0; k < static_cast<std::size_t>(s.count); ++k) {
      const auto at = 3 * s.node[k];
      if (presses(s)) all.middleRows<3>(at) += s.weight[k] * load.leftCols(count);
      if (more && depth > 0.0) {
        const Mat3 force = s.weight[k] * s.stiffness * depth * (friction ? Mat3(Mat3::Identity()) : nn);
        coming.middleRows<3>(at) += force;
      }
    }
  }
  if (friction) {  // equal weight for both kinds of load
    const double along = all.middleCols<3>(3).norm(), across = all.middleCols<3>(9).norm();
    if (across > 0.0) all.rightCols<6>() *= along / across;
  }
  // Scales rotation loads to equal the translation loads in size, i.e. by the displacement at the contact.
  for (Eigen::Index k = 0; k < count; k += 6) {
    const double turn = all.middleCols<3>(k).norm(), push = all.middleCols<3>(k + 3).norm();
    if (turn > 1e-9 * push * tool.pose.translation.norm()) all.middleCols<3>(k) *= push / turn;
  }
  MatX out(all.rows(), count + coming.cols());
  const double now = all.norm(), later = coming.norm();
  out << all / (now > 0.0 ? now : 1.0), coming / (later > 0.0 ? later : 1.0);
  const Eigen::SelfAdjointEigenSolver<MatX> gram(MatX(out.transpose() * out));
  const VecX& size = gram.eigenvalues();  // ascending
  const Eigen::Index alone = (size.array() > kAlikeLoads * size[size.size() - 1]).count();
  return out * gram.eigenvectors().rightCols(std::min(alone, most));
}

}  // namespace palpate::loop
