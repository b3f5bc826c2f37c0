#include "store/glb_buffer.h"

#include <algorithm>

#include "palpate/core/error.h"

namespace palpate::store {

int GlbBuffer::add_accessor(const void* data, std::size_t size, int component, int width, std::size_t count,
                            int target) {
  // Every component has 4 bytes, so consecutive views are aligned as glTF requires.
  PALPATE_CHECK(count > 0 && size % 4 == 0 && bytes_.size() % 4 == 0, "{} values in {} bytes", count, size);
  Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", size}};
  if (target != kNoTarget) view["target"] = target;
  bytes_.append(static_cast<const char*>(data), size);
  accessors_.push_back({{"bufferView", views_.size()},
                        {"componentType", component},
                        {"count", count},
                        {"type", width == 1   ? "SCALAR"
                                 : width == 3 ? "VEC3"
                                              : "VEC4"}});
  views_.push_back(std::move(view));
  return static_cast<int>(accessors_.size()) - 1;
}

int GlbBuffer::add(const std::vector<float>& values, int width, int target, bool bounded) {
  const auto columns = static_cast<std::size_t>(width);
  const int number = add_accessor(values.data(), values.size() * sizeof(float), kFloat, width,
                                  values.size() / columns, target);
  if (!bounded) return number;
  std::vector<float> least(values.begin(), values.begin() + width), greatest = least;
  for (std::size_t i = 0; i < values.size(); ++i) {
    least[i % columns] = std::min(least[i % columns], values[i]);
    greatest[i % columns] = std::max(greatest[i % columns], values[i]);
  }
  accessors_.back()["min"] = least;
  accessors_.back()["max"] = greatest;
  return number;
}

int GlbBuffer::add_indices(const std::vector<std::uint32_t>& values) {
  return add_accessor(values.data(), values.size() * sizeof(std::uint32_t), kUnsignedInt, 1, values.size(),
                      kIndices);
}

}  // namespace palpate::store
