#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::store {

/// Binary chunk of a glTF file with its views and accessors.
class GlbBuffer {
 public:
  using Json = nlohmann::ordered_json;

  /// Constants of glTF, equal to OpenGL's enumerants.
  static constexpr int kFloat = 5126, kUnsignedInt = 5125;
  static constexpr int kVertices = 34962, kIndices = 34963, kNoTarget = 0;

  /// Appends values as a new view and accessor.
  /// @param width  1: SCALAR, 3: VEC3, 4: VEC4
  /// @param target  kVertices, kIndices or kNoTarget
  /// @param bounded  stores minimum and maximum of each component, which glTF requires for positions and
  ///   keyframe times
  /// @return index of the accessor
  int add(const std::vector<float>& values, int width, int target, bool bounded);
  int add_indices(const std::vector<std::uint32_t>& values);

  const std::string& bytes() const { return bytes_; }
  Json views() const { return views_; }
  Json accessors() const { return accessors_; }

 private:
  int add_accessor(const void* data, std::size_t size, int component, int width, std::size_t count,
                   int target);

  std::string bytes_;
  Json views_ = Json::array(), accessors_ = Json::array();
};

}  // namespace palpate::store
