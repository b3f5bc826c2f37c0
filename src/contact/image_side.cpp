#include "contact/image_side.h"

#include <atomic>
#include <cmath>

#include "palpate/core/error.h"

namespace palpate::contact {
namespace {

class SoftSide final : public ImageSide {
 public:
  explicit SoftSide(NodeSurface surface) : state_(std::move(surface)) {}
  void update(const dynamics::StateView& state) override { state_.update(state); }
  proxy::ProxyMotion motion(const dynamics::StateView& state) const override {
    return around_mean(state_.node_velocities(state));
  }
  const Faces& faces() const override { return state_.faces(); }
  const Points& positions() override { return state_.positions(); }
  Vec3 vertex(int vertex) const override { return state_.position(vertex); }
  void update(proxy::ProxySet& proxies) const override { proxies.update(state_.nodes()); }
  void set_motion(proxy::ProxySet& proxies, const dynamics::StateView& state) const override {
    proxies.set_motion(state_.node_velocities(state));
  }
  void keep() override { kept_ = state_.carrying_points(); }
  proxy::ProxyMotion way() override {
    way_ = state_.carrying_points() - kept_;
    return around_mean(way_);
  }
  void set_motion(proxy::ProxySet& proxies) override {
    way_ = state_.carrying_points() - kept_;
    proxies.set_motion(way_);
  }
  Vec3 kept_vertex(int vertex) const override { return state_.position(vertex, kept_); }
  Carrier carrier(int number, const ContactAxes& axes) const override { return state_.carrier(number, axes); }
  CarriedPoint carried(int face, const Vec3& weights, const Vec3& x, const Vec3& normal) const override {
    return state_.carried(face, weights, x, normal);
  }
  const SurfaceState* soft() const override { return &state_; }
  const Points& points() const override { return state_.is_skin() ? state_.nodes() : state_.positions(); }
  int block_id() const override { return state_.surface().block_id; }
  int vertex_count() const override { return state_.vertex_count(); }
  Carriers carriers(int vertex) const override {
    Carriers out;
    if (!state_.is_skin()) {
      out.point.fill(vertex);
      return out;
    }
    const NodeSurface& s = state_.surface();
    const int tet = s.embedding.tet[static_cast<std::size_t>(vertex)];
    for (std::size_t k = 0; k < 4; ++k) {
      const auto corner = static_cast<Eigen::Index>(k);
      out.point[k] = s.tets(corner, tet);
      out.weight[k] = s.embedding.weights(corner, vertex);
    }
    return out;
  }

 private:
  /// Mean and spread as derived in proxy_set_motion.cpp, for the whole surface.
  proxy::ProxyMotion around_mean(const Eigen::Ref<const Points>& v) const {
    const Vec3 mean = v.rowwise().mean();
    return {mean, state_.weight_sum() * std::sqrt((v.colwise() - mean).colwise().squaredNorm().maxCoeff())};
  }
  SurfaceState state_;
  Points kept_, way_;  ///< Positions of the carriers when kept, and their displacements since.
};

class RigidSide final : public ImageSide {
 public:
  RigidSide(TriMesh surface, int frame, std::shared_ptr<MovingFrame> motion)
      : surface_(std::move(surface)), frame_(frame), motion_(std::move(motion)) {
    PALPATE_CHECK(motion_, "an image source needs a frame");
    const Points& x = surface_.vertices;
    if (x.cols() == 0) return;
    centre_ = 0.5 * (x.rowwise().minCoeff() + x.rowwise().maxCoeff());
    reach_ = std::sqrt((x.colwise() - centre_).colwise().squaredNorm().maxCoeff());
  }
  void update(const dynamics::StateView& state) override {
    pose_ = motion_->pose(state);
    turn_ = pose_.rotation.toRotationMatrix();
  }
  proxy::ProxyMotion motion(const dynamics::StateView& state) const override {
    const Twist twist = motion_->twist(state);
    return {twist.at(turn_ * centre_), twist.angular.norm() * reach_};
  }
  const Faces& faces() const override { return surface_.faces; }
  const Points& positions() override {
    world_.noalias() = turn_ * surface_.vertices;
    world_.colwise() += pose_.translation;
    return world_;
  }
  Vec3 vertex(int vertex) const override { return turn_ * surface_.vertices.col(vertex) + pose_.translation; }
  void update(proxy::ProxySet& proxies) const override { proxies.update(pose_); }
  const Points& points() const override { return surface_.vertices; }
  Pose points_pose() const override { return pose_; }
  int vertex_count() const override { return static_cast<int>(surface_.vertices.cols()); }
  Carriers carriers(int vertex) const override {
    Carriers out;
    out.point.fill(vertex);
    return out;
  }
  void set_motion(proxy::ProxySet& proxies, const dynamics::StateView& state) const override {
    proxies.set_motion(motion_->twist(state));
  }
  void keep() override { kept_ = pose_; }
  // The difference of R X + p and R' X + p' relative to the centre: a rotation by theta moves points at
  // distance r by at most 2 sin(theta/2) r.
  proxy::ProxyMotion way() override {
    const double angle = rotation_vector(pose_.rotation * kept_.rotation.conjugate()).norm();
    return {pose_ * centre_ - kept_ * centre_, 2.0 * std::sin(0.5 * angle) * reach_};
  }
  void set_motion(proxy::ProxySet& proxies) override { proxies.set_motion_from(kept_); }
  Vec3 kept_vertex(int vertex) const override { return kept_ * Vec3(surface_.vertices.col(vertex)); }
  Pose frame() const override { return pose_; }
  Pose kept_frame() const override { return kept_; }
  /// Returns the map to the point in the frame's axes, R^T (origin + U (u, v, w) - t).
  Carrier carrier(int, const ContactAxes& axes) const override {
    Carrier out;
    out.frame = frame_;
    out.by_place.topLeftCorner<3, 3>().noalias() = turn_.transpose() * axes.to_world;
    out.by_place.topRightCorner<3, 1>().noalias() = turn_.transpose() * (axes.origin - pose_.translation);
    out.by_place(3, 3) = 1.0;
    return out;
  }
  CarriedPoint carried(int, const Vec3&, const Vec3& x, const Vec3&) const override {
    CarriedPoint out;
    out.point.frame = frame_;
    out.point.offset.noalias() = turn_.transpose() * (x - pose_.translation);
    return out;
  }

 private:
  TriMesh surface_;
  int frame_;
  std::shared_ptr<MovingFrame> motion_;
  Pose pose_, kept_;
  Mat3 turn_ = Mat3::Identity();
  Vec3 centre_ = Vec3::Zero();  ///< Centre of the surface's bounding box, in the frame.
  double reach_ = 0.0;          ///< Largest distance of a vertex from the centre [m].
  Points world_;
};

std::atomic<std::uint64_t> g_sides{0};

}  // namespace

ImageSide::ImageSide() : number_(++g_sides) {}

std::unique_ptr<ImageSide> soft_side(NodeSurface surface) {
  return std::make_unique<SoftSide>(std::move(surface));
}
std::unique_ptr<ImageSide> rigid_side(TriMesh surface, int frame, std::shared_ptr<MovingFrame> motion) {
  return std::make_unique<RigidSide>(std::move(surface), frame, std::move(motion));
}

}  // namespace palpate::contact
