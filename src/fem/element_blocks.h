#pragma once
#include <array>

#include "palpate/core/types.h"

namespace palpate::fem {

/// The nine 3x3 blocks of an element matrix for nodes 1, 2, 3 (index 3 (a-1) + (b-1)). The blocks of node 0
/// follow from translation invariance: the blocks of each row and of each column sum to zero.
using ElementBlocks = std::array<Mat3, 9>;

}  // namespace palpate::fem
