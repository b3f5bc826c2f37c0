#pragma once
#include <functional>
#include <string_view>
#include <vector>

#include "contact/image_side.h"
#include "contact/passed_vertices.h"

namespace palpate::contact {

/// Counts what went through between two queries of a contact, unseen, and warns of it once.
class LookBack {
 public:
  /// Which faces may have met, by number, filled by `find`; it returns how thick the thinnest of them are
  /// [m].
  struct Met {
    std::vector<int> a, b;
  };
  /// Looks back from a query to the one before, where there was one, and keeps the surfaces for the next.
  /// @param t  [s], for messages
  void look(ImageSide& a, ImageSide& b, const std::function<double(Met&)>& find, double t);
  /// The same of one surface against itself.
  /// @param may_meet  whether a vertex and a face are no neighbours
  void look_at_itself(ImageSide& side, double thickness,
                      const std::function<bool(int vertex, int face)>& may_meet, double t);
  long count() const { return count_; }  ///< so far
  void archive(Archive& a);

 private:
  void tell(std::string_view through_what, double t);
  PassedVertices passed_;
  Met met_;  ///< scratch
  long count_ = 0;
  bool kept_ = false, warned_ = false, gave_up_ = false;
};

/// All faces of both sides where they moved against each other by more than a part of their thickness since
/// they were kept, else none.
void find_all_met(ImageSide& a, ImageSide& b, double thickness, std::vector<int>& faces_a,
                  std::vector<int>& faces_b);

}  // namespace palpate::contact
