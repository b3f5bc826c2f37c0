// CGAL: an AABB tree cannot be refitted, so it is rebuilt at every query, from the triangles in the
// overlap of the two skins' boxes only. Then a ray from each vertex in this overlap, along the mean normal of
// the two patches, is followed to its exit from the other body. This distance is the penetration depth of the
// vertex as defined by Galoppo et al. (2007). Simple_cartesian<double>, without exact predicates, is CGAL's
// fastest kernel.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>

#include "contender.h"

namespace peers {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangle = Kernel::Triangle_3;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, std::vector<Triangle>::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 point(const Vec3& x) { return {x.x(), x.y(), x.z()}; }

struct Box {
  Vec3 low, high;
  bool holds(const Vec3& x) const { return (x.array() >= low.array() && x.array() <= high.array()).all(); }
};

/// Part of a skin in the overlap of both boxes.
class Patch {
 public:
  Patch(const Motion& motion, int body) : skin_(*motion.world, motion.body(body)) {}
  Box place(const Snapshot& state) {
    x_ = &skin_.at(state);
    return {x_->rowwise().minCoeff(), x_->rowwise().maxCoeff()};
  }
  void cut(const Box& overlap) {
    triangles_.clear();
    area_.setZero();
    vertices_.clear();
    for (Eigen::Index i = 0; i < x_->cols(); ++i)
      if (overlap.holds(x_->col(i))) vertices_.push_back(static_cast<int>(i));
    const Faces& faces = skin_.faces();
    for (Eigen::Index f = 0; f < faces.cols(); ++f) {
      const Vec3 p = x_->col(faces(0, f)), q = x_->col(faces(1, f)), r = x_->col(faces(2, f));
      const Vec3 low = p.cwiseMin(q).cwiseMin(r), high = p.cwiseMax(q).cwiseMax(r);
      if ((low.array() > overlap.high.array()).any() || (high.array() < overlap.low.array()).any()) continue;
      triangles_.emplace_back(point(p), point(q), point(r));
      area_ += 0.5 * (q - p).cross(r - p);
    }
    tree_.rebuild(triangles_.cbegin(), triangles_.cend());
    tree_.build();
  }
  const Vec3& area() const { return area_; }
  /// Adds the depths of the other skin's vertices that are inside: a ray along `out` leaves through this
  /// skin.
  void add_depths(const Patch& other, const Vec3& out, Found& found) const {
    if (triangles_.empty()) return;
    const Kernel::Vector_3 along(out.x(), out.y(), out.z());
    for (const int v : other.vertices_) {
      const Kernel::Ray_3 ray(point(other.x_->col(v)), along);
      const auto hit = tree_.first_intersection(ray);
      if (!hit) continue;
      const Triangle& face = *hit->second;
      if (CGAL::cross_product(face[1] - face[0], face[2] - face[0]) * along <= 0.0) continue;  // Enters.
      const Kernel::Point_3* at = boost::get<Kernel::Point_3>(&hit->first);
      if (!at) continue;
      ++found.contacts;
      found.deepest = std::max(found.deepest, (*at - ray.source()) * along);
    }
  }

 private:
  SkinPositions skin_;
  const Points* x_ = nullptr;
  std::vector<int> vertices_;
  std::vector<Triangle> triangles_;
  Vec3 area_ = Vec3::Zero();
  Tree tree_;
};

class Cgal final : public Contender {
 public:
  explicit Cgal(const Motion& motion) : a_(motion, 0), b_(motion, 1) {}
  std::string group() const override { return "CGAL"; }
  std::string name() const override { return "tree of the patch rebuilt, rays of vertices"; }
  void query(const Snapshot& state) override {
    const Box a = a_.place(state), b = b_.place(state);
    const Box overlap{a.low.cwiseMax(b.low), a.high.cwiseMin(b.high)};
    found_ = {};
    if ((overlap.low.array() > overlap.high.array()).any()) return;
    a_.cut(overlap);
    b_.cut(overlap);
    const Vec3 normal = (b_.area() - a_.area()).normalized();  // From b to a.
    b_.add_depths(a_, normal, found_);
    a_.add_depths(b_, -normal, found_);
  }
  Found found() const override { return found_; }

 private:
  Patch a_, b_;
  Found found_;
};

}  // namespace

void add_cgal(const Motion& motion, Contenders& to) { to.push_back(std::make_unique<Cgal>(motion)); }

}  // namespace peers
