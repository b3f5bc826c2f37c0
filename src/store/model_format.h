#pragma once

namespace palpate::store {

/// Values of the attribute `format` at the root of mesh and model files.
inline constexpr const char* kMeshFormat = "palpate tetrahedra 1";
inline constexpr const char* kModelFormat = "palpate model 1";

}  // namespace palpate::store
