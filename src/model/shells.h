#pragma once
#include <string>
#include <vector>

#include "soup.h"

namespace palpate::model {

/// Faces that hang together by edges, in the order of their first faces.
std::vector<std::vector<int>> shells_of(const TriMesh& surface);

/// Makes one body of closed, consistently oriented shells that do not cross each other: its shell outwards
/// and its cavities inwards.  Specks go; a shell inside another one that turns the same way goes (the body is
/// solid there); one that turns the other way is a cavity and stays.
/// @throws Error with the place of the second body where there are several, unless `largest` keeps the
///   largest
Soup keep_one_body(const Soup& soup, bool largest, std::vector<std::string>& notes);

}  // namespace palpate::model
