#pragma once

namespace palpate::store {

/// Value of the attribute `format` at the root of each kind of file.
inline constexpr const char* kMeshFormat = "palpate tetrahedra 1";
inline constexpr const char* kModelFormat = "palpate model 1";

}  // namespace palpate::store
