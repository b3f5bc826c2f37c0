#pragma once
#include <vector>

#include "palpate/contact/frame.h"
#include "palpate/contact/sample.h"
#include "palpate/contact/statistics.h"

namespace palpate::contact {

/// Force and moment of each contact pair on its side a, before and after a refresh, and their difference.
///
/// A refresh pairs other points. The same resultant distributed to other nodes is not a jump of the contact;
/// a change of the resultant is. Force [N] and moment [N m] are reported separately, because a common norm
/// would need an arbitrary length.
class Resultants {
 public:
  /// One entry per pair: moment about the world's origin, and force, on side a.
  std::vector<Wrench> before, after;

  /// Resets `before` and `after` for this number of pairs.
  void start(std::size_t pairs);
  /// Computes the change that the refresh made at `state`, the largest of all pairs. The moment is taken
  /// about each body of the pair: about the mean of its nodes, or the origin of its frame. Bodies that do not
  /// move are ignored.
  /// @param samples_before, samples_after  samples of the two queries, which identify the pairs' bodies
  /// @param out  receives refresh_jump, and the largest jump and resultant so far
  using Samples = std::vector<ContactSample>;
  void compare(const Samples& samples_before, const Samples& samples_after, const dynamics::StateView& state,
               const std::vector<std::shared_ptr<MovingFrame>>& frames, ContactStatistics& out);

 private:
  struct Bodies {
    bool known = false;         ///< True: the bodies were identified.
    std::vector<Vec3> centres;  ///< Reference points of the moments [m].
  };
  void find_bodies(const Samples& samples, const dynamics::StateView& state,
                   const std::vector<std::shared_ptr<MovingFrame>>& frames);
  std::vector<Bodies> bodies_;  ///< Per pair.
};

}  // namespace palpate::contact
