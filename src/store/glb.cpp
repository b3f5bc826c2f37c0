#include "store/glb.h"

#include <bit>
#include <cmath>
#include <limits>

#include "palpate/core/error.h"
#include "store/glb_buffer.h"

namespace palpate::store {
namespace {

using Json = GlbBuffer::Json;
static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

std::vector<float> floats(const Points& points) {
  const Eigen::Matrix3Xf single = points.cast<float>();
  return {single.data(), single.data() + single.size()};
}

/// Inverts the sRGB transfer function (IEC 61966-2-1): glTF's colours are linear.
double linear(std::uint8_t channel) {
  const double s = channel / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

Json material_of(const MovingSurface& s) {
  Json out = {
      {"name", s.name},
      {"pbrMetallicRoughness",
       {{"baseColorFactor", {linear(s.colour[0]), linear(s.colour[1]), linear(s.colour[2]), s.opacity}},
        {"metallicFactor", 0.0},
        {"roughnessFactor", 0.7}}},
      {"doubleSided", true}};
  if (s.opacity < 1.0) out["alphaMode"] = "BLEND";
  return out;
}

/// Document under construction.
struct Document {
  GlbBuffer buffer;
  Json meshes = Json::array(), materials = Json::array(), channels = Json::array(), samplers = Json::array();
  /// Node 0 turns palpate's z up to glTF's y up; the surfaces are its children, in order.
  Json nodes = Json::array(
      {Json::object({{"name", "z up"}, {"rotation", {-std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)}}})});
  int times = -1;  ///< Accessor of the keyframes; -1: nothing moves.

  void add(const MovingSurface& s);
  void animate(const char* path, int output) {
    channels.push_back({{"sampler", samplers.size()}, {"target", {{"node", nodes.size()}, {"path", path}}}});
    samplers.push_back({{"input", times}, {"output", output}, {"interpolation", "LINEAR"}});
  }

 private:
  void animate_weights(std::size_t targets);
  void animate_poses(const std::vector<Pose>& poses);
};

/// Animates the morph weights: at keyframe k the weight of target k - 1 is one and all others are zero.
void Document::animate_weights(std::size_t targets) {
  std::vector<float> weights((targets + 1) * targets, 0.0f);
  for (std::size_t k = 1; k <= targets; ++k) weights[k * targets + k - 1] = 1.0f;
  animate("weights", buffer.add(weights, 1, GlbBuffer::kNoTarget, false));
}

void Document::animate_poses(const std::vector<Pose>& poses) {
  std::vector<float> translations, rotations;
  Quat before = poses.front().rotation;
  for (const Pose& pose : poses) {
    Quat q = pose.rotation.normalized();
    if (q.dot(before) < 0.0) q.coeffs() = -q.coeffs();  // Shorter rotation between keyframes.
    before = q;
    for (int axis = 0; axis < 3; ++axis) translations.push_back(static_cast<float>(pose.translation[axis]));
    for (int i = 0; i < 4; ++i) rotations.push_back(static_cast<float>(q.coeffs()[i]));  // x y z w
  }
  animate("translation", buffer.add(translations, 3, GlbBuffer::kNoTarget, false));
  animate("rotation", buffer.add(rotations, 4, GlbBuffer::kNoTarget, false));
}

void Document::add(const MovingSurface& s) {
  std::vector<std::uint32_t> corners;
  for (const int corner : s.faces.reshaped()) corners.push_back(static_cast<std::uint32_t>(corner));
  Json primitive = {
      {"attributes", {{"POSITION", buffer.add(floats(s.points[0]), 3, GlbBuffer::kVertices, true)}}},
      {"indices", buffer.add_indices(corners)},
      {"material", materials.size()},
      {"mode", 4}};
  Json node = {{"name", s.name}, {"mesh", meshes.size()}}, mesh = {{"name", s.name}};
  const std::size_t targets = s.points.size() - 1;
  for (std::size_t k = 1; k <= targets; ++k)
    primitive["targets"].push_back(
        {{"POSITION", buffer.add(floats(s.points[k] - s.points[0]), 3, GlbBuffer::kVertices, true)}});
  mesh["primitives"] = Json::array({primitive});
  if (targets > 0) {
    mesh["weights"] = std::vector<double>(targets, 0.0);
    animate_weights(targets);
  }
  if (!s.poses.empty()) {
    const Pose& pose = s.poses.front();
    const Quat q = pose.rotation.normalized();
    node["translation"] = {pose.translation.x(), pose.translation.y(), pose.translation.z()};
    node["rotation"] = {q.x(), q.y(), q.z(), q.w()};
    if (times >= 0) animate_poses(s.poses);
  }
  nodes[0]["children"].push_back(nodes.size());
  nodes.push_back(std::move(node));
  meshes.push_back(std::move(mesh));
  materials.push_back(material_of(s));
}

void check(const MovingSurface& s, std::size_t times) {
  const bool rigid = !s.poses.empty();
  PALPATE_CHECK(s.points.size() == (rigid ? 1 : times) && (!rigid || s.poses.size() == times),
                "surface \"{}\": {} times, {} sets of points, {} poses", s.name, times, s.points.size(),
                s.poses.size());
  for (const Points& p : s.points)
    PALPATE_CHECK(p.cols() == s.points[0].cols() && p.allFinite(), "surface \"{}\": {} points, first {}",
                  s.name, p.cols(), s.points[0].cols());
  PALPATE_CHECK(s.faces.cols() > 0 && s.faces.minCoeff() >= 0 && s.faces.maxCoeff() < s.points[0].cols(),
                "surface \"{}\": {} faces of {} points", s.name, s.faces.cols(), s.points[0].cols());
}

void append_word(std::string& out, std::size_t value) {
  if (value > std::numeric_limits<std::uint32_t>::max())
    fail("a glTF file holds at most 4 GiB; export fewer states (--every N) or one body (--body NAME)");
  const auto word = static_cast<std::uint32_t>(value);
  out.append(reinterpret_cast<const char*>(&word), sizeof word);
}

/// Assembles the header and two chunks of whole words: JSON padded with spaces, bytes with zeros.
std::string packed(std::string json, const std::string& bytes) {
  constexpr std::size_t kMagic = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBinary = 0x004E4942;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string out;
  append_word(out, kMagic);
  append_word(out, kVersion);
  append_word(out, 12 + 8 + json.size() + 8 + bytes.size());
  append_word(out, json.size());
  append_word(out, kJson);
  out += json;
  append_word(out, bytes.size());
  append_word(out, kBinary);
  return out + bytes;
}

}  // namespace

std::string glb_of(const std::vector<MovingSurface>& surfaces, const std::vector<double>& times_s,
                   const std::string& title, const std::string& generator) {
  PALPATE_CHECK(!surfaces.empty() && !times_s.empty(), "{} surfaces at {} times", surfaces.size(),
                times_s.size());
  Document d;
  if (times_s.size() > 1) {
    std::vector<float> keyframes;
    for (const double t : times_s) keyframes.push_back(static_cast<float>(t - times_s.front()));
    for (std::size_t k = 1; k < keyframes.size(); ++k)
      PALPATE_CHECK(keyframes[k] > keyframes[k - 1], "times {} and {} s", times_s[k - 1], times_s[k]);
    d.times = d.buffer.add(keyframes, 1, GlbBuffer::kNoTarget, true);
  }
  for (const MovingSurface& s : surfaces) {
    check(s, times_s.size());
    d.add(s);
  }
  Json json = {{"asset", {{"version", "2.0"}, {"generator", generator}}},
               {"scene", 0},
               {"scenes", Json::array({Json::object({{"name", title}, {"nodes", Json::array({0})}})})},
               {"nodes", d.nodes},
               {"meshes", d.meshes},
               {"materials", d.materials}};
  if (!d.channels.empty())
    json["animations"] =
        Json::array({Json::object({{"name", "run"}, {"channels", d.channels}, {"samplers", d.samplers}})});
  json["accessors"] = d.buffer.accessors();
  json["bufferViews"] = d.buffer.views();
  json["buffers"] = Json::array({Json::object({{"byteLength", d.buffer.bytes().size()}})});
  return packed(json.dump(-1, ' ', false, Json::error_handler_t::replace), d.buffer.bytes());
}

}  // namespace palpate::store
