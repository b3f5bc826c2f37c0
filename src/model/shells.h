#pragma once
#include <string>
#include <vector>

#include "soup.h"

namespace palpate::model {

/// Returns the faces connected by edges, one list per shell, in the order of their first faces.
std::vector<std::vector<int>> shells_of(const TriMesh& surface);

/// Makes one body of closed, consistently oriented shells that do not intersect: its outer shell outwards and
/// its cavities inwards.  Specks are dropped.  A shell inside the outer one with the same orientation is
/// dropped (the body is solid there); one with the opposite orientation and directly inside the outer shell
/// is a cavity and is kept; shells nested deeper are dropped.
/// @throws Error with the place of the second body if there are several, unless `largest` keeps the largest
Soup keep_one_body(const Soup& soup, bool largest, std::vector<std::string>& notes);

}  // namespace palpate::model
