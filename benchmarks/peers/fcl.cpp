// FCL: the documented way for a mesh with constant topology, beginReplaceModel, replaceSubModel and
// endReplaceModel(refit, bottomup) of BVHModel, then all contacts of the pair with their depths.
//
// fcl::collide copies a model of axis-aligned volumes at every call, because it may have to rotate it. The
// traversal that it starts after this copy can be called directly, without a copy: this is faster if the
// skins are already in world coordinates, and both are timed. Oriented volumes are not copied, but cost more
// to refit.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/detail/traversal/collision/mesh_collision_traversal_node.h>
#include <fcl/narrowphase/detail/traversal/collision_node.h>

#include <algorithm>

#include "contender.h"
#include "palpate/core/error.h"

namespace peers {
namespace {

template <class Volume>
class Mesh {
 public:
  Mesh(const Motion& motion, int body) : skin_(*motion.world, motion.body(body)) {
    take(motion.states.front());
    std::vector<fcl::Triangle> triangles;
    const Faces& faces = skin_.faces();
    for (Eigen::Index f = 0; f < faces.cols(); ++f)
      triangles.emplace_back(static_cast<std::size_t>(faces(0, f)), static_cast<std::size_t>(faces(1, f)),
                             static_cast<std::size_t>(faces(2, f)));
    model.beginModel();
    model.addSubModel(points_, triangles);
    model.endModel();
  }
  void update(const Snapshot& state) {
    take(state);
    model.beginReplaceModel();
    model.replaceSubModel(points_);
    PALPATE_CHECK(model.endReplaceModel(true, true) == fcl::BVH_OK, "FCL did not refit");
  }
  fcl::BVHModel<Volume> model;

 private:
  void take(const Snapshot& state) {
    const Points& x = skin_.at(state);
    points_.resize(static_cast<std::size_t>(x.cols()));
    for (Eigen::Index i = 0; i < x.cols(); ++i) points_[static_cast<std::size_t>(i)] = x.col(i);
  }
  SkinPositions skin_;
  std::vector<fcl::Vector3d> points_;
};

constexpr std::size_t kAllContacts = std::size_t{1} << 22;

template <class Volume, bool kTraversalAlone>
class Fcl final : public Contender {
 public:
  Fcl(const Motion& motion, std::string name) : a_(motion, 0), b_(motion, 1), name_(std::move(name)) {}
  std::string group() const override { return "FCL"; }
  std::string name() const override { return name_; }
  void query(const Snapshot& state) override {
    a_.update(state);
    b_.update(state);
    const fcl::CollisionRequestd request(kAllContacts, true);
    result_.clear();
    if constexpr (kTraversalAlone) {
      fcl::Transform3d here = fcl::Transform3d::Identity(), there = here;
      fcl::detail::MeshCollisionTraversalNode<Volume> node;
      PALPATE_CHECK(
          fcl::detail::initialize(node, a_.model, here, b_.model, there, request, result_, true, true),
          "FCL did not start");
      fcl::detail::collide(&node);
    } else {
      fcl::collide(&a_.model, fcl::Transform3d::Identity(), &b_.model, fcl::Transform3d::Identity(), request,
                   result_);
    }
  }
  Found found() const override {
    Found out{.contacts = static_cast<long>(result_.numContacts())};
    for (std::size_t i = 0; i < result_.numContacts(); ++i)
      out.deepest = std::max(out.deepest, result_.getContact(i).penetration_depth);
    return out;
  }

 private:
  Mesh<Volume> a_, b_;
  std::string name_;
  fcl::CollisionResultd result_;
};

}  // namespace

void add_fcl(const Motion& motion, Contenders& to) {
  to.push_back(
      std::make_unique<Fcl<fcl::AABB<double>, true>>(motion, "axis-aligned boxes refitted, no copy"));
  to.push_back(std::make_unique<Fcl<fcl::AABB<double>, false>>(motion, "axis-aligned boxes refitted"));
  to.push_back(std::make_unique<Fcl<fcl::KDOP<double, 16>, true>>(motion, "16-DOPs refitted, no copy"));
  to.push_back(std::make_unique<Fcl<fcl::OBBRSS<double>, false>>(motion, "oriented volumes refitted"));
}

}  // namespace peers
