#include "palpate/fem/attachments.h"

#include <algorithm>

#include "box.h"
#include "dynamics/carried_motion.h"
#include "palpate/core/error.h"

namespace palpate::fem {
namespace {

void check_dofs(const std::vector<int>& dofs, Eigen::Index values) {
  PALPATE_CHECK(static_cast<Eigen::Index>(dofs.size()) == values, "{} directions and {} values", dofs.size(),
                values);
  PALPATE_CHECK(dofs.empty() || dofs.front() >= 0, "direction {}", dofs.front());
  PALPATE_CHECK(std::adjacent_find(dofs.begin(), dofs.end(), std::greater_equal<>()) == dofs.end(),
                "directions must be strictly ascending");
}

class Fixed final : public dynamics::DrivenMotion {
 public:
  Fixed(std::vector<int> dofs, VecX x0) : dofs_(std::move(dofs)), x0_(std::move(x0)) {}
  const std::vector<int>& dofs() const override { return dofs_; }
  void evaluate(const dynamics::StateView&, VecX& x, VecX& v, VecX& a) const override {
    x = x0_;
    v.setZero(x0_.size());
    a.setZero(x0_.size());
  }

 private:
  std::vector<int> dofs_;
  VecX x0_;
};

/// Points of a frame that moves along a path.
class Driven final : public dynamics::DrivenMotion {
 public:
  Driven(std::vector<int> dofs, Points local, dynamics::Path path)
      : dofs_(std::move(dofs)), local_(std::move(local)), path_(std::move(path)) {}
  const std::vector<int>& dofs() const override { return dofs_; }
  void evaluate(const dynamics::StateView& state, VecX& x, VecX& v, VecX& a) const override {
    const dynamics::PathPoint now = path_(state.time);
    dynamics::carry({now.pose, now.twist}, now.acceleration, dofs_, local_, x, v, a);
  }

 private:
  std::vector<int> dofs_;
  Points local_;
  dynamics::Path path_;
};

/// See make_carried(). Geometric stiffness: under a small rotation e of the body, dr = e x r, and for a
/// constant force f the moment r x f changes by
///     (e x r) x f = [f][r] e = (r f^T - (r . f) I) e,      K = -d(r x f)/de = (r . f) I - r f^T
///     (rotation block only).
/// Summed over nodes, K - K^T is the cross matrix of the sum of r x f: K is symmetric where the moments
/// balance.
class Carried final : public dynamics::DrivenMotion {
 public:
  Carried(std::vector<int> dofs, Points local, int master)
      : dofs_(std::move(dofs)), local_(std::move(local)), master_(master) {}
  const std::vector<int>& dofs() const override { return dofs_; }
  int master_block() const override { return master_; }
  void evaluate(const dynamics::StateView& state, VecX& x, VecX& v, VecX& a) const override {
    dynamics::carry(motion(state), {}, dofs_, local_, x, v, a);
  }
  void jacobian(const dynamics::StateView& state, MatX& G) const override {
    const Mat3 R = motion(state).pose.rotation.toRotationMatrix();
    G.resize(local_.cols(), 6);
    for (Eigen::Index i = 0; i < local_.cols(); ++i) {
      const Vec3 e = Vec3::Unit(axis(i));
      G.row(i) << Vec3(R * local_.col(i)).cross(e).transpose(), e.transpose();
    }
  }
  void add_geometric_stiffness(const dynamics::StateView& state, const VecX& f, MatX& K) const override {
    const Mat3 R = motion(state).pose.rotation.toRotationMatrix();
    for (Eigen::Index i = 0; i < local_.cols(); ++i) {
      const Vec3 r = R * local_.col(i);
      const int k = axis(i);
      K.diagonal().head<3>().array() += r[k] * f[i];
      K.col(k).head<3>() -= f[i] * r;
    }
  }

 private:
  int axis(Eigen::Index i) const { return dofs_[static_cast<std::size_t>(i)] % 3; }
  dynamics::RigidMotion motion(const dynamics::StateView& state) const {
    return dynamics::motion_of(state, dynamics::rigid_block_of(state, master_));
  }
  std::vector<int> dofs_;
  Points local_;
  int master_;
};

}  // namespace

std::vector<int> nodes_in_box(const Points& placed, const Vec3& box_min, const Vec3& box_max) {
  check_box(box_min, box_max, "attachment");
  const double tolerance = selection_tolerance(placed);
  std::vector<int> out;
  for (int i = 0; i < placed.cols(); ++i)
    if (in_box(placed.col(i), box_min, box_max, tolerance)) out.push_back(i);
  return out;
}

std::vector<int> nodes_in_sphere(const Points& placed, const Vec3& centre, double radius) {
  if (!(radius > 0.0)) fail("attachment: radius_m = {} must be positive", radius);
  const double reach = radius + selection_tolerance(placed);
  std::vector<int> out;
  for (int i = 0; i < placed.cols(); ++i)
    if ((placed.col(i) - centre).norm() <= reach) out.push_back(i);
  return out;
}

std::vector<int> dofs_of_nodes(const std::vector<int>& nodes, int first_node, const std::string& axes) {
  bool held[3] = {false, false, false};
  for (char c : axes) {
    if (c < 'x' || c > 'z' || held[c - 'x'])
      fail("attachment: axes = \"{}\" must contain each of x, y, z at most once, for example \"xz\"", axes);
    held[c - 'x'] = true;
  }
  if (axes.empty()) fail("attachment: axes = \"\" holds nothing; give at least one of x, y, z");
  std::vector<int> out;
  for (int node : nodes)
    for (int axis = 0; axis < 3; ++axis)
      if (held[axis]) out.push_back(3 * (first_node + node) + axis);
  std::sort(out.begin(), out.end());
  return out;
}

std::shared_ptr<dynamics::DrivenMotion> make_fixed(std::vector<int> dofs, VecX x0) {
  check_dofs(dofs, x0.size());
  PALPATE_CHECK(x0.allFinite(), "the position of a fixed node is not finite");
  return std::make_shared<Fixed>(std::move(dofs), std::move(x0));
}

std::shared_ptr<dynamics::DrivenMotion> make_driven(std::vector<int> dofs, Points local_points_per_dof,
                                                    dynamics::Path path) {
  check_dofs(dofs, local_points_per_dof.cols());
  PALPATE_CHECK(path, "driven nodes need a path");
  return std::make_shared<Driven>(std::move(dofs), std::move(local_points_per_dof), std::move(path));
}

std::shared_ptr<dynamics::DrivenMotion> make_carried(std::vector<int> dofs, Points local_points_per_dof,
                                                     int master_block_id) {
  check_dofs(dofs, local_points_per_dof.cols());
  PALPATE_CHECK(master_block_id >= 0, "carried nodes need a rigid block, not {}", master_block_id);
  PALPATE_CHECK(local_points_per_dof.allFinite(), "the position of a carried node is not finite");
  return std::make_shared<Carried>(std::move(dofs), std::move(local_points_per_dof), master_block_id);
}

}  // namespace palpate::fem
