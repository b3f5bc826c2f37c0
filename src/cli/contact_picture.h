#pragma once
#include <string>

#include "instant.h"
#include "loop/contact_instant.h"

namespace palpate::cli {

class MissingOutputs;

/// Keeps the query of a run with the largest contact force, for two pictures: what Figures 4 and 5 of Galoppo
/// et al. (2007) show.
class ContactSnapshot : public loop::Observer {
 public:
  void queried(loop::World& world, double t) override;

  /// contact.png: the proxies in contact, outlined, beside the patch of skin with the largest overlap, seen
  /// from what touches it, with its penetration and its colliding vertices.  depth.png: the penetration over
  /// the pixels of the region with the largest overlap, in an image.
  void save(const loop::World& world, const std::string& folder, MissingOutputs& missing) const;

 private:
  bool touched() const { return contact_.force_n > 0.0; }
  Instant instant_;
  loop::ContactInstant contact_;
};

}  // namespace palpate::cli
