#include "contact/tunnelling_monitor.h"

#include <algorithm>
#include <numeric>

#include "palpate/core/log.h"

namespace palpate::contact {
namespace {

/// Returns the motion of some faces and their vertices, relative to the frame of `axes`, in which a rigid
/// surface is at rest.
SurfaceMotion motion_of(const ImageSide& side, const std::vector<int>& faces, const ImageSide& axes) {
  SurfaceMotion out;
  std::vector<int> taken;
  for (const int f : faces)
    for (int k = 0; k < 3; ++k) taken.push_back(side.faces()(k, f));
  std::sort(taken.begin(), taken.end());
  taken.erase(std::unique(taken.begin(), taken.end()), taken.end());
  const auto local = [&](int vertex) {
    return static_cast<int>(std::lower_bound(taken.begin(), taken.end(), vertex) - taken.begin());
  };
  out.faces.resize(3, static_cast<Eigen::Index>(faces.size()));
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int k = 0; k < 3; ++k) out.faces(k, static_cast<Eigen::Index>(i)) = local(side.faces()(k, faces[i]));
  out.face_of = faces;
  out.vertex_of = taken;
  const Pose now = axes.frame().inverse(), then = axes.kept_frame().inverse();
  out.now.resize(3, static_cast<Eigen::Index>(taken.size()));
  out.before.resize(3, out.now.cols());
  for (std::size_t i = 0; i < taken.size(); ++i) {
    out.now.col(static_cast<Eigen::Index>(i)) = now * side.vertex(taken[i]);
    out.before.col(static_cast<Eigen::Index>(i)) = then * side.kept_vertex(taken[i]);
  }
  return out;
}

constexpr double kPartOfThickness = 0.25;  // Shorter paths graze an edge.

}  // namespace

void TunnellingMonitor::check(ImageSide& a, ImageSide& b, const std::function<double(Met&)>& find, double t) {
  if (kept_) {
    const double least_way = kPartOfThickness * find(met_);
    if (!met_.a.empty() && !met_.b.empty()) {
      const SurfaceMotion of_a = motion_of(a, met_.a, b), of_b = motion_of(b, met_.b, b);
      count_ += check_.count(of_a, of_b, least_way) + check_.count(of_b, of_a, least_way);
    }
  }
  a.keep();
  b.keep();
  kept_ = true;
  tell("the other body", t);
}

void TunnellingMonitor::check_self(ImageSide& side, double thickness,
                                   const std::function<bool(int vertex, int face)>& may_collide, double t) {
  if (kept_) {
    find_all_met(side, side, thickness, met_.a, met_.b);
    if (!met_.a.empty()) {
      const SurfaceMotion motion = motion_of(side, met_.a, side);
      count_ += check_.count(motion, motion, kPartOfThickness * thickness, may_collide);
    }
  }
  side.keep();
  kept_ = true;
  tell("another part of their body", t);
}

void TunnellingMonitor::tell(std::string_view through_what, double t) {
  if (check_.given_up() > 0 && !gave_up_) {
    gave_up_ = true;
    log::warn(
        "contact at t = {:.6g} s: surfaces moved too far between two queries for all tunnelled vertices to "
        "be counted. Decrease exchange.contact_refresh_s",
        t);
  }
  if (count_ == 0 || warned_) return;
  warned_ = true;
  log::warn(
      "contact at t = {:.6g} s: {} vertices tunnelled through {} between two queries. Decrease "
      "exchange.contact_refresh_s, or set exchange.tunnelling = \"substep\"",
      t, count_, through_what);
}

void find_all_met(ImageSide& a, ImageSide& b, double thickness, std::vector<int>& faces_a,
                  std::vector<int>& faces_b) {
  // Relative to the thickness, which may have been reduced by compression: see proxy/pruner.h.
  constexpr double kPart = 0.25;
  faces_a.clear();
  faces_b.clear();
  const proxy::ProxyMotion of_a = a.way(), of_b = b.way();
  if (!((of_a.velocity - of_b.velocity).norm() + of_a.spread + of_b.spread > kPart * thickness)) return;
  faces_a.resize(static_cast<std::size_t>(a.faces().cols()));
  faces_b.resize(static_cast<std::size_t>(b.faces().cols()));
  std::iota(faces_a.begin(), faces_a.end(), 0);
  std::iota(faces_b.begin(), faces_b.end(), 0);
}

void TunnellingMonitor::archive(Archive& a) {
  a("tunnelled", count_);
  a("warned", warned_);
}

}  // namespace palpate::contact
