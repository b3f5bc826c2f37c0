#pragma once
#include <vector>

#include "palpate/contact/contact_force.h"

namespace palpate::contact {

/// Force and moment of each contact pair on its side a, before and after a refresh, and by how much they
/// differ.
///
/// A refresh pairs other points: the same resultant spread over other nodes is no jump of the contact, a
/// resultant that changes is.  Force [N] and moment [N m] are two numbers: no norm holds both without a
/// length that somebody chose.
class Resultants {
 public:
  /// One entry a pair: moment about the world's origin, and force, on side a.
  std::vector<Wrench> before, after;

  void start(std::size_t pairs);
  /// The change that the refresh made at `state`, the largest of all pairs.  The moment is seen from each
  /// body of the pair: about the mean of its nodes, or about the origin of its frame.  What does not move
  /// feels none.
  /// @param before, after  samples of the queries, of which the pairs' bodies are known
  using Samples = std::vector<ContactSample>;
  void compare(const Samples& samples_before, const Samples& samples_after, const dynamics::StateView& state,
               const std::vector<std::shared_ptr<MovingFrame>>& frames);

  ResultantSize jump;           ///< at the last refresh
  ResultantSize largest_jump;   ///< of all refreshes
  ResultantSize largest_after;  ///< resultants after a refresh, of all refreshes

 private:
  struct Bodies {
    bool known = false;
    std::vector<Vec3> centres;  ///< [m]
  };
  void find_bodies(const Samples& samples, const dynamics::StateView& state,
                   const std::vector<std::shared_ptr<MovingFrame>>& frames);
  std::vector<Bodies> bodies_;  ///< by pair
};

}  // namespace palpate::contact
