#pragma once
#include <functional>
#include <string_view>
#include <vector>

#include "contact/image_side.h"
#include "contact/tunnelling_check.h"
#include "palpate/core/archive.h"

namespace palpate::contact {

/// Counts vertices that tunnelled between two queries of a contact, and warns once.
class TunnellingMonitor {
 public:
  /// Faces that may have come into contact, by index, collected by `find`, which returns the thickness of the
  /// thinner side [m].
  struct Met {
    std::vector<int> a, b;
  };
  /// Checks for tunnelling since the previous query, if there was one, and keeps the surfaces for the next.
  /// @param t  time for messages [s]
  void check(ImageSide& a, ImageSide& b, const std::function<double(Met&)>& find, double t);
  /// Checks for tunnelling of one surface through itself.
  /// @param may_collide  returns whether a vertex and a face are not neighbours
  void check_self(ImageSide& side, double thickness,
                  const std::function<bool(int vertex, int face)>& may_collide, double t);
  long count() const { return count_; }  ///< Number of tunnelled vertices so far.
  void archive(Archive& a);

 private:
  void tell(std::string_view through_what, double t);
  TunnellingCheck check_;
  Met met_;  ///< Scratch.
  long count_ = 0;
  bool kept_ = false, warned_ = false, gave_up_ = false;
};

/// Returns all faces of both sides if the sides moved relative to each other by more than a fraction of their
/// thickness since they were kept, else none.
void find_all_met(ImageSide& a, ImageSide& b, double thickness, std::vector<int>& faces_a,
                  std::vector<int>& faces_b);

}  // namespace palpate::contact
