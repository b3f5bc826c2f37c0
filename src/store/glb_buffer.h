#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::store {

/// The binary chunk of a glTF file with the views and accessors into it.
class GlbBuffer {
 public:
  using Json = nlohmann::ordered_json;

  /// Numbers of glTF and of the OpenGL that it is named after.
  static constexpr int kFloat = 5126, kUnsignedInt = 5125;
  static constexpr int kVertices = 34962, kIndices = 34963, kNoTarget = 0;

  /// @param width  1: SCALAR, 3: VEC3, 4: VEC4
  /// @param bounded  states the least and the greatest value of each component, which glTF demands of
  ///   positions and keyframe times
  /// @return number of the accessor
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
