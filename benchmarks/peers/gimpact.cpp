// Bullet's GImpact, documented for deformable meshes: the vertices are written, postUpdate() and
// updateBound() refit the tree of boxes, and the dispatcher's algorithm for the pair is reused. Bullet's
// persistent manifold keeps four points per pair of bodies; here the result takes every reported point, which
// adds no work to the algorithm. Margins are zero, so that only overlap is reported; single precision,
// Bullet's default and its fastest.
#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <algorithm>

#include "contender.h"
#include "palpate/core/error.h"

namespace peers {
namespace {

class Mesh {
 public:
  Mesh(const Motion& motion, int body) : skin_(*motion.world, motion.body(body)) {
    const Faces& faces = skin_.faces();
    indices_.assign(faces.data(), faces.data() + faces.size());
    update(motion.states.front());
    array_ = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(faces.cols()), indices_.data(), static_cast<int>(3 * sizeof(int)),
        static_cast<int>(vertices_.size() / 3), vertices_.data(), static_cast<int>(3 * sizeof(btScalar)));
    shape_ = std::make_unique<btGImpactMeshShape>(array_.get());
    shape_->setMargin(0);
    shape_->updateBound();
    object_.setCollisionShape(shape_.get());
  }
  void update(const Snapshot& state) {
    const Points& x = skin_.at(state);
    vertices_.resize(static_cast<std::size_t>(x.size()));
    std::transform(x.data(), x.data() + x.size(), vertices_.begin(),
                   [](double v) { return static_cast<btScalar>(v); });
    if (!shape_) return;
    shape_->postUpdate();
    shape_->updateBound();
  }
  btCollisionObject& object() { return object_; }
  btCollisionObjectWrapper wrapper() const {
    return {nullptr, shape_.get(), &object_, object_.getWorldTransform(), -1, -1};
  }

 private:
  SkinPositions skin_;
  std::vector<int> indices_;
  std::vector<btScalar> vertices_;
  std::unique_ptr<btTriangleIndexVertexArray> array_;
  std::unique_ptr<btGImpactMeshShape> shape_;
  btCollisionObject object_;
};

/// Takes every point.
class AllPoints final : public btManifoldResult {
 public:
  using btManifoldResult::btManifoldResult;
  void addContactPoint(const btVector3&, const btVector3&, btScalar depth) override {
    ++found.contacts;
    found.deepest = std::max(found.deepest, -static_cast<double>(depth));
  }
  Found found;
};

class GImpact final : public Contender {
 public:
  explicit GImpact(const Motion& motion) : a_(motion, 0), b_(motion, 1) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
    const btCollisionObjectWrapper a = a_.wrapper(), b = b_.wrapper();
    algorithm_ = dispatcher_.findAlgorithm(&a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    PALPATE_CHECK(dynamic_cast<btGImpactCollisionAlgorithm*>(algorithm_), "Bullet took another algorithm");
  }
  ~GImpact() override {
    algorithm_->~btCollisionAlgorithm();
    dispatcher_.freeCollisionAlgorithm(algorithm_);
  }
  GImpact(const GImpact&) = delete;
  GImpact& operator=(const GImpact&) = delete;
  std::string group() const override { return "Bullet GImpact"; }
  std::string name() const override { return "boxes refitted"; }
  void query(const Snapshot& state) override {
    a_.update(state);
    b_.update(state);
    const btCollisionObjectWrapper a = a_.wrapper(), b = b_.wrapper();
    AllPoints result(&a, &b);
    algorithm_->processCollision(&a, &b, info_, &result);
    found_ = result.found;
  }
  Found found() const override { return found_; }

 private:
  Mesh a_, b_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDispatcherInfo info_;
  btCollisionAlgorithm* algorithm_ = nullptr;
  Found found_;
};

}  // namespace

void add_gimpact(const Motion& motion, Contenders& to) { to.push_back(std::make_unique<GImpact>(motion)); }

}  // namespace peers
