#pragma once
#include <string>

#include "loop/contact_instant.h"
#include "session/world_snapshot.h"

namespace palpate {
class MissingOutputs;
}

namespace palpate::session {

/// Observer that keeps the contact query with the largest contact force of a run, for two pictures like
/// Figures 4 and 5 of Galoppo et al. (2007).
class PeakContactPicture : public loop::Observer {
 public:
  void queried(loop::World& world, double t) override;

  /// Writes contact.png and depth.png into the folder. contact.png shows the proxies in contact, outlined,
  /// next to the patch of skin with the largest overlap, seen from the side of the touching body, with its
  /// penetration and its colliding vertices. depth.png shows the penetration over the pixels of the region
  /// with the largest overlap, for contact in image space.
  void save(const loop::World& world, const std::string& folder, MissingOutputs& missing) const;

 private:
  bool touched() const { return contact_.force_n > 0.0; }
  WorldSnapshot snapshot_;
  loop::ContactInstant contact_;
};

}  // namespace palpate::session
