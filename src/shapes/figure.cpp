#include "figure.h"

#include "solids.h"

namespace palpate::shapes::figure {
namespace {

/// Builder of bones by name; a pair is a bone and its mirror image.
class Builder {
 public:
  void one(const std::string& name, const std::string& parent, const Vec3& head, const Vec3& tail,
           double head_radius, double tail_radius) {
    skeleton_.bones.push_back({name, number(parent), head, tail, head_radius, tail_radius});
  }
  void pair(const std::string& name, const std::string& parent, bool parent_is_pair, const Vec3& head,
            const Vec3& tail, double head_radius, double tail_radius) {
    one(name + "_left", parent_is_pair ? parent + "_left" : parent, head, tail, head_radius, tail_radius);
    one(name + "_right", parent_is_pair ? parent + "_right" : parent, mirrored(head), mirrored(tail),
        head_radius, tail_radius);
  }
  Skeleton take() { return std::move(skeleton_); }

 private:
  int number(const std::string& name) const {
    for (std::size_t i = 0; i < skeleton_.bones.size(); ++i)
      if (skeleton_.bones[i].name == name) return static_cast<int>(i);
    return -1;
  }
  Skeleton skeleton_;
};

}  // namespace

Skeleton skeleton() {
  Builder b;
  b.one("pelvis", "", kPelvis, kWaist, 0.070, 0.045);
  b.one("lumbar_spine", "pelvis", kWaist, kChest, 0.040, 0.045);
  b.one("thorax", "lumbar_spine", kChest, Vec3(0, 0.020, 1.390), 0.070, 0.055);
  b.one("neck", "thorax", kNeck, kSkull, 0.030, 0.028);
  b.one("head", "neck", kSkull, Vec3(0, 0.004, 1.665), 0.032, 0.055);
  b.pair("clavicle", "thorax", false, kCollar, Vec3(0.140, 0.012, 1.424), 0.018, 0.016);
  b.pair("upper_arm", "clavicle", true, kShoulder, kElbow, 0.026, 0.022);
  b.pair("forearm", "upper_arm", true, kElbow, kWrist, 0.022, 0.015);
  b.pair("hand", "forearm", true, kWrist, kKnuckles, 0.013, 0.009);
  b.pair("thigh", "pelvis", false, kHip, kKnee, 0.034, 0.030);
  b.pair("shank", "thigh", true, kKnee, kAnkle, 0.030, 0.022);
  b.pair("foot", "shank", true, Vec3(0.128, 0.030, 0.050), Vec3(0.149, -0.110, 0.028), 0.020, 0.011);
  return b.take();
}

}  // namespace palpate::shapes::figure
